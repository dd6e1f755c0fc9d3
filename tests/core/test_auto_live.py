"""Facts about choosing between the trained and the training-free tracker."""

from dataclasses import replace

import numpy as np
import pytest

from core.agreement import Look, Misfits
from core.arkit import EXPRESSION_NAMES
from core.auto_live import STRICT, AutoTracker, turned_rad
from core.camera import camera_for, project
from core.free_live import FreeSettings, FreeTracker
from core.geometry import (
    matrix_from_head_angles,
    quaternion_from_matrix,
    rotation_angle_rad,
    rotation_facing_camera,
)
from core.landmark_flow import FlowSettings, LandmarkFollower
from core.live import LiveTracker, resting_state
from core.records import Frame, Landmarks2D, Shape3D
from core.region_ease import REGIONS
from tests.core.painted_user import painted_user, trained_user
from tests.core.tracked_faces import shipped_prior

CAMERA = camera_for((640, 480), 600.0)
FRAME = Frame(np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.uint8), 0.0, 0)
LANDMARKS = Landmarks2D(
    np.zeros((75, 2)), np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2)
)
#: Disagreement, residual, misfit of one's own and of another's face, and of a failing regressor.
OWN, OTHER, FAILING = (0.007, 0.3, 0.005), (0.03, 1.1, 0.012), (0.3, 5.0, 0.005)


def state_of(mode, time_s, depth_mm, lost=False):
    shape = np.random.default_rng(3).normal(size=(75, 3)) * 40 + [0, 0, depth_mm]
    return replace(
        resting_state(mode), time_s=time_s, translation_mm=np.array([0, 0, depth_mm]),
        shape_mm=shape, landmarks_px=project(CAMERA, shape), confidence=0.9, lost=lost,
    )  # fmt: skip


class Scene:
    """Who sits before the camera; both trackers look at it."""

    def __init__(self):
        self.seen, self.measured, self.by_network, self.time_s = True, OWN, True, 0.0
        self.trained, self.free = TrainedSpy(self), FreeSpy(self)
        self.tracker = AutoTracker(self.trained, self.free)

    def film(self, n_frames):
        states = []
        for _ in range(n_frames):
            self.time_s += 1 / 30
            states.append(self.tracker.step(replace(FRAME, time_s=self.time_s)))
        return states

    def modes(self, n_frames):
        return [state.mode for state in self.film(n_frames)]

    def look(self):
        disagreement, residual, _ = self.measured
        shape = Shape3D(np.zeros((77, 3)), 1.0, residual)
        return Look(LANDMARKS, shape, disagreement, disagreement < 0.13)


class TrainedSpy:
    """A trained tracker that looks every 30 frames, and in each frame while it fails."""

    camera = CAMERA

    def __init__(self, scene):
        self.scene, self.steps, self.since, self.tries = scene, 0, 0, 0
        self.look, self.follows = None, False

    def step(self, frame):
        self.steps += 1
        self.since += 1
        self.look = None
        if not self.scene.seen:
            self.follows = False
            return state_of("trained", frame.time_s, 600, lost=True)
        if self.since >= 30 or not self.follows or self.scene.measured is FAILING:
            self.look, self.since = self.scene.look(), 0
            self.follows = self.look.agrees
        return state_of("trained", frame.time_s, 600)

    def look_within(self, frames):
        self.since = max(self.since, 30 - frames)

    def begin_at(self, frame, landmarks):
        self.tries += 1
        self.look, self.since = self.scene.look(), 0
        self.follows = self.look.agrees
        return self.look

    def misfits(self, landmarks):
        return Misfits(self.scene.measured[2], 0.0105)

    user = "the profile's"

    def reset(self):
        self.follows = False


class FreeSpy:
    camera = CAMERA

    def __init__(self, scene):
        self.scene, self.steps, self.resets = scene, 0, 0
        self.looked, self.assumed = None, TrainedSpy.user

    def step(self, frame):
        self.steps += 1
        self.looked = LANDMARKS if self.scene.seen and self.scene.by_network else None
        return state_of("free", frame.time_s, 640, lost=not self.scene.seen)

    def assume(self, user):
        self.assumed = user

    def reset(self):
        self.resets += 1


