"""The training-free tracker recovers what is shown, whatever is shown."""

from dataclasses import replace

import numpy as np
import pytest

from core.camera import camera_for
from core.energy_face import ROBUST, landmark_rows
from core.energy_terms import EnergySettings, PaperSettings, predicted_pose
from core.energy_tracker import EnergyTracker
from core.evaluation import jitter
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.landmarks import N_INTERNAL, TO_IBUG68
from tests.core.seen_faces import CAMERA, SURE, face, head_pose, landmarks, nodding, turned_deg
from tests.core.tracked_faces import expression, index, needs_compiled_kernels

FPS = 30.0
#: Of the aligner on a still face at 640x480.
NOISE_PX = 0.2
SOLVERS = ("paper", "joint")


def unfiltered(solver):
    return EnergySettings(solver=solver, pose_filter=None)


def follow(tracker, seen, confidence=SURE):
    return [tracker.step(points, confidence, k / FPS) for k, points in enumerate(seen)]


def talking(k):
    """Return the coefficients (46,) of a mouth that opens and smiles, at frame k."""
    return expression(
        jawOpen=0.3 - 0.3 * np.cos(k / 5), mouthSmile=0.3 - 0.3 * np.cos(k / 9),
        eyeBlink=float(k % 40 in (20, 21, 22)),
    )  # fmt: skip


def test_landmarks_are_68_of_the_scheme_with_the_outline_last():
    rows = landmark_rows(68)
    assert len(set(rows)) == 68
    assert sum(TO_IBUG68[row] >= 0 for row in rows if row < N_INTERNAL) == 51
    assert list(rows[-15:]) == list(range(60, 75))
    assert set(ROBUST) < set(rows)
    assert sorted(landmark_rows(75)) == list(range(75))


def test_another_number_of_landmarks_is_refused():
    with pytest.raises(ValueError, match="68 or 75"):
        landmark_rows(51)


@needs_compiled_kernels
@pytest.mark.parametrize(
    "solver, most_deg, most_wrong", [("paper", 3.0, 0.1), ("joint", 1.0, 0.03)]
)
def test_pose_and_expression_are_recovered(rng, solver, most_deg, most_wrong):
    tracker = EnergyTracker(face(), CAMERA, unfiltered(solver))
    for k in range(60):
        seen = landmarks(face(), talking(k), nodding(k)) + NOISE_PX * rng.normal(size=(75, 2))
        solved = tracker.step(seen, SURE, k / FPS)
        assert turned_deg(solved, nodding(k)) < most_deg
        assert np.abs(solved.translation_mm - nodding(k)[3]).max() < 12 * most_deg
        assert np.abs(solved.expression - talking(k)).mean() < most_wrong
    assert solved.confidence > 0.9


@needs_compiled_kernels
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    "yaw, pitch, roll", [(0, 0, 0), (0.8, 0, 0), (-0.6, 0.3, 0.4), (0.3, -0.4, -0.5)]
)
def test_a_face_is_found_at_once_however_it_is_turned(solver, yaw, pitch, roll):
    pose = head_pose(yaw, pitch, roll, (60.0, -40.0, 800.0))
    tracker = EnergyTracker(face(), CAMERA, unfiltered(solver))
    solved = tracker.step(landmarks(face(), expression(jawOpen=0.3), pose), SURE, 0.0)
    # The paper's pose knows nothing yet of the open mouth.
    assert turned_deg(solved, pose) < (2.5 if solver == "paper" else 0.5)
    np.testing.assert_allclose(solved.translation_mm, pose[3], rtol=0.04, atol=4)


@needs_compiled_kernels
@pytest.mark.parametrize("solver", SOLVERS)
def test_coefficients_stay_in_range_and_numbers_finite_whatever_comes(rng, solver):
    tracker = EnergyTracker(face(), CAMERA, EnergySettings(solver=solver))
    for k in range(80):
        points = rng.uniform(-300, 900, size=(75, 2)) if k % 3 else np.full((75, 2), 100.0)
        solved = tracker.step(points, rng.random(75), k / FPS)
        assert solved.expression.min() >= 0
        assert solved.expression.max() <= 1
        assert np.isfinite(solved.rotation_wxyz).all()
        assert np.isfinite(solved.translation_mm).all()
        assert 0 <= solved.confidence <= 1


