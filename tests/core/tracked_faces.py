"""A user's face and synthetic takes of it, as the regressor would give them."""

from functools import cache
from pathlib import Path

import numba
import numpy as np
import pytest

from core.animation_prior import load_animation_prior
from core.arkit import EXPRESSION_NAMES
from core.face_model import deltas_mm, eye_centers_mm, load_face_model, neutral_mm, shape_vertices
from core.geometry import matrix_from_head_angles
from core.tracker import TrackerModel

ASSETS = Path(__file__).parents[2] / "assets"
FPS = 30.0

needs_compiled_kernels = pytest.mark.skipif(
    bool(numba.config.DISABLE_JIT), reason="hundreds of frames take minutes in plain Python"
)


@cache
def user_face(seed=None):
    """Return the tracker model of the mean person, or of a random one."""
    model = load_face_model(ASSETS / "face_model.npz")
    n_modes = model.identity_modes_mm.shape[0]
    rng = np.random.default_rng(seed)
    identity = np.zeros(n_modes) if seed is None else rng.standard_normal(n_modes)
    neutral, vertices = neutral_mm(model, identity), shape_vertices(model)
    radii = np.full(2, float(model.eyeball_radius_mm))
    return TrackerModel(
        neutral[vertices],
        deltas_mm(model, identity)[:, vertices],
        eye_centers_mm(model, neutral),
        radii,
    )


@cache
def shipped_prior():
    return load_animation_prior(ASSETS / "animation_prior.npz")


def index(name):
    return EXPRESSION_NAMES.index(name)


def expression(**amounts):
    """Return coefficients (46,) by name; a name without its side sets both sides."""
    out = np.zeros(len(EXPRESSION_NAMES))
    for name, amount in amounts.items():
        for full in [name] if name in EXPRESSION_NAMES else [name + "Left", name + "Right"]:
            out[index(full)] = amount
    return out


def head_pose(yaw=0.1, pitch=0.05, roll=-0.05, position_mm=(5.0, 10.0, 600.0)):
    return np.vstack([matrix_from_head_angles(yaw, pitch, roll), position_mm])


def shape_of(model, coefficients, pose, gaze_rad=(0.0, 0.0)):
    """Return the 77 points of an expression under a pose (4, 3), both eyes looking one way."""
    yaw, pitch = gaze_rad
    look = np.array([np.sin(yaw) * np.cos(pitch), -np.sin(pitch), -np.cos(yaw) * np.cos(pitch)])
    pupils = model.eye_centers_mm + model.pupil_radii_mm[:, None] * look
    face = model.neutral_mm + np.tensordot(coefficients, model.deltas_mm, 1)
    return np.concatenate([face, pupils]) @ pose[:3].T + pose[3]


def regressor_noise(rng, model, n_frames, deviation_mm=0.15):
    """Return noise (N, 77, 3) as a regressor's: alike at neighbouring points, deeper in z."""
    points = model.neutral_mm
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    covariance = 0.7 * np.exp(-0.5 * (distance / 20.0) ** 2) + 0.3 * np.eye(len(points))
    mixing = np.linalg.cholesky(covariance)
    face = np.einsum("kl,nld->nkd", mixing, rng.standard_normal((n_frames, len(points), 3)))
    noise = np.concatenate([face, rng.standard_normal((n_frames, 2, 3))], axis=1)
    return deviation_mm * noise * (1.0, 1.0, 1.5)


def track_clip(tracker, model, clip, noise, times_s=None, pose=None):
    """Return the expressions (N, 46) found in a clip of known ones."""
    tracker.reset()
    times_s = np.arange(len(clip)) / FPS if times_s is None else times_s
    pose = head_pose() if pose is None else pose
    return np.array(
        [
            tracker.step(shape_of(model, row, pose) + jitter, time_s).expression
            for row, jitter, time_s in zip(clip, noise, times_s, strict=True)
        ]
    )


def lag_and_gain(truth, found):
    """Return by how many frames `found` trails `truth`, and its amplitude against it."""
    frames = np.arange(5, len(truth) - 5)
    lags = np.arange(-1.0, 3.01, 0.05)
    moved = [np.interp(frames - lag, np.arange(len(truth)), truth) for lag in lags]
    best = int(np.argmin([np.sum((found[frames] - row) ** 2) for row in moved]))
    centred = moved[best] - moved[best].mean()
    return lags[best], float(centred @ found[frames] / (centred @ centred))