def test_the_profiles_person_is_tracked_by_the_regressor_after_the_first_looks():
    scene = Scene()
    modes = scene.modes(300)
    assert modes[0] == "free" and modes.count("trained") > 0.95 * 300
    # Nothing is spent on the other tracker meanwhile.
    assert scene.free.steps == modes.count("free") <= 10


def test_another_person_is_tracked_without_training_from_the_first_frame_on():
    scene = Scene()
    scene.measured = OTHER
    assert set(scene.modes(200)) == {"free"}
    assert scene.free.assumed is None
    assert scene.trained.steps == 0 and 5 <= scene.trained.tries <= 25


def test_another_person_who_sits_down_is_noticed():
    scene = Scene()
    scene.film(100)
    scene.measured = OTHER
    modes = scene.modes(100)
    assert modes[0] == "trained" and set(modes[70:]) == {"free"}
    assert scene.free.assumed is None


def test_another_person_after_an_empty_chair_is_noticed_at_once():
    scene = Scene()
    scene.film(100)
    scene.seen = False
    assert all(state.lost for state in scene.film(20))
    scene.seen, scene.measured = True, OTHER
    assert set(scene.modes(60)[5:]) == {"free"}


def test_the_person_who_comes_back_has_the_regressor_at_once():
    scene = Scene()
    scene.film(100)
    scene.seen = False
    scene.film(20)
    scene.seen = True
    assert set(scene.modes(60)) == {"trained"}


def test_a_failing_regressor_is_left_after_a_few_frames_and_taken_back_when_it_works():
    scene = Scene()
    scene.film(100)
    scene.measured = FAILING
    modes = scene.modes(60)
    assert modes[:2] == ["trained", "trained"] and set(modes[3:]) == {"free"}
    # It is still the person of the profile, whose face is known.
    assert scene.free.assumed == TrainedSpy.user
    scene.measured = OWN
    modes = scene.modes(120)
    assert modes[0] == "free" and set(modes[80:]) == {"trained"}


def test_a_regressor_that_is_off_for_a_frame_or_two_is_kept():
    scene = Scene()
    scene.film(100)
    scene.measured = FAILING
    scene.film(2)
    scene.measured = OWN
    assert set(scene.modes(100)) == {"trained"}


def test_the_regressor_is_tried_only_where_the_network_looked():
    scene = Scene()
    scene.by_network = False
    assert set(scene.modes(50)) == {"free"} and scene.trained.tries == 0


def test_no_change_is_a_jump():
    scene = Scene()
    states = scene.film(60)
    scene.measured = FAILING
    states += scene.film(60)
    assert {state.mode for state in states} == {"free", "trained"}
    depths = np.array([state.translation_mm[2] for state in states])
    # The trackers differ by 40 mm, which are let go within 0.2 s: six frames.
    assert np.ptp(depths) == pytest.approx(40) and np.abs(np.diff(depths)).max() < 11
    shown = np.array([state.landmarks_px for state in states])
    jump = np.linalg.norm(shown[0] - shown[-1] + 1e-9, axis=1).max()
    assert np.linalg.norm(np.diff(shown, axis=0), axis=2).max() < max(0.3 * jump, 12)


def test_reset_forgets_everything():
    scene = Scene()
    scene.film(50)
    scene.tracker.reset()
    assert scene.free.resets == 1 and not scene.trained.follows
    scene.measured = OTHER
    assert set(scene.modes(10)) == {"free"}


def test_a_head_that_faces_the_camera_is_not_turned_wherever_it_is():
    place = np.array([200.0, 100.0, 500.0])
    state = replace(
        resting_state("free"), translation_mm=place,
        rotation_wxyz=quaternion_from_matrix(rotation_facing_camera(place)),
    )  # fmt: skip
    assert turned_rad(state) == pytest.approx(0, abs=1e-6)
    turned = matrix_from_head_angles(0.3, 0, 0) @ rotation_facing_camera(np.array([0, 0, 1.0]))
    state = replace(
        resting_state("free"), rotation_wxyz=quaternion_from_matrix(turned),
    )  # fmt: skip
    assert turned_rad(state) == pytest.approx(0.3)


