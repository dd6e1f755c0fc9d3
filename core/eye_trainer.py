"""Teaches a reader where the eyes look, from setup pictures in which they hardly move.

Each open eye of a setup picture is painted anew, looking to all sides: the iris as a disc with the
grey levels that it has at each distance from its middle, the white as a plane of grey levels, both
in the shadow of the lids; the lids stay. Patches of these pictures, blurred, shifted and noisy as
poses and webcams make them, are the examples.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from core.camera import unproject
from core.eye_reader import (
    LEAST_SPREAD,
    PATCH_PIXELS,
    XS_MM,
    YS_MM,
    EyeReader,
    camera_numbers,
    patch_middles,
)
from core.gaze import pupil_directions
from core.geometry import matrix_from_quaternion
from core.kernels.eyes import level_patch, read_eye
from core.landmarks import NAMES
from core.pupils import SEEN
from core.records import F32, U8, BoolArray, Camera, FloatArray, Landmarks2D, SetupShapes

#: Raster on which eyes are painted.
_STEP_MM = 0.5
_FINE_X: FloatArray = np.arange(-16.0, 16.1, _STEP_MM)
_FINE_Y: FloatArray = np.arange(-9.0, 9.1, _STEP_MM)
_X, _Y = np.meshgrid(_FINE_X, _FINE_Y)
_CORNERS = ("outer", "up_outer", "up_mid", "up_inner", "inner", "lo_inner", "lo_mid", "lo_outer")
#: Rings of the iris, and pixels of the white that must be seen.
_RINGS, _LEAST_WHITE = 6, 12
_LIDS = [[NAMES.index(f"{side}_eye_{corner}") for corner in _CORNERS] for side in "RL"]


@dataclass(frozen=True, slots=True)
class EyeTrainSettings:
    """How eyes are painted and learned.

    Attributes:
        turned_rad: Heads turned further are left out: one eye is hardly seen.
        closed: Blink coefficient from which an eye is closed.
        looks: Directions painted per eye and picture.
        yaw_rad: Furthest look to the side.
        pitch_rad: Furthest look up or down.
        iris_mm: Radius of the iris.
        shift_mm: Standard deviation of the patch's place: the pose is not exact.
        scale: Standard deviation of its size.
        noise: Of the webcam, grey levels.
        examples: At most so many are kept for each eye.
        narrowness: See EyeReader.
        ridge: Weight of small weights.
        linear: Size of the linear part's inputs against the examples'.
        least_eyes: With fewer eyes of one side nothing is learned.
    """

    turned_rad: float = 0.7
    closed: float = 0.5
    looks: int = 32
    yaw_rad: float = 0.6
    pitch_rad: float = 0.35
    iris_mm: float = 6.0
    shift_mm: float = 0.5
    scale: float = 0.03
    noise: float = 2.0
    examples: int = 300
    narrowness: float = 0.06
    ridge: float = 3.0
    linear: float = 0.1
    least_eyes: int = 6


class EyePicture(NamedTuple):
    """One eye in a setup picture, on the fine raster.

    Attributes:
        grey: (Y, X) grey levels.
        inside_mm: (Y, X) distance from the lids, positive between them.
        direction: (2,) yaw and pitch of the look.
        radius_mm: Of the eyeball.
    """

    grey: FloatArray
    inside_mm: FloatArray
    direction: FloatArray
    radius_mm: float


class Colours(NamedTuple):
    """What an eye is painted with.

    Attributes:
        iris: (R,) grey levels at growing distance from the iris' middle.
        white: (Y, X).
    """

    iris: FloatArray
    white: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class EyePictures:
    """The setup pictures, for learning.

    Attributes:
        gray: N pictures (H, W).
        camera: Theirs.
        landmarks: Their landmarks.
        shapes: Their 3D shapes and poses; NaN where they are only a guess.
        blinks: (N, 2) blink coefficients of the right, then the left eye.
        centers_mm: (2, 3) eyeball centres in the head frame.
        radii_mm: (2,).
    """

    gray: Sequence[U8]
    camera: Camera
    landmarks: Sequence[Landmarks2D]
    shapes: SetupShapes
    blinks: FloatArray
    centers_mm: FloatArray
    radii_mm: FloatArray


def train_eyes(
    pictures: EyePictures, rng: np.random.Generator, settings: EyeTrainSettings | None = None
) -> EyeReader | None:
    """Return what reads the gaze of the person in the pictures.

    Args:
        pictures: Setup pictures.
        rng: Source of all random choices.
        settings: How.

    Returns:
        The reader, None where too few eyes are open and seen.
    """
    settings = settings or EyeTrainSettings()
    sides = [_side(pictures, eye, rng, settings) for eye in range(2)]
    if any(side is None for side in sides):
        return None
    learned = [side for side in sides if side is not None]
    count = min(settings.examples, *(len(patches) for patches, _ in learned))
    examples, weights = [], []
    for patches, directions in learned:
        chosen = patches[rng.permutation(len(patches))[:count]]
        examples.append(chosen)
        weights.append(_weights(patches, directions, chosen, settings))
    return EyeReader(np.stack(examples), np.stack(weights), settings.narrowness)


def _side(
    pictures: EyePictures, eye: int, rng: np.random.Generator, settings: EyeTrainSettings
) -> tuple[F32, FloatArray] | None:
    """Return patches (S, P) of one eye and where it looks in each (S, 2), None of too few."""
    seen = [eye_picture(pictures, n, eye, settings) for n in range(len(pictures.gray))]
    painted = [
        (one, colours)
        for one in seen
        if one is not None and (colours := colours_of(one, settings.iris_mm)) is not None
    ]
    if len(painted) < settings.least_eyes:
        return None
    patches, directions = [], []
    for one, colours in painted:
        for look in range(settings.looks):
            turned = rng.uniform(-1, 1, 2) * [settings.yaw_rad, settings.pitch_rad]
            # The first is the eye as it is.
            direction = turned if look else one.direction
            grey = repainted(one, colours, direction, rng, settings.iris_mm) if look else one.grey
            patches.append(_seen_patch(grey, rng, settings))
            directions.append(direction)
    return np.stack(patches), np.stack(directions)


def eye_picture(
    pictures: EyePictures, n: int, eye: int, settings: EyeTrainSettings
) -> EyePicture | None:
    """Return an eye of a picture, None where it is closed, unseen or turned away."""
    shapes, landmarks = pictures.shapes, pictures.landmarks[n]
    rotation = matrix_from_quaternion(shapes.rotations_wxyz[n])
    unseen = not np.isfinite(shapes.rms_px[n]) or landmarks.pupil_confidence[eye] < SEEN
    if unseen or pictures.blinks[n, eye] > settings.closed:
        return None
    if rotation[2, 2] < np.cos(settings.turned_rad):
        return None
    pose = np.vstack([rotation, shapes.translations_mm[n]])
    middle = patch_middles(pictures.centers_mm, pictures.radii_mm)[eye]
    grey = np.empty(_X.size, np.float32)
    numbers = camera_numbers(pictures.camera)
    read_eye(pictures.gray[n], numbers, pose, middle, _FINE_X, _FINE_Y, 0.0, grey)
    lids_mm = _on_plane(landmarks.points_px[_LIDS[eye]], pictures.camera, pose, middle)
    looks = pupil_directions(shapes.points_mm[n, -2:], pose, pictures.centers_mm, pictures.radii_mm)
    return EyePicture(
        grey.reshape(_X.shape).astype(float),
        inside_polygon(lids_mm),
        looks[eye],
        float(pictures.radii_mm[eye]),
    )


def _on_plane(
    points_px: FloatArray, camera: Camera, pose: FloatArray, middle: FloatArray
) -> FloatArray:
    """Return where lines of sight (n, 2) meet the patch's plane, (n, 2) mm from its middle."""
    rays = unproject(camera, points_px, np.ones(len(points_px))) @ pose[:3]
    eye = -pose[3] @ pose[:3]
    along = (middle[2] - eye[2]) / rays[:, 2]
    return np.asarray((eye + along[:, None] * rays - middle)[:, :2])