@needs_compiled_kernels
def test_after_nonsense_a_face_is_found_again(rng):
    tracker = EnergyTracker(face(), CAMERA, unfiltered("joint"))
    for k in range(5):
        nonsense = tracker.step(rng.uniform(0, 480, size=(75, 2)), SURE, k / FPS)
    assert nonsense.confidence < 0.2
    pose = head_pose(-0.4, 0.1, 0.0)
    for k in range(5, 8):
        solved = tracker.step(landmarks(face(), expression(), pose), SURE, k / FPS)
    assert turned_deg(solved, pose) < 0.5
    assert solved.confidence == pytest.approx(1.0)


@needs_compiled_kernels
def test_rotation_of_a_still_face_jitters_less_than_a_twentieth_of_a_degree(rng):
    pose = head_pose()
    seen = landmarks(face(), expression(), pose)
    tracker = EnergyTracker(face(), CAMERA)
    solved = follow(tracker, seen + 0.3 * rng.normal(size=(150, 75, 2)))
    angles = np.rad2deg(
        [head_angles_from_matrix(matrix_from_quaternion(s.rotation_wxyz)) for s in solved[20:]]
    )
    still = np.ones(len(angles), bool)
    for axis in range(3):
        assert jitter(angles[:, axis], still) < 0.05
    assert jitter(np.array([s.expression for s in solved[20:]]), still) < 0.01


@needs_compiled_kernels
def test_a_blink_of_three_frames_closes_the_eyes_at_once():
    tracker = EnergyTracker(face(), CAMERA)
    for k in range(30):
        solved = tracker.step(landmarks(face(), talking(k), head_pose()), SURE, k / FPS)
        blink = solved.expression[index("eyeBlinkLeft")]
        assert blink > 0.85 if k in (20, 21, 22) else blink < 0.1


@needs_compiled_kernels
def test_a_turn_of_ninety_degrees_a_second_is_followed_without_visible_lag(rng):
    tracker = EnergyTracker(face(), CAMERA)
    wrong = []
    for k in range(40):
        pose = head_pose(np.deg2rad(-45 + 3.0 * min(k, 30)), 0.0, 0.0)
        seen = landmarks(face(), expression(), pose) + NOISE_PX * rng.normal(size=(75, 2))
        wrong.append(turned_deg(tracker.step(seen, SURE, k / FPS), pose))
    # A third of a frame, once it is on its way.
    assert max(wrong[8:]) < 1.0


@needs_compiled_kernels
def test_a_hand_over_the_mouth_disturbs_the_robust_solver_less(rng):
    wrong = {}
    for solver in SOLVERS:
        tracker, errors = EnergyTracker(face(), CAMERA, unfiltered(solver)), []
        for k in range(30):
            seen = landmarks(face(), expression(), nodding(k))
            if k >= 10:
                seen[40:60] += [15.0, 25.0]
            errors.append(turned_deg(tracker.step(seen, SURE, k / FPS), nodding(k)))
        wrong[solver] = np.mean(errors[10:])
    assert wrong["joint"] < 1.5
    assert wrong["joint"] < 0.5 * wrong["paper"]


@needs_compiled_kernels
@pytest.mark.parametrize("solver", SOLVERS)
def test_landmarks_without_confidence_do_not_count(rng, solver):
    pose = head_pose(0.2)
    seen = landmarks(face(), expression(), pose)
    confidence = SURE.copy()
    hidden = rng.permutation(75)[:25]
    confidence[hidden] = 0.0
    spoilt = seen.copy()
    spoilt[hidden] += rng.normal(size=(25, 2)) * 100
    one, other = (EnergyTracker(face(), CAMERA, unfiltered(solver)) for _ in range(2))
    np.testing.assert_allclose(
        one.step(seen, confidence, 0.0).rotation_wxyz,
        other.step(spoilt, confidence, 0.0).rotation_wxyz, atol=1e-9,
    )  # fmt: skip


def test_without_any_landmark_the_last_face_is_held():
    tracker = EnergyTracker(face(), CAMERA)
    seen = landmarks(face(), expression(), head_pose())
    last = tracker.step(seen, SURE, 0.0)
    held = tracker.step(seen, 0 * SURE, 1 / FPS)
    np.testing.assert_array_equal(held.rotation_wxyz, last.rotation_wxyz)
    np.testing.assert_array_equal(held.expression, last.expression)
    assert held.confidence == 0.0


