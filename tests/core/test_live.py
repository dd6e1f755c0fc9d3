"""Facts about following a face through frames, losing it and finding it again."""

from dataclasses import replace

import numpy as np
import pytest

from core.agreement import disagreement
from core.camera import camera_for, project
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.landmarks import N_INTERNAL, N_LANDMARKS
from core.live import LiveSettings, LiveTracker, tracker_model
from core.records import UserBlendshapes
from tests.core.painted_user import painted_user, trained_user
from tests.core.tracked_faces import index, shipped_prior

NEVER = 10_000
UNDOUBTED = LiveSettings(check_every=NEVER, doubt_spread_mm=1e9, doubt=1e9)


class Stage:
    """A camera and an aligner in front of which a face is put, or none."""

    def __init__(self, settings=UNDOUBTED):
        self.user = painted_user()
        self.face = self.user.shape()
        self.seen = self.face  # where the aligner sees it, None for nowhere
        self.camera = self.user.camera
        self.followed, self.checked, self.time_s = [], [], 0.0
        self.tracker = LiveTracker(self.user.model, trained_user(), self, shipped_prior(), settings)

    def put(self, face):
        self.face = self.seen = face

    def follow(self, rgb, previous):
        self.followed.append(previous)
        return self._see()

    def check(self, rgb, landmarks_px):
        self.checked.append(landmarks_px)
        return self._see()

    def _see(self):
        return None if self.seen is None else self.user.alignment(self.seen, self.camera)

    def film(self, n_frames=1, enlarged=1):
        for _ in range(n_frames):
            self.time_s += 1 / 30
            state = self.tracker.step(self.user.frame(self.face, self.time_s, enlarged))
        return state

    def miss_px(self, state):
        truth = project(self.camera, self.face[:N_LANDMARKS])
        return float(np.linalg.norm(state.landmarks_px - truth, axis=1).mean())


def test_a_face_is_tracked_in_the_frame_in_which_the_aligner_first_sees_it():
    stage = Stage()
    stage.seen = None
    assert stage.film(3).lost and len(stage.followed) == 3
    stage.put(stage.user.shape((12, -8, 610), (0.15, 0.1, -0.05), mouthSmile=0.8))
    state = stage.film()
    assert not state.lost and state.time_s == stage.time_s
    assert stage.miss_px(state) < 1.0 and state.confidence > 0.9
    rotation = matrix_from_quaternion(state.rotation_wxyz)
    assert np.allclose(head_angles_from_matrix(rotation), (0.15, 0.1, -0.05), atol=0.06)
    assert np.allclose(state.translation_mm, (12, -8, 610), atol=8)
    smile = state.expression[[index("mouthSmileLeft"), index("mouthSmileRight")]]
    assert np.all(smile > 0.5)


def test_before_any_face_there_is_a_resting_head_that_is_lost():
    stage = Stage()
    stage.seen = None
    state = stage.film()
    assert state.lost and state.confidence == 0 and state.time_s == stage.time_s
    assert not state.expression.any() and state.translation_mm[2] > 0


def test_a_lost_face_stays_as_it_was_last_seen():
    stage = Stage(replace(UNDOUBTED, check_every=1))
    stage.put(stage.user.shape((5, 0, 600), mouthSmile=1.0))
    last = stage.film(3)
    stage.seen = None
    lost = stage.film(2)
    assert lost.lost and lost.confidence == 0 and lost.time_s == stage.time_s > last.time_s
    for name in ("rotation_wxyz", "translation_mm", "expression", "gaze_rad", "shape_mm"):
        assert np.array_equal(getattr(lost, name), getattr(last, name)), name


def test_a_found_face_owes_nothing_to_the_one_before_it_was_lost():
    stage, fresh = Stage(replace(UNDOUBTED, check_every=1)), Stage()
    stage.put(stage.user.shape((-20, 10, 620), mouthSmile=1.0))
    stage.film(4)
    stage.seen = None
    stage.film()
    for one in (stage, fresh):
        one.put(one.user.shape((15, 0, 590), jawOpen=0.4))
    again, first = stage.film(), fresh.film()
    assert np.array_equal(again.expression, first.expression)
    assert np.array_equal(again.translation_mm, first.translation_mm)


def test_a_trusted_face_is_followed_without_the_aligner():
    stage = Stage()
    for step in range(12):
        stage.put(stage.user.shape((2.0 * step, step, 600 + step), (0.02 * step, 0, 0)))
        state = stage.film()
        assert stage.miss_px(state) < 1.0
    assert len(stage.followed) == 1 and not stage.checked