def inside_polygon(corners: FloatArray) -> FloatArray:
    """Return the distance (Y, X) of the fine raster from a polygon (n, 2), positive inside."""
    points = np.stack([_X, _Y], axis=-1)[..., None, :]
    edges = np.roll(corners, -1, axis=0) - corners
    away = points - corners
    along = np.sum(away * edges, axis=-1) / np.maximum(np.sum(edges**2, axis=-1), 1e-9)
    nearest = away - np.clip(along, 0, 1)[..., None] * edges
    distance = np.linalg.norm(nearest, axis=-1).min(axis=-1)
    # A ray to the right crosses the border an odd number of times from inside.
    above = corners[:, 1] > points[..., 1]
    crosses = above != np.roll(above, -1, axis=-1)
    steep = np.where(edges[:, 1] == 0, 1e-9, edges[:, 1])
    right = away[..., 0] < away[..., 1] / steep * edges[:, 0]
    inside = np.sum(crosses & right, axis=-1) % 2 == 1
    return np.asarray(np.where(inside, distance, -distance))


def colours_of(eye: EyePicture, iris_mm: float) -> Colours | None:
    """Return the colours of an eye, None where iris or white are hardly seen."""
    middle = iris_middle(eye.direction, eye.radius_mm)
    away = np.hypot(_X - middle[0], _Y - middle[1])
    seen = eye.inside_mm > 0.3
    ring = np.minimum((away / iris_mm * _RINGS).astype(int), _RINGS)
    iris = np.array([
        eye.grey[seen & (ring == k)].mean() if np.sum(seen & (ring == k)) > 1 else np.nan
        for k in range(_RINGS)
    ])  # fmt: skip
    white = seen & (away > 1.25 * iris_mm)
    known = np.isfinite(iris)
    if white.sum() < _LEAST_WHITE or known.sum() < _RINGS - 2:
        return None
    iris = np.interp(np.arange(_RINGS), np.flatnonzero(known), iris[known])
    return Colours(iris, _plane_of_greys(eye.grey, white))


