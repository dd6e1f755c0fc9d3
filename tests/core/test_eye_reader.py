"""Reading the gaze: from the kernel to a person whose eyes hardly moved in the setup."""

from pathlib import Path

import numpy as np
import pytest

from core.camera import camera_for, project
from core.errors import ArrayShapeError
from core.eye_reader import EyeReader, EyeReading
from core.eye_trainer import (
    EyePictures,
    EyeTrainSettings,
    eye_picture,
    inside_polygon,
    train_eyes,
)
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.landmarks import N_LANDMARKS, NAMES
from core.records import Landmarks2D, SetupShapes

CAMERA = camera_for((640, 480), 620.0)
CENTERS_MM = np.array([[-31.0, 0.0, 0.0], [31.0, 0.0, 0.0]])
RADIUS_MM, IRIS_MM = 12.0, 6.0
#: Corners of the lids in mm from the eye's middle.
LIDS_MM = {
    "outer": (-13, 0), "up_outer": (-7, -4.5), "up_mid": (0, -5.5), "up_inner": (7, -4.5),
    "inner": (13, 0), "lo_inner": (7, 3.5), "lo_mid": (0, 4.5), "lo_outer": (-7, 3.5),
}  # fmt: skip


def lids_mm(eye):
    """Return the lids (8, 3) of one eye in the head frame."""
    side = 1 if eye == 0 else -1
    flat = np.array([(side * x, y, -0.95 * RADIUS_MM) for x, y in LIDS_MM.values()], float)
    return flat + CENTERS_MM[eye]


def pose_of(yaw, pitch, shift):
    rotation = matrix_from_head_angles(yaw, pitch, 0.0)
    return np.vstack([rotation, np.array([0, 0, 580.0]) + shift])


