"""What avatars have of their own about the mouth: lips that meet, and brighter teeth."""

import cv2
import numpy as np
from scipy.spatial import cKDTree

from app.avatars.looks import rgb
from app.render.lip_seal import LipSeal
from core.arkit import EXPRESSION_NAMES
from core.face_model import FaceModel, deltas_mm
from core.records import F32, U8

#: Edges of the lips lie so near to each other, on the mean head.
_MEET_MM = 1.7
#: What is so far from the edges moves a third as much; how far along the lips edges are felt.
_REACH_MM, _ALONG_MM = 5.0, 2.2
#: Linear colours of a tooth and of gums.
_TOOTH, _GUM = rgb(0.93, 0.885, 0.80), rgb(0.42, 0.135, 0.14)
#: Dark gaps up to so many pixels of a texture of 768 are filled, to this share.
_GAP_PX, _FILLED = 9, 0.62


def lip_seal(model: FaceModel) -> LipSeal:
    """Return where the lips of a face model meet."""
    points = model.mean_mm.astype(float)
    jaw = deltas_mm(model, np.zeros(model.n_identities))[EXPRESSION_NAMES.index("jawOpen")][:, 1]
    # -1 the upper lip, which the jaw leaves behind, to 1 the lower one.
    side = np.clip((jaw - 18.0) / 14.0, -1, 1)
    soft = np.unique(model.triangles[model.part_triangles("skin")])
    inner = np.unique(model.triangles[model.part_triangles("mouth")])
    edge = soft[(np.abs(points[soft, 0]) < 23) & (np.abs(points[soft, 1] - 71) < 5)]
    edge = edge[(points[edge, 2] < -14) & (np.abs(side[edge]) == 1)]
    upper, lower = edge[side[edge] < 0], edge[side[edge] > 0]
    away, found = cKDTree(points[lower]).query(points[upper])
    upper, lower = upper[away < _MEET_MM], lower[found[away < _MEET_MM]]
    rows = np.union1d(soft, inner)
    contact = np.concatenate([upper, lower])
    far = cKDTree(points[contact]).query(points[rows])[0]
    rows, far = rows[far < 2 * _REACH_MM], far[far < 2 * _REACH_MM]
    share = np.exp(-((far / _REACH_MM) ** 2)) * -side[rows] / 2
    across = points[rows, 0][:, None] - points[upper, 0]
    follow = np.exp(-((across / _ALONG_MM) ** 2)) + 1e-12
    follow *= (share / follow.sum(axis=1))[:, None]
    return LipSeal(upper, lower, rows, follow)


def bright_teeth(mouth: U8) -> U8:
    """Return the texture (S, S, 3) of teeth and tongue with teeth of a warm white in one row.

    Gums and tongue are red; what is not is tooth, or the dark between two teeth.
    """
    color = np.square(mouth.astype(np.float32) / 255)
    shown = mouth.astype(np.float32)
    tooth = np.clip((44 - (shown[..., 0] - shown[..., 1])) / 16, 0, 1)
    size = _GAP_PX * len(mouth) // 768 | 1
    round_px = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    tooth = cv2.GaussianBlur(cv2.morphologyEx(tooth, cv2.MORPH_CLOSE, round_px), (0, 0), 0.8)
    value = color.mean(axis=2)
    filled = cv2.morphologyEx(value, cv2.MORPH_CLOSE, round_px)
    value += _FILLED * (filled - value)
    bright = np.clip(value / 0.58, 0, 1)[..., None] ** 0.7 * _TOOTH
    gums = _teeth_square(len(mouth))[..., None] * (_GUM * (value / 0.27)[..., None] - color) + color
    out = gums + tooth[..., None] * (bright - gums)
    return np.asarray((255 * np.sqrt(np.clip(out, 0, 1)) + 0.5).astype(np.uint8))


def _teeth_square(size_px: int) -> F32:
    """Return where the texture is not the tongue's, (S, S): 1 there, 0 at the upper left."""
    y, x = np.mgrid[0:size_px, 0:size_px].astype(np.float32) / size_px
    return np.asarray(np.maximum(x > 0.45, y > 0.5), np.float32)
