import numpy as np
import pytest

from core.camera import camera_for, project
from core.evaluation import (
    Truth,
    against_reference,
    against_truth,
    depth_errors_mm,
    frame_rmse_px,
    jitter,
    share_under,
    still_frames,
)
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.records import FaceState

CAMERA = camera_for((640, 480), 600.0)


def make_state(points_mm, lost=False, yaw_deg=0.0, offset_px=0.0):
    return FaceState(
        time_s=0.0,
        rotation_wxyz=quaternion_from_matrix(
            matrix_from_head_angles(np.deg2rad(yaw_deg), 0.0, 0.0)
        ),
        translation_mm=np.zeros(3),
        expression=np.zeros(46),
        gaze_rad=np.zeros((2, 2)),
        shape_mm=points_mm,
        landmarks_px=project(CAMERA, points_mm) + offset_px,
        confidence=1.0,
        mode="trained",
        lost=lost,
    )


@pytest.fixture
def points_mm():
    rng = np.random.default_rng(0)
    return rng.normal(0, 30, (75, 3)) + [0, 0, 600]


def test_rmse_is_the_root_of_the_mean_square_distance():
    points = np.zeros((1, 2, 2))
    reference = np.array([[[3.0, 4.0], [0.0, 0.0]]])
    assert frame_rmse_px(points, reference) == pytest.approx([np.sqrt(12.5)])


def test_share_counts_strictly_under_and_ignores_unknown_frames():
    assert share_under(np.array([1.0, 3.0, np.nan]), (3.0,)) == {"3": 0.5}


def test_jitter_is_the_deviation_of_white_noise_and_blind_to_steady_motion():
    rng = np.random.default_rng(1)
    drift = np.linspace(0, 50, 4000)[:, None]
    noise = rng.normal(0, 0.3, (4000, 1))
    assert jitter(drift + noise, np.ones(4000, bool)) == pytest.approx(0.3, rel=0.05)


def test_still_frames_excludes_the_stretch_that_moves(points_mm):
    face = project(CAMERA, points_mm)
    track = np.repeat(face[None], 60, axis=0)
    track[30:40] += np.linspace(0, 60, 10)[:, None, None]
    still = still_frames(track)
    assert still[10] and not still[35] and not still[32]


def test_a_perfect_track_has_no_error(points_mm):
    state = make_state(points_mm)
    truth = Truth(points_mm, state.rotation_wxyz, np.zeros(3), state.expression, np.zeros((2, 2)))
    result = against_truth([state], [truth], CAMERA)
    assert result["rmse_px"]["mean"] == pytest.approx(0, abs=1e-9)
    assert result["depth_mm"]["mean"] == pytest.approx(0, abs=1e-9)
    assert result["rotation_deg"]["mean"] == pytest.approx(0, abs=1e-5)
    assert result["share_under_px"]["3"] == 1.0


def test_depth_error_ignores_the_scale_that_one_camera_cannot_see(points_mm):
    assert depth_errors_mm(1.1 * points_mm[None], points_mm[None]) == pytest.approx([0], abs=1e-9)
    flattened = points_mm.copy()
    flattened[:, 2] = 600
    assert depth_errors_mm(flattened[None], points_mm[None])[0] > 10


def test_reference_errors_are_given_for_640_px_wide_pictures(points_mm):
    state = make_state(points_mm, offset_px=1.0)
    reference = project(CAMERA, points_mm)[None, :60]
    result = against_reference([state], reference, range(60), width_px=320)
    assert result["median_rmse_px"] == pytest.approx(2 * np.sqrt(2))
    assert result["share_under_px"]["3"] == 1.0


def test_lost_frames_count_as_missed(points_mm):
    states = [make_state(points_mm), make_state(points_mm, lost=True)]
    reference = np.repeat(project(CAMERA, points_mm)[None, :60], 2, axis=0)
    result = against_reference(states, reference, range(60), width_px=640)
    assert result["share_under_px"]["6"] == 0.5
    assert result["lost"] == 1