@needs_compiled_kernels
@pytest.mark.parametrize("solver", SOLVERS)
def test_another_focal_length_moves_the_face_away_and_not_in_the_picture(solver):
    tracker = EnergyTracker(face(), CAMERA, EnergySettings(solver=solver))
    pose = head_pose(0.2, 0.1, 0.0, (40.0, -20.0, 600.0))
    seen = landmarks(face(), expression(), pose)
    before = [tracker.step(seen, SURE, k / FPS) for k in range(10)][-1]
    longer = camera_for((640, 480), 1.3 * CAMERA.focal_px)
    tracker.use(face(), longer)
    after = tracker.step(seen, SURE, 10 / FPS)
    assert after.translation_mm[2] == pytest.approx(1.3 * before.translation_mm[2], rel=0.03)
    np.testing.assert_allclose(after.translation_mm[:2], before.translation_mm[:2], atol=3)
    assert after.rms_px < 3


@needs_compiled_kernels
@pytest.mark.parametrize("solver", SOLVERS)
def test_pictures_of_another_size_change_nothing_in_space(solver):
    tracker = EnergyTracker(face(), CAMERA, EnergySettings(solver=solver))
    pose = head_pose(0.2, 0.1, 0.0, (40.0, -20.0, 600.0))
    before = follow(tracker, [landmarks(face(), talking(9), pose)] * 10)[-1]
    double = camera_for((1280, 960), 2 * CAMERA.focal_px)
    tracker.use(face(), double)
    after = tracker.step(landmarks(face(), talking(9), pose, double), SURE, 10 / FPS)
    np.testing.assert_allclose(after.translation_mm, before.translation_mm, atol=2.0)
    np.testing.assert_allclose(after.expression, before.expression, atol=0.05)
    assert turned_deg(after, pose) < 1.0


@needs_compiled_kernels
@pytest.mark.parametrize("solver", SOLVERS)
def test_pictures_that_turn_over_are_followed(solver):
    tracker = EnergyTracker(face(), CAMERA, unfiltered(solver))
    upright = head_pose(0.1, 0.1, 0.0, (30.0, 20.0, 600.0))
    follow(tracker, [landmarks(face(), expression(), upright)] * 5)
    portrait = camera_for((480, 640), CAMERA.focal_px)
    tracker.use(face(), portrait)
    lying = head_pose(0.1, 0.1, np.pi / 2, (-20.0, 30.0, 600.0))
    for k in range(5, 9):
        solved = tracker.step(landmarks(face(), expression(), lying, portrait), SURE, k / FPS)
    assert turned_deg(solved, lying) < 1.0


@needs_compiled_kernels
def test_a_better_face_halves_the_distance_and_keeps_the_past(rng):
    person = face(4)
    tracker = EnergyTracker(face(), CAMERA)
    seen = [landmarks(person, talking(k), nodding(k)) for k in range(60)]
    rough = follow(tracker, seen[:30])[-1]
    tracker.use(person, CAMERA)
    first = tracker.step(seen[30], SURE, 30 / FPS)
    assert first.rms_px < 0.5 * rough.rms_px
    assert np.abs(first.expression - rough.expression).max() < 0.7
    for k in range(31, 60):
        last = tracker.step(seen[k], SURE, k / FPS)
    assert turned_deg(last, nodding(59)) < 1.0


@needs_compiled_kernels
def test_points_in_space_project_onto_the_landmarks(rng):
    tracker = EnergyTracker(face(), CAMERA, unfiltered("joint"))
    pose, smile = nodding(7), expression(mouthSmile=0.6)
    tracker.step(landmarks(face(), smile, pose), SURE, 0.0)
    points = tracker.points_mm()
    chosen = np.concatenate([np.arange(N_INTERNAL), face().replacements])
    expected = face().points_mm(smile[None])[0, chosen] @ pose[:3].T + pose[3]
    assert points.shape == (75, 3)
    np.testing.assert_allclose(points[:, :2], expected[:, :2], atol=2.5)
    np.testing.assert_allclose(points[:, 2], expected[:, 2], atol=8)