@pytest.mark.parametrize("check_every", [1, 4])
def test_the_aligner_looks_every_so_many_frames(check_every):
    stage = Stage(replace(UNDOUBTED, check_every=check_every))
    looks = []
    for _ in range(13):
        stage.film()
        looks.append(len(stage.checked))
    # The first frame is the aligner's own.
    assert looks == [n // check_every for n in range(13)]
    assert len(stage.followed) == 1


def test_the_aligner_looks_where_the_regressor_says_the_face_is():
    stage = Stage(replace(UNDOUBTED, check_every=1))
    state = stage.film(2)
    assert np.allclose(stage.checked[0], state.landmarks_px)


def test_doubt_asks_for_an_early_check_but_not_in_every_frame():
    doubted = replace(UNDOUBTED, doubt_spread_mm=0.0, doubt_pause=3)
    stage = Stage(doubted)
    stage.film(10)
    assert len(stage.checked) == 3
    # The checks passed, so nothing was started anew.
    assert len(stage.followed) == 1


def test_an_appearance_unlike_the_training_pictures_is_doubted_and_less_trusted():
    stage = Stage(replace(LiveSettings(), check_every=NEVER, doubt_pause=1, doubt_spread_mm=1e9))
    stage.film(3)
    assert not stage.checked
    hidden = stage.user.frame(stage.face, 1.0)
    gray = hidden.gray.copy()
    left, top = project(stage.camera, stage.face[:N_INTERNAL]).min(axis=0).astype(int)
    gray[top:, left : left + 30] = 255
    before = stage.tracker.step(stage.user.frame(stage.face, 0.99)).confidence
    state = stage.tracker.step(replace(hidden, gray=gray))
    assert len(stage.checked) == 1
    assert state.confidence < 0.5 < before


def test_a_check_that_disagrees_starts_anew_in_the_same_frame():
    stage = Stage(replace(UNDOUBTED, check_every=3))
    stage.film(3)
    stage.put(stage.user.shape((110, 30, 640)))
    state = stage.film()
    assert len(stage.checked) == 1 and len(stage.followed) == 2
    # It goes on from what the check saw, so that no detector has to run.
    assert stage.followed[1] is not None
    assert not state.lost and stage.miss_px(state) < 1.0


def test_a_check_that_sees_no_face_ends_tracking_in_the_same_frame():
    stage = Stage(replace(UNDOUBTED, check_every=3))
    stage.film(3)
    stage.seen = None
    assert stage.film().lost
    assert len(stage.checked) == 1 and len(stage.followed) == 2


def test_where_the_regressor_never_agrees_the_aligner_leads():
    stage = Stage(replace(UNDOUBTED, disagreement=1e-5))
    state = stage.film(4)
    assert len(stage.followed) == 4 and not stage.checked
    assert not state.lost and state.confidence == pytest.approx(0.45)
    assert np.abs(state.shape_mm - stage.face[:N_LANDMARKS]).max() < 1


def test_a_face_that_only_the_aligner_sees_is_hardly_trusted():
    stage = Stage(replace(LiveSettings(), check_every=NEVER, doubt_pause=2))
    # The aligner swears that there is one on an empty wall.
    stage.face, stage.seen = stage.user.shape((5000, 0, 600)), stage.user.shape()
    state = stage.film(5)
    assert not state.lost and state.confidence < 0.5
    assert len(stage.checked) + len(stage.followed) >= 3


def test_too_few_landmarks_are_no_face():
    stage = Stage()
    alignment = stage._see()
    none = replace(alignment.landmarks, confidence=np.zeros(N_LANDMARKS))
    stage._see = lambda: replace(alignment, landmarks=none)
    assert stage.film().lost


def test_frames_of_another_size_are_the_same_view_in_more_pixels():
    stage = Stage()
    small = stage.film(3)
    stage.camera = camera_for((480, 360), 2 * stage.user.camera.focal_px)
    large = stage.film(enlarged=2)
    assert stage.tracker.camera.size_px == (480, 360)
    assert stage.tracker.camera.focal_px == pytest.approx(2 * stage.user.camera.focal_px)
    assert not large.lost and len(stage.followed) == 2 and stage.followed[1] is None
    # Centre of the first pixel is 0: twice the size maps x to 2 x + 0.5.
    assert np.abs(large.landmarks_px - (2 * small.landmarks_px + 0.5)).max() < 2
    assert np.abs(large.translation_mm - small.translation_mm).max() < 8
    stage.camera = stage.user.camera
    assert stage.miss_px(stage.film()) < 1.0
    assert stage.tracker.camera is stage.user.camera


def test_reset_forgets_where_the_face_was():
    stage = Stage()
    stage.film(2)
    stage.tracker.reset()
    stage.film()
    assert stage.followed == [None, None]


def test_time_may_go_back():
    stage = Stage()
    stage.time_s = 100.0
    stage.film(5)
    stage.time_s = 0.0
    state = stage.film()
    assert not state.lost and state.time_s < 1
    assert stage.miss_px(state) < 1.0 and len(stage.followed) == 1


def test_tracker_model_has_the_landmarks_beside_their_vertices():
    user = painted_user()
    offsets = np.random.default_rng(0).normal(size=(N_INTERNAL, 3))
    shifted = UserBlendshapes(
        user.blendshapes.identity, user.blendshapes.neutral_mm, user.blendshapes.deltas_mm, offsets
    )
    points = tracker_model(user.model, shifted)
    assert np.allclose(
        points.neutral_mm[:N_INTERNAL] - user.points.neutral_mm[:N_INTERNAL], offsets
    )
    assert np.array_equal(points.neutral_mm[N_INTERNAL:], user.points.neutral_mm[N_INTERNAL:])


def test_disagreement_is_a_share_of_the_face_weighed_by_confidence():
    user = painted_user()
    landmarks = user.landmarks(user.shape())
    aligned = landmarks.points_px[:N_INTERNAL]
    size_px = max(np.ptp(aligned[:, 0]), np.ptp(aligned[:, 1]))
    assert disagreement(landmarks.points_px, landmarks) == 0
    moved = landmarks.points_px + [0.3 * size_px, 0.4 * size_px]
    assert disagreement(moved, landmarks) == pytest.approx(0.5)
    wild = landmarks.points_px.copy()
    wild[:5] += 1000
    unsure = landmarks.confidence.copy()
    unsure[:5] = 0
    assert disagreement(wild, replace(landmarks, confidence=unsure)) < 0.2
    assert disagreement(wild, landmarks) > 1


def test_doubt_soon_after_a_passed_routine_check_is_looked_into_at_once():
    stage = Stage(replace(UNDOUBTED, doubt_spread_mm=0.0, doubt_pause=9))
    stage.film(2)
    assert len(stage.checked) == 1


def test_a_regressor_that_slipped_by_a_twelfth_of_the_face_is_noticed():
    stage = Stage(replace(LiveSettings(), check_every=10))
    stage.film(3)
    size_px = np.ptp(project(stage.camera, stage.face[:N_INTERNAL]), axis=0).max()
    way_mm = 0.08 * size_px * 600 / stage.camera.focal_px
    # The picture stays, the aligner sees the face elsewhere: the regressor has slipped.
    stage.seen = stage.user.shape((way_mm, 0, 600))
    before = len(stage.followed)
    stage.film(10)
    assert len(stage.followed) > before


def test_a_sudden_change_of_the_picture_is_looked_at_at_once():
    stage = Stage(replace(UNDOUBTED, doubt=1.3))
    stage.film(30)
    assert not stage.checked
    state = stage.film()
    hidden = stage.user.frame(stage.face, stage.time_s + 1 / 30)
    middle = project(stage.camera, stage.face[:N_INTERNAL]).mean(axis=0).astype(int)
    gray = hidden.gray.copy()
    gray[middle[1] : middle[1] + 60, middle[0] - 60 : middle[0] + 60] //= 3
    stage.tracker.step(replace(hidden, gray=gray))
    assert len(stage.checked) == 1 and not state.lost


def test_after_a_gap_of_minutes_the_face_is_looked_for_anew():
    stage = Stage()
    stage.film(5)
    assert len(stage.followed) == 1
    stage.time_s += 300.0
    stage.put(stage.user.shape((40, 10, 620), (0.2, 0, 0), jawOpen=0.6))
    state = stage.film()
    assert stage.followed[1:] == [None]
    assert not state.lost and stage.miss_px(state) < 1.0
    fresh = Stage()
    fresh.put(stage.face)
    assert state.expression == pytest.approx(fresh.film().expression, abs=1e-9)


def test_a_face_handed_over_late_on_the_clock_is_followed_without_another_search():
    stage = Stage()
    stage.time_s = 10_000.0
    frame = stage.user.frame(stage.face, stage.time_s)
    look = stage.tracker.begin_at(frame, stage.user.alignment(stage.face, stage.camera).landmarks)
    assert look is not None and look.agrees
    assert not stage.film().lost
    assert stage.followed == []
