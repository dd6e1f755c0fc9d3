"""A made-up face for the tests of the fits: an ellipsoid with landmarks, strips and shapes."""

from types import SimpleNamespace

import numpy as np

from core.camera import camera_for, project
from core.fit_problem import State, posed
from core.fit_space import FitSpace
from core.geometry import matrix_from_head_angles
from core.model_fit import choose_picks
from core.records import Landmarks2D

SIZE_PX = (640, 480)
RADII_MM = np.array([70.0, 95.0, 85.0])
MIDDLE_MM = np.array([0.0, 30.0, 85.0])
N_STRIP = 10


def on_ellipsoid(azimuth, height):
    """Points at an angle from straight ahead, positive to the left, and a height in -1..1."""
    width = np.sqrt(1 - np.asarray(height, float) ** 2)
    unit = np.stack(
        [width * np.sin(azimuth), height + 0 * azimuth, -width * np.cos(azimuth)], axis=-1
    )
    return MIDDLE_MM + RADII_MM * unit


def strip_points():
    """15 strips (15, N_STRIP, 3) from R1 over the chin to L1, each from the front to the back."""
    side_heights = np.linspace(-0.4, 0.65, 7)
    azimuths = np.linspace(0.35, 1.9, N_STRIP)
    left = [on_ellipsoid(azimuths, np.full(N_STRIP, height)) for height in side_heights]
    chin = on_ellipsoid(np.zeros(N_STRIP), np.linspace(0.6, 0.999, N_STRIP))
    chin[N_STRIP // 2 :, 2] += np.linspace(0, 60, N_STRIP - N_STRIP // 2)
    right = [points * [-1, 1, 1] for points in left]
    return np.stack([*right, chin, *left[::-1]])


def smooth_field(points, rng, size_mm, reach_mm, n_centers=5):
    centers = points[rng.integers(0, len(points), n_centers)]
    squares = np.sum((points[:, None] - centers[None]) ** 2, axis=-1)
    return np.exp(-0.5 * squares / reach_mm**2) @ rng.normal(size=(n_centers, 3)) * size_mm


def synthetic_space(n_identity=8, n_shapes=46, seed=0):
    """A FitSpace with smooth identity modes and local shapes."""
    rng = np.random.default_rng(seed)
    inner = on_ellipsoid(rng.uniform(-0.6, 0.6, 60), rng.uniform(-0.5, 0.6, 60))
    inner[28:33] += [0.0, 0.0, -18.0]
    strips = strip_points()
    points = np.concatenate([inner, strips.reshape(-1, 3)])
    modes = np.stack([smooth_field(points, rng, 3.0, 40.0) for _ in range(n_identity)])
    deltas = np.zeros((n_shapes, n_identity + 1, len(points), 3))
    for shape in range(n_shapes):
        deltas[shape, 0] = smooth_field(points, rng, 6.0, 18.0, n_centers=2)
        deltas[shape, 1:] = 0.05 * rng.normal(size=(n_identity, 1, 1)) * deltas[shape, 0]
    numbers = 60 + np.arange(strips.shape[0] * N_STRIP, dtype=np.int32).reshape(-1, N_STRIP)
    return FitSpace(
        np.arange(len(points), dtype=np.int32),
        numbers,
        numbers[:, 3],
        points,
        np.moveaxis(modes, 0, -1).copy(),
        np.moveaxis(deltas, 1, -1).copy(),
    )


def landmarks_of(points_px, confidence=1.0):
    n = len(points_px)
    return Landmarks2D(
        points_px, np.zeros(n, bool), np.full(n, confidence), np.zeros((2, 2)), np.zeros(2)
    )


def synthetic_pictures(space, identity, rng, n_pictures=12, focal_px=600.0, noise_px=0.0):
    """Pictures of one person: the truth, and the landmarks that a camera would see."""
    camera = camera_for(SIZE_PX, focal_px)
    face = space.face(identity, np.zeros((60, 3)))
    yaws = np.linspace(-0.7, 0.7, n_pictures)
    rotations = np.stack([matrix_from_head_angles(yaw, *rng.uniform(-0.2, 0.2, 2)) for yaw in yaws])
    translations = rng.normal(size=(n_pictures, 3)) * [20, 15, 30] + [0, 0, focal_px]
    expressions = np.zeros((n_pictures, len(face.deltas_mm)))
    for row in expressions:
        row[rng.integers(0, len(row), 3)] = rng.uniform(0.2, 1.0, 3)
    state = State(rotations, translations, expressions)
    picks = choose_picks(face, state)
    points = posed(face.points_mm(expressions), state)
    points_px = project(camera, np.take_along_axis(points, picks[..., None], axis=1))
    points_px = points_px + noise_px * rng.normal(size=points_px.shape)
    return SimpleNamespace(
        camera=camera, face=face, identity=identity, state=state, picks=picks,
        landmarks=[landmarks_of(one) for one in points_px],
    )  # fmt: skip


def result_of(steps):
    """Run a generator to its end and return what it returns."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value