class Painted:
    """The real trackers before a painted user, whose pictures the regressor knows."""

    def __init__(self):
        self.user, self.time_s = painted_user(), 0.0
        self.face, self.looks = self.user.shape(), 0
        model, camera = self.user.model, self.user.camera
        trained = LiveTracker(model, trained_user(), self, shipped_prior(), STRICT)
        follower = LandmarkFollower(self, FlowSettings(detection="every"))
        free = FreeTracker(model, follower, camera, FreeSettings(), self.user.blendshapes)
        self.tracker = AutoTracker(trained, free)
        self.blind = False

    def follow(self, rgb, previous):
        self.looks += 1
        return self.user.alignment(self.face)

    def check(self, rgb, landmarks_px):
        return self.follow(rgb, None)

    def film(self, n_frames):
        states = []
        for _ in range(n_frames):
            self.time_s += 1 / 30
            swing = np.sin(3 * self.time_s)
            self.face = self.user.shape(
                (10 * swing, 0, 600), (0.15 * swing, 0, 0), jawOpen=0.2 + 0.2 * swing
            )
            frame = self.user.frame(self.face, self.time_s)
            if self.blind:
                frame = replace(frame, gray=frame.gray[::-1, ::-1].copy())
            states.append(self.tracker.step(frame))
        return states


def test_real_trackers_change_over_and_back_without_a_jump():
    painted = Painted()
    states = painted.film(60)
    assert [state.mode for state in states].count("trained") > 50
    looks = painted.looks
    states += painted.film(30)
    # One look at most in a second: the network rests while the regressor leads.
    assert painted.looks - looks <= 2
    painted.blind = True
    states += painted.film(30)
    assert states[-1].mode == "free" and not any(state.lost for state in states)
    painted.blind = False
    states += painted.film(90)
    assert states[-1].mode == "trained"
    shown = np.array([state.landmarks_px[:60] for state in states])
    moves = np.linalg.norm(np.diff(shown, axis=0), axis=2).mean(axis=1)
    assert moves.max() < 3.0
    turns = rotation_angle_rad(
        np.array([state.rotation_wxyz for state in states[1:]]),
        np.array([state.rotation_wxyz for state in states[:-1]]),
    )
    assert turns.max() < 0.06


class KeeperSpy:
    """What is told of covered landmarks, and who else is in the picture."""

    def __init__(self):
        self.covered, self.beside, self.forgotten = 0.0, [], 0

    def others(self, frame):
        yield from self.beside

    def forget(self):
        self.forgotten += 1


def kept_scene():
    scene, keeper = Scene(), KeeperSpy()
    scene.tracker = AutoTracker(scene.trained, scene.free, keeper=keeper)
    return scene, keeper


def test_a_covered_face_is_followed_without_the_regressor_until_it_is_seen_again():
    scene, keeper = kept_scene()
    assert scene.modes(10)[-1] == "trained"
    keeper.covered = 0.3
    scene.film(1)
    tries = scene.trained.tries
    assert set(scene.modes(40)) == {"free"}
    # A hand that is there is no reason to try; the face stays the profile's.
    assert scene.trained.tries == tries and scene.free.assumed == TrainedSpy.user
    keeper.covered = 0.0
    assert scene.modes(12)[-1] == "trained"


def test_the_profiles_person_is_taken_from_among_others():
    scene, keeper = kept_scene()
    scene.measured = OTHER
    assert set(scene.modes(60)) == {"free"}
    keeper.beside = [Look(LANDMARKS, Shape3D(np.zeros((77, 3)), 1.0, 1.0), 1.0, False)]
    assert set(scene.modes(60)) == {"free"} and keeper.forgotten == 0
    scene.free.looked, scene.by_network = None, False
    scene.measured = OWN
    assert scene.modes(60)[-1] == "trained" and keeper.forgotten == 1


def test_what_is_covered_is_held_and_let_go_over_a_change_of_trackers():
    scene, keeper = kept_scene()
    jaw, index = np.zeros(46), EXPRESSION_NAMES.index("jawOpen")
    jaw[index] = 0.7
    plain = scene.trained.step
    scene.trained.step = lambda frame: replace(plain(frame), expression=jaw)
    scene.film(15)
    keeper.covered = 0.3
    region = np.ones(6)
    region[REGIONS[index]] = 0.05
    free = scene.free.step
    scene.free.step = lambda frame: replace(free(frame), expression=1 - jaw, regions=region)
    shown = [state.expression[index] for state in scene.film(60)]
    assert shown[:8] == pytest.approx([0.7] * 8) and shown[-1] < 0.15