@needs_compiled_kernels
def test_time_that_runs_back_or_a_reset_starts_anew():
    seen = [landmarks(face(), talking(k), nodding(k)) for k in range(12)]
    fresh = follow(EnergyTracker(face(), CAMERA), seen[:3])[-1]
    for forget in (lambda tracker: None, EnergyTracker.reset):
        tracker = EnergyTracker(face(), CAMERA)
        follow(tracker, seen)
        forget(tracker)
        again = follow(tracker, seen[:3])[-1]
        np.testing.assert_array_equal(again.rotation_wxyz, fresh.rotation_wxyz)
        np.testing.assert_array_equal(again.expression, fresh.expression)


@needs_compiled_kernels
def test_lips_are_not_closed_further_than_the_jaw_is_open(rng):
    tracker = EnergyTracker(face(), CAMERA)
    for k in range(20):
        seen = landmarks(face(), talking(k), head_pose()) + 2 * rng.normal(size=(75, 2))
        solved = tracker.step(seen, SURE, k / FPS)
        assert solved.expression[index("mouthClose")] <= solved.expression[index("jawOpen")] + 1e-12


@pytest.mark.parametrize("times, expected", [
    ([1.0, 0.9, 1.1], [3.0, 6.0]), ([1.0, 0.9, 1.2], [4.0, 8.0]), ([1.0, np.nan, 1.1], [2.0, 4.0]),
    ([1.0, 0.9, 2.0], [2.0, 4.0]), ([1.0, 0.5, 1.1], [2.0, 4.0]),
])  # fmt: skip
def test_a_head_is_expected_to_go_on_as_it_did(times, expected):
    history = np.zeros((2, 6))
    history[:, 0], history[:, 5] = [2.0, 1.0], [4.0, 2.0]
    predicted = predicted_pose(history, np.array(times[:2]), times[2])
    np.testing.assert_allclose(predicted[[0, 5]], expected)


@needs_compiled_kernels
def test_strong_smoothness_of_the_paper_overshoots_where_a_turn_ends():
    poses = [head_pose(np.deg2rad(3.0 * min(k, 10)), 0.0, 0.0) for k in range(25)]
    seen = [landmarks(face(), expression(), pose) for pose in poses]
    overshoot = {}
    for weight in (1e4, 1e6):
        paper = PaperSettings(rotation_smoothness=weight)
        tracker = EnergyTracker(face(), CAMERA, replace(unfiltered("paper"), paper=paper))
        yaw = [
            np.rad2deg(head_angles_from_matrix(matrix_from_quaternion(s.rotation_wxyz))[0])
            for s in follow(tracker, seen)
        ]
        overshoot[weight] = max(yaw) - 30
    assert overshoot[1e6] > 2 > overshoot[1e4]


@pytest.mark.parametrize("points, confidence", [
    (np.zeros((68, 2)), SURE), (np.zeros((75, 2)), np.ones(68)),
    (np.full((75, 2), np.nan), SURE), (np.zeros((75, 2)), np.full(75, np.inf)),
])  # fmt: skip
def test_landmarks_of_another_kind_are_refused(points, confidence):
    with pytest.raises(ValueError, match="energy tracker needs"):
        EnergyTracker(face(), CAMERA).step(points, confidence, 0.0)


@needs_compiled_kernels
@pytest.mark.parametrize("angles", [(0.8, 0.2, -0.4), (-0.7, -0.3, 0.4), (0.1, 0.4, 0.0)])
def test_after_a_cut_the_face_is_found_in_the_next_frame(angles):
    tracker = EnergyTracker(face(), CAMERA, unfiltered("joint"))
    before = head_pose(-0.6, -0.2, 0.3, (-120.0, 60.0, 450.0))
    follow(tracker, [landmarks(face(), expression(mouthPucker=0.8), before)] * 5)
    after = head_pose(*angles, (130.0, -50.0, 900.0))
    solved = tracker.step(landmarks(face(), expression(jawOpen=0.5), after), SURE, 5 / FPS)
    assert turned_deg(solved, after) < 2.0
    assert solved.confidence > 0.9


@needs_compiled_kernels
def test_a_hand_over_the_mouth_lowers_confidence_and_does_not_lose_the_face():
    tracker = EnergyTracker(face(), CAMERA)
    seen = [landmarks(face(), expression(), nodding(k)) for k in range(40)]
    for points in seen[20:]:
        points[40:60] += [25.0, 40.0]
    solved = follow(tracker, seen)
    assert solved[19].confidence == pytest.approx(1.0)
    assert 0.3 < solved[-1].confidence < 0.99
    assert max(turned_deg(s, nodding(k)) for k, s in enumerate(solved)) < 2.5
