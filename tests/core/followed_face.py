"""A drawn face that can move, wink and speak, and an aligner that knows where its points are."""

from pathlib import Path

import cv2
import numpy as np

from core.alignment import Alignment
from core.face_regions import Region
from core.landmarks import GROUPS, MESH478, N_LANDMARKS, PUPILS478
from core.mean_face import load_mean_face
from core.records import Frame, Landmarks2D

SIZE_PX = (320, 240)
_MEAN_FACE = Path(__file__).resolve().parents[2] / "assets" / "aligner" / "mean_face.npz"
_EYES = ("eye_right", "eye_left")


def face_mesh(px_per_mm=0.9):
    """Return the mean face's mesh (478, 3) in px, in the middle of the picture, and depth."""
    mesh = np.zeros((478, 3))
    mesh[:468] = load_mean_face(_MEAN_FACE).vertices_mm
    for first, name in zip(PUPILS478, _EYES, strict=True):
        mesh[first : first + 5] = mesh[MESH478[list(GROUPS[name])]].mean(axis=0)
    mesh *= px_per_mm
    mesh[:, :2] += [160, 120] - mesh[:, :2].mean(axis=0)
    return mesh


def points_of(mesh):
    """Return landmarks and pupils (77, 2) of a mesh."""
    return mesh[np.concatenate([MESH478, PUPILS478]), :2]


def face_points():
    return points_of(face_mesh())


def drawn_face(points, lids=(0.0, 0.0), jaw=0.0, seed=3):
    """Return a grey picture of a face; lids closed and jaw open up to 1."""
    noise = np.random.default_rng(seed).normal(size=SIZE_PX[::-1])
    skin = cv2.GaussianBlur(noise, (0, 0), 1.5)
    picture = (150 + 12 * skin / skin.std()).clip(0, 255).astype(np.uint8)
    for name, closed in zip(_EYES, lids, strict=True):
        _draw_eye(picture, points[list(GROUPS[name])], closed)
    for name in ("brow_right", "brow_left"):
        _polygon(picture, points[list(GROUPS[name])], 60)
    for nostril in GROUPS["nose"][5:]:
        cv2.circle(picture, _pixel(points[nostril]), 1, 90, -1)
    lips = points[list(GROUPS["lips_outer"])]
    lips = lips + np.where(lips > lips.mean(axis=0), [0, 20 * jaw], 0)
    _polygon(picture, lips, 100)
    if jaw > 0:
        center = lips.mean(axis=0)
        _polygon(picture, center + 0.7 * (lips - center), 25)
    return cv2.GaussianBlur(picture, (0, 0), 0.7)


def _draw_eye(picture, lid_points, closed):
    corners = lid_points[[0, 4]]
    if closed >= 0.5:
        cv2.line(picture, _pixel(corners[0]), _pixel(corners[1]), 60, 2)
        return
    _polygon(picture, lid_points, 235)
    cv2.circle(picture, _pixel(lid_points.mean(axis=0)), 2, 30, -1)


def _polygon(picture, points, grey):
    cv2.fillPoly(picture, [np.round(points * 8).astype(np.int32)], grey, shift=3)


def _pixel(point):
    x, y = np.round(point).astype(int)
    return int(x), int(y)


def frame_of(gray, index, fps=30.0):
    """Return a frame whose number is written into its first pixel, for `KnowingAligner`."""
    rgb = np.ascontiguousarray(np.repeat(gray[..., None], 3, axis=2))
    rgb[0, 0, 0] = index
    return Frame(rgb, gray, index / fps, index)


def alignment_of(mesh, presence=0.97):
    """Return what a perfect aligner makes of a mesh (478, 3)."""
    points = points_of(mesh)
    landmarks = Landmarks2D(
        points[:N_LANDMARKS], np.zeros(N_LANDMARKS, bool), np.ones(N_LANDMARKS),
        points[N_LANDMARKS:], np.ones(2),
    )  # fmt: skip
    low, high = mesh[:, :2].min(axis=0), mesh[:, :2].max(axis=0)
    region = Region(0.5 * (low + high), 1.5 * (high - low).max(), 0.0)
    return Alignment(landmarks, mesh[:, :2], mesh[:, 2], np.eye(3), presence, region, 0.9)


class KnowingAligner:
    """Answers with the mesh of the frame's number, None where that is None; counts its looks."""

    def __init__(self, meshes):
        self.meshes = meshes
        self.looked_at = []
        self.previous = []

    def follow(self, rgb, previous):
        index = int(rgb[0, 0, 0])
        self.looked_at.append(index)
        self.previous.append(previous)
        mesh = self.meshes[index]
        return None if mesh is None else alignment_of(mesh)


def moved(mesh, affine):
    """Return a mesh under an affine map (2, 3) of the picture."""
    out = mesh.copy()
    out[:, :2] = mesh[:, :2] @ np.asarray(affine)[:, :2].T + np.asarray(affine)[:, 2]
    return out
