"""Facts about tracking anybody: from landmarks to face states, without any setup."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from core.blendshapes import mean_user
from core.camera import camera_for, project
from core.free_live import (
    UNKNOWN_CAMERA,
    FreeSettings,
    FreeTracker,
    eye_centers_of,
    head_of,
)
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_quaternion,
    rotation_angle_rad,
)
from core.landmark_flow import Followed
from core.landmarks import N_INTERNAL, N_LANDMARKS, REGION_LANDMARKS, REGION_NAMES
from core.records import Frame, Landmarks2D
from tests.core.painted_user import painted_user
from tests.core.tracked_faces import expression, head_pose, index, shape_of

PATIENT = FreeSettings(learn=False)


class Stage:
    """A camera and a follower in front of which a face is put, or none."""

    def __init__(self, camera=None, settings=PATIENT, known=True, identity_seed=None):
        self.user = painted_user(identity_seed)
        self.camera = camera or camera_for((640, 480), 640.0)
        self.face, self.by_network, self.resets = self.user.shape(), True, 0
        self.time_s, self.confidence = 0.0, 0.95
        given = self.camera if known else None
        self.tracker = FreeTracker(self.user.model, self, given, settings)

    def step(self, frame):
        if self.face is None:
            return None
        landmarks = self.user.landmarks(self.face, self.camera)
        return Followed(landmarks, None, self.by_network, self.confidence)

    def reset(self):
        self.resets += 1

    def film(self, n_frames=1):
        width, height = self.camera.size_px
        gray = np.zeros((height, width), np.uint8)
        rgb = np.zeros((height, width, 3), np.uint8)
        for _ in range(n_frames):
            self.time_s += 1 / 30
            state = self.tracker.step(Frame(rgb, gray, self.time_s, 0))
        return state

    def miss_px(self, state):
        truth = project(self.camera, self.face[:N_INTERNAL])
        return float(np.linalg.norm(state.landmarks_px[:N_INTERNAL] - truth, axis=1).mean())


def angles_of(state):
    return head_angles_from_matrix(matrix_from_quaternion(state.rotation_wxyz))


def test_a_face_is_tracked_in_the_first_frame_that_shows_it():
    stage = Stage()
    stage.face = stage.user.shape((12, -8, 610), (0.2, 0.1, -0.05), mouthSmile=0.8)
    state = stage.film()
    assert not state.lost and state.mode == "free" and state.time_s == stage.time_s
    assert stage.miss_px(state) < 1.0 and state.confidence > 0.5
    assert np.allclose(angles_of(state), (0.2, 0.1, -0.05), atol=0.05)
    assert np.allclose(state.translation_mm, (12, -8, 610), atol=12)
    smile = state.expression[[index("mouthSmileLeft"), index("mouthSmileRight")]]
    assert np.all(smile > 0.5)
    np.testing.assert_allclose(
        state.landmarks_px, project(stage.tracker.camera, state.shape_mm), atol=1e-9
    )


def test_before_any_face_there_is_a_resting_head_that_is_lost():
    stage = Stage()
    stage.face = None
    state = stage.film(2)
    assert state.lost and state.confidence == 0 and state.time_s == stage.time_s
    assert state.mode == "free" and not state.expression.any()


def test_a_lost_face_stays_as_it_was_and_is_found_in_the_frame_that_shows_it_again():
    stage = Stage()
    stage.face = stage.user.shape((5, 0, 600), jawOpen=0.5)
    last = stage.film(5)
    face, stage.face = stage.face, None
    lost = stage.film(10)
    assert lost.lost and lost.confidence == 0 and lost.time_s == stage.time_s
    for name in ("rotation_wxyz", "translation_mm", "expression", "gaze_rad", "shape_mm"):
        assert np.array_equal(getattr(lost, name), getattr(last, name)), name
    stage.face = face + [80, 20, 100]
    found = stage.film()
    assert not found.lost and stage.miss_px(found) < 1.0


def test_coefficients_and_pose_follow_a_moving_face():
    stage = Stage()
    for step in range(30):
        swing = np.sin(step / 5)
        stage.face = stage.user.shape(
            (20 * swing, 0, 600), (0.5 * swing, 0.2 * swing, 0), jawOpen=0.5 + 0.5 * swing
        )
        state = stage.film()
        assert state.expression.min() >= 0 and state.expression.max() <= 1
        assert stage.miss_px(state) < 1.5
        assert np.allclose(angles_of(state)[0], 0.5 * swing, atol=0.1)


@pytest.mark.parametrize("look", [(0.25, 0.0), (-0.2, 0.15), (0.0, -0.2)])
def test_the_gaze_comes_from_the_pupils(look):
    stage = Stage()
    model = stage.user.points
    stage.face = shape_of(model, expression(), head_pose(0.1, 0, 0, (0, 0, 600)), look)
    gaze = stage.film(3).gaze_rad
    assert np.allclose(gaze.mean(axis=0), look, atol=0.06)


def test_an_eye_that_is_not_seen_goes_with_the_other():
    stage = Stage()
    see = stage.step
    stage.face = shape_of(stage.user.points, expression(), head_pose(), (0.2, 0.0))

    def one_eyed(frame):
        followed = see(frame)
        pupils = followed.landmarks.pupils_px.copy()
        pupils[0] += [-9, 6]
        landmarks = replace(
            followed.landmarks, pupils_px=pupils, pupil_confidence=np.array([0.1, 1.0])
        )
        return replace(followed, landmarks=landmarks)

    both = stage.film().gaze_rad
    stage.tracker.reset()
    stage.step = one_eyed
    gaze = stage.film().gaze_rad
    # The eye that is seen looks where it looked; the other one is turned in as it is.
    np.testing.assert_allclose(gaze[1], both.mean(axis=0), atol=0.03)
    assert 0.03 < gaze[0, 0] - gaze[1, 0] < 0.2


def test_frames_of_another_size_show_the_same_head_in_the_same_place():
    stage = Stage()
    stage.face = stage.user.shape((10, -5, 620), (0.2, 0, 0), jawOpen=0.4)
    small = stage.film(5)
    for size, factor in (((1280, 960), 2.0), ((480, 640), 1.0), ((320, 180), 0.5)):
        before = stage.resets
        stage.camera = camera_for(size, 640 * factor)
        state = stage.film(5)
        # The points are found anew, and nothing else changes.
        assert stage.resets > before and not state.lost
        assert stage.tracker.camera.size_px == size
        assert stage.tracker.camera.focal_px == pytest.approx(640 * factor)
        assert stage.miss_px(state) < 1.0 * factor
        assert np.abs(state.translation_mm - small.translation_mm).max() < 2
        assert np.abs(state.expression - small.expression).max() < 0.03


def test_a_known_camera_of_any_size_is_believed():
    stage = Stage(camera_for((1280, 720), 1000.0))
    stage.face = stage.user.shape((0, 0, 700))
    state = stage.film(5)
    assert stage.tracker.camera.focal_px == 1000
    assert state.translation_mm[2] == pytest.approx(700, abs=12)


def test_time_that_runs_backwards_starts_anew():
    stage = Stage()
    stage.time_s = 50.0
    stage.film(5)
    resets, stage.time_s = stage.resets, 0.0
    stage.face = stage.user.shape((-60, 20, 550))
    state = stage.film()
    assert stage.resets == resets + 1 and not state.lost and stage.miss_px(state) < 1.0


def test_only_the_networks_landmarks_are_handed_on():
    stage = Stage()
    stage.film()
    assert isinstance(stage.tracker.looked, Landmarks2D)
    stage.by_network = False
    stage.film()
    assert stage.tracker.looked is None
    stage.face = None
    stage.film()
    assert stage.tracker.looked is None


def wandering(stage, n_frames):
    """Film a face that turns and talks; return the states."""
    states = []
    for step in range(n_frames):
        phase = step / 12
        stage.face = stage.user.shape(
            (15 * np.sin(phase), 5 * np.cos(phase), 600 + 40 * np.sin(phase / 3)),
            (0.4 * np.sin(phase), 0.2 * np.sin(1.7 * phase), 0.1 * np.cos(phase)),
            jawOpen=0.3 * (1 + np.sin(2 * phase)), mouthSmile=0.2 * (1 + np.cos(phase / 2)),
        )  # fmt: skip
        states.append(stage.film())
    return states


def shape_error_mm(stage, user):
    """Distance of a face from the true one, up to size and place."""
    rows = stage.user.model.landmark_vertices
    found = user.neutral_mm[rows] + user.landmark_offsets_mm
    true = stage.user.blendshapes.neutral_mm[rows]
    found, true = found - found.mean(axis=0), true - true.mean(axis=0)
    return float(
        np.linalg.norm(found * np.sum(found * true) / np.sum(found**2) - true, axis=1).mean()
    )


@pytest.fixture(scope="module")
def learned():
    """A stage on which another person than the mean one has been for a few seconds."""
    stage = Stage(settings=FreeSettings(), identity_seed=4)
    return stage, wandering(stage, 150)


def test_the_persons_own_face_is_learned_while_tracking(learned):
    stage, states = learned
    assert shape_error_mm(stage, stage.tracker.user) < 0.6 * shape_error_mm(
        stage, mean_user(stage.user.model)
    )
    assert stage.miss_px(states[-1]) < 1.0


def test_a_better_face_is_no_jump(learned):
    _, states = learned
    turns = rotation_angle_rad(
        np.array([s.rotation_wxyz for s in states[1:]]),
        np.array([s.rotation_wxyz for s in states[:-1]]),
    )
    # The head itself turns by at most 0.04 rad per frame.
    assert turns[3:].max() < 0.07
    shapes = np.array([s.expression for s in states])
    assert np.abs(np.diff(shapes[3:], axis=0)).max() < 0.25


def test_what_is_known_of_the_person_outlasts_a_cut(learned):
    stage, _ = learned
    before = stage.tracker.user
    stage.tracker.reset()
    stage.camera = camera_for((480, 640), 640.0)
    stage.film()
    np.testing.assert_array_equal(stage.tracker.user.neutral_mm, before.neutral_mm)
    stage.camera = camera_for((640, 480), 640.0)


def test_eyes_are_where_the_whole_face_has_them(learned):
    stage, _ = learned
    person = stage.tracker._anybody
    whole = head_of(stage.user.model, stage.tracker.user, stage.camera).eye_centers_mm
    assert np.abs(eye_centers_of(stage.user.model, person) - whole).max() < 0.2


def test_a_user_given_at_the_start_is_used_from_the_first_frame():
    stage = Stage(identity_seed=4)
    stage.tracker = FreeTracker(
        stage.user.model, stage, stage.camera, PATIENT, stage.user.blendshapes
    )
    stage.face = stage.user.shape((0, 0, 600), (0.1, 0, 0))
    assert stage.miss_px(stage.film()) < 0.4
    np.testing.assert_array_equal(stage.tracker.user.neutral_mm, stage.user.blendshapes.neutral_mm)


def test_a_face_that_is_assumed_is_used_until_it_is_not(learned):
    stage, _ = learned
    found, assumed = stage.tracker.user, mean_user(stage.user.model)
    stage.tracker.assume(assumed)
    before = stage.film()
    np.testing.assert_array_equal(stage.tracker.user.neutral_mm, assumed.neutral_mm)
    states = [before, *(stage.film() for _ in range(20))]
    poorer = stage.miss_px(states[-1])
    stage.tracker.assume(None)
    states += [stage.film() for _ in range(20)]
    np.testing.assert_array_equal(stage.tracker.user.neutral_mm, found.neutral_mm)
    assert stage.miss_px(states[-1]) < 0.7 * poorer
    shown = np.array([state.landmarks_px for state in states])
    assert np.linalg.norm(np.diff(shown, axis=0), axis=2).max() < 2.0


def test_another_person_is_learned_anew():
    stage = Stage(settings=FreeSettings(), identity_seed=4)
    wandering(stage, 120)
    first = stage.tracker.user
    stage.user, stage.face = painted_user(7), None
    stage.film()
    stage.time_s += 10
    stage.film()
    wandering(stage, 120)
    assert shape_error_mm(stage, stage.tracker.user) < 0.6 * shape_error_mm(stage, first)


def test_an_unknown_focal_length_is_found_from_turned_heads():

    stage = Stage(camera_for((640, 480), 800.0), FreeSettings(), known=False)
    assert stage.tracker.camera is not None and UNKNOWN_CAMERA.focal_px == 640
    wandering(stage, 200)
    assert abs(np.log(stage.tracker.camera.focal_px / 800)) < abs(np.log(640 / 800))
    assert stage.tracker.camera.size_px == (640, 480)


def test_the_users_usual_rotation_is_learned():
    stage = Stage(settings=FreeSettings())
    stage.face = stage.user.shape((0, 0, 600), (0.0, 0.25, 0.0))
    stage.film(60)
    rest = head_angles_from_matrix(matrix_from_quaternion(stage.tracker.user.rest_wxyz))
    assert rest[1] == pytest.approx(0.25, abs=0.05)


def test_all_landmarks_are_shown():
    state = Stage().film()
    assert state.shape_mm.shape == (N_LANDMARKS, 3)
    assert state.landmarks_px.shape == (N_LANDMARKS, 2)


def test_after_a_gap_of_minutes_nothing_of_the_past_is_left():
    stage, fresh = Stage(), Stage()
    stage.face = stage.user.shape((-60, 20, 700), (-0.4, 0, 0), jawOpen=0.9)
    stage.film(10)
    stage.time_s += 600.0
    for one in (stage, fresh):
        one.face = one.user.shape((40, 0, 560), (0.3, 0, 0))
    again, first = stage.film(), fresh.film()
    assert stage.resets == 1
    np.testing.assert_allclose(again.expression, first.expression, atol=1e-9)
    np.testing.assert_allclose(again.translation_mm, first.translation_mm, atol=1e-6)


def test_regions_say_how_sure_the_landmarks_of_each_are():
    stage = Stage()
    mouth = list(REGION_LANDMARKS[REGION_NAMES.index("mouth")])
    plain = stage.user.landmarks

    def covered(face, camera):
        landmarks = plain(face, camera)
        confidence = landmarks.confidence.copy()
        confidence[mouth] = 0.05
        return replace(landmarks, confidence=confidence)

    assert stage.film(3).regions[:5] == pytest.approx([1.0] * 5)
    stage.user = SimpleNamespace(landmarks=covered)
    regions = dict(zip(REGION_NAMES, stage.film().regions, strict=True))
    assert regions["mouth"] == pytest.approx(0.05) and regions["nose"] == 1.0