def _plane_of_greys(grey: FloatArray, where: BoolArray) -> FloatArray:
    """Return the plane of grey levels (Y, X) through some of them, rather flat."""
    inputs = np.stack([np.ones_like(_X), _X, _Y], axis=-1)
    chosen = inputs[where]
    stiff = len(chosen) * np.diag([0.0, 1.5, 3.0])
    slopes = np.linalg.solve(chosen.T @ chosen + stiff, chosen.T @ grey[where])
    return np.asarray(inputs @ slopes)


def iris_middle(direction: FloatArray, radius_mm: float) -> FloatArray:
    """Return the middle of the iris (2,) in the patch's plane for yaw and pitch (2,)."""
    yaw, pitch = direction
    return radius_mm * np.array([np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])


def repainted(
    eye: EyePicture, colours: Colours, direction: FloatArray, rng: np.random.Generator,
    iris_mm: float,
) -> FloatArray:  # fmt: skip
    """Return an eye (Y, X) that looks elsewhere, the lids as they are."""
    middle = iris_middle(direction, eye.radius_mm)
    side = middle / eye.radius_mm
    sine = max(float(np.linalg.norm(side)), 1e-9)
    across, along = side / sine, np.array([-side[1], side[0]]) / sine
    x, y = _X - middle[0], _Y - middle[1]
    # A disc that looks aside is seen narrower.
    narrow = np.sqrt(max(1 - sine**2, 0.3))
    away = np.hypot((x * across[0] + y * across[1]) / narrow, x * along[0] + y * along[1])
    rings = (np.arange(_RINGS) + 0.5) * iris_mm / _RINGS
    disc = np.clip((iris_mm + 0.4 - away) / 0.8, 0, 1)
    ball = disc * np.interp(away, rings, colours.iris) + (1 - disc) * colours.white
    # The lids' shadow, deeper or lighter, as lamps make it.
    deep, reach_mm = 1 - rng.uniform(0.55, 0.95), rng.uniform(0.7, 1.6)
    ball *= 1 - deep * np.exp(-np.maximum(eye.inside_mm, 0) / reach_mm)
    between = np.clip(eye.inside_mm / _STEP_MM + 0.5, 0, 1)
    return np.asarray((1 - between) * eye.grey + between * ball)


def _seen_patch(grey: FloatArray, rng: np.random.Generator, settings: EyeTrainSettings) -> F32:
    """Return the levelled patch (P,) of a painted eye as a webcam and an inexact pose show it."""
    # Slow to load, and who only opens the window never trains.
    from scipy.ndimage import gaussian_filter, map_coordinates

    blurred = gaussian_filter(grey, rng.uniform(0.4, 0.9) / _STEP_MM)
    scale = 1 + settings.scale * rng.normal()
    shift = settings.shift_mm * rng.normal(size=2)
    x, y = np.meshgrid(scale * XS_MM + shift[0], scale * YS_MM + shift[1])
    places = [(y - _FINE_Y[0]) / _STEP_MM, (x - _FINE_X[0]) / _STEP_MM]
    patch = map_coordinates(blurred, places, order=1, mode="nearest").ravel()
    patch = (patch + settings.noise * rng.normal(size=PATCH_PIXELS)).astype(np.float32)
    level_patch(patch, LEAST_SPREAD)
    return np.asarray(patch)


def _weights(
    patches: F32, directions: FloatArray, examples: F32, settings: EyeTrainSettings
) -> FloatArray:
    """Return the weights (C + P + 1, 2) of the ridge regression."""
    square = np.sum(patches**2, axis=1)[:, None] + np.sum(examples**2, axis=1)
    near = np.exp(-settings.narrowness * (square - 2 * patches @ examples.T))
    inputs = np.hstack([near, settings.linear * patches, np.ones((len(patches), 1))]).astype(float)
    normal = inputs.T @ inputs + settings.ridge * np.eye(inputs.shape[1])
    weights = np.linalg.solve(normal, inputs.T @ directions)
    weights[len(examples) : -1] *= settings.linear
    return np.asarray(weights)