def drawn(pose, gaze, rng):
    """Return a picture (H, W) of two eyes with dark irises between lids."""
    height, width = 480, 640
    picture = np.full((height, width), 150.0)
    y, x = np.mgrid[0:height, 0:width]
    rays = np.stack([(x - CAMERA.center_px[0]) / 620, (y - CAMERA.center_px[1]) / 620,
                     np.ones_like(x)], -1) @ pose[:3]  # fmt: skip
    eye_point = -pose[3] @ pose[:3]
    for eye in range(2):
        plane = CENTERS_MM[eye, 2] - 0.95 * RADIUS_MM
        along = (plane - eye_point[2]) / rays[..., 2]
        at = (eye_point + along[..., None] * rays)[..., :2] - CENTERS_MM[eye, :2]
        corners = lids_mm(eye)[:, :2] - CENTERS_MM[eye, :2]
        upper = np.interp(at[..., 0], *sorted_curve(corners[[0, 1, 2, 3, 4]]))
        lower = np.interp(at[..., 0], *sorted_curve(corners[[0, 7, 6, 5, 4]]))
        opened = (at[..., 1] > upper) & (at[..., 1] < lower) & (np.abs(at[..., 0]) < 13)
        yaw, pitch = gaze
        middle = RADIUS_MM * np.array([np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
        iris = np.hypot(at[..., 0] - middle[0], at[..., 1] - middle[1])
        ball = np.where(iris < 2.5, 20.0, np.where(iris < IRIS_MM, 70.0, 215.0))
        picture = np.where(opened, ball, picture)
    return np.clip(picture + rng.normal(0, 2, picture.shape), 0, 255).astype(np.uint8)


def sorted_curve(points):
    order = np.argsort(points[:, 0])
    return points[order, 0], points[order, 1]


def landmarks_at(pose):
    points = np.zeros((N_LANDMARKS, 2))
    for eye, side in enumerate("RL"):
        lids = project(CAMERA, lids_mm(eye) @ pose[:3].T + pose[3])
        for corner, place in zip(LIDS_MM, lids, strict=True):
            points[NAMES.index(f"{side}_eye_{corner}")] = place
    seen = np.ones(N_LANDMARKS)
    return Landmarks2D(points, np.zeros(N_LANDMARKS, bool), seen, np.zeros((2, 2)), np.ones(2))


@pytest.fixture(scope="module")
def pictures():
    """Return setup pictures in which the eyes look at the camera, give or take 3 degrees."""
    rng = np.random.default_rng(1)
    gray, marks, poses, shapes = [], [], [], []
    for n in range(10):
        pose = pose_of(np.deg2rad(4 * n - 18), 0.02 * (n % 3), rng.normal(0, 8, 3))
        gaze = rng.normal(0, 0.05, 2)
        forward = -matrix_from_head_angles(*gaze, 0.0)[:, 2]
        points = np.zeros((N_LANDMARKS + 2, 3)) + [0, 0, 500.0]
        points[-2:] = (CENTERS_MM + RADIUS_MM * forward) @ pose[:3].T + pose[3]
        gray.append(drawn(pose, gaze, rng))
        marks.append(landmarks_at(pose))
        poses.append(pose)
        shapes.append(points)
    rotations = np.stack([quaternion_from_matrix(pose[:3]) for pose in poses])
    places = np.stack([pose[3] for pose in poses])
    recovered = SetupShapes(np.stack(shapes), rotations, places, np.zeros((10, 46)), np.ones(10))
    return EyePictures(
        gray, CAMERA, marks, recovered, np.zeros((10, 2)), CENTERS_MM, np.full(2, RADIUS_MM)
    )


@pytest.fixture(scope="module")
def reader(pictures):
    return train_eyes(pictures, np.random.default_rng(0))


def test_looks_to_all_sides_are_read_though_the_setup_has_none(reader):
    rng = np.random.default_rng(2)
    reading = EyeReading(reader, CAMERA, CENTERS_MM, np.full(2, RADIUS_MM))
    found, true = [], []
    for _ in range(40):
        pose = pose_of(*rng.uniform(-0.3, 0.3, 2) * [1, 0.3], rng.normal(0, 15, 3))
        gaze = rng.uniform([-0.5, -0.3], [0.5, 0.3])
        found.append(reading.directions(drawn(pose, gaze, rng), pose).mean(axis=0))
        true.append(gaze)
    apart = np.rad2deg(np.abs(np.array(found) - true).mean(axis=0))
    assert apart[0] < 3.0
    assert apart[1] < 3.0


def test_a_brighter_picture_of_less_contrast_says_the_same(reader):
    pose, rng = pose_of(0.1, 0.0, np.zeros(3)), np.random.default_rng(3)
    picture = drawn(pose, (0.3, 0.1), rng)
    reading = EyeReading(reader, CAMERA, CENTERS_MM, np.full(2, RADIUS_MM))
    usual = reading.directions(picture, pose)
    pale = reading.directions((picture * 0.6 + 80).astype(np.uint8), pose)
    assert np.rad2deg(np.abs(pale - usual)).max() < 2.5


def test_an_eye_is_left_out_where_it_is_closed_unseen_or_turned_away(pictures):
    settings = EyeTrainSettings()
    assert eye_picture(pictures, 4, 0, settings) is not None
    blinking = EyePictures(
        pictures.gray, CAMERA, pictures.landmarks, pictures.shapes, np.ones((10, 2)), CENTERS_MM,
        pictures.radii_mm,
    )  # fmt: skip
    assert eye_picture(blinking, 4, 0, settings) is None
    assert eye_picture(pictures, 0, 0, EyeTrainSettings(turned_rad=0.2)) is None


def test_nothing_is_learned_from_too_few_eyes(pictures):
    assert train_eyes(pictures, np.random.default_rng(0), EyeTrainSettings(least_eyes=11)) is None


def test_distance_from_a_polygon_is_positive_inside_only():
    square = np.array([(-4.0, -3.0), (4.0, -3.0), (4.0, 3.0), (-4.0, 3.0)])
    inside = inside_polygon(square)
    middle = inside.shape[0] // 2, inside.shape[1] // 2
    assert inside[middle] == pytest.approx(3.0)
    assert inside[0, 0] < 0
    assert inside[middle[0], middle[1] + 20] == pytest.approx(-6.0)


def test_arrays_give_the_reader_back(reader, tmp_path: Path):
    np.savez(tmp_path / "eyes.npz", allow_pickle=False, **reader.arrays())
    with np.load(tmp_path / "eyes.npz") as stored:
        again = EyeReader.from_arrays(dict(stored))
    np.testing.assert_array_equal(again.weights, reader.weights)
    assert again.narrowness == reader.narrowness


def test_a_reader_whose_weights_are_not_those_of_its_examples_is_refused():
    with pytest.raises(ArrayShapeError, match=r"weights.*\(2, 115, 2\).*\(2, 117, 2\)"):
        EyeReader(np.zeros((2, 4, 112)), np.zeros((2, 115, 2)), 0.06)
