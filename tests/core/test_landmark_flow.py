from pathlib import Path

import cv2
import numpy as np
import pytest

from core.alignment import FaceAligner
from core.detection_policy import PolicySettings
from core.landmark_flow import FlowSettings, LandmarkFollower
from core.landmarks import GROUPS, MESH478, N_INTERNAL
from core.records import Frame
from tests.core.followed_face import (
    SIZE_PX,
    KnowingAligner,
    drawn_face,
    face_mesh,
    frame_of,
    moved,
    points_of,
)

SPARING = FlowSettings(policy=PolicySettings(network_ms=16.0, flow_ms=2.0))


def nodding(n_frames, step_px=1.5):
    """Return meshes and frames of a face that drifts to the right and turns."""
    still = face_mesh()
    picture = drawn_face(points_of(still))
    meshes, frames = [], []
    for k in range(n_frames):
        affine = cv2.getRotationMatrix2D((160, 120), 0.7 * k, 1 + 0.004 * k)
        affine[:, 2] += [step_px * k, 0.3 * k]
        meshes.append(moved(still, affine))
        gray = cv2.warpAffine(picture, affine, SIZE_PX, borderMode=cv2.BORDER_REFLECT)
        frames.append(frame_of(gray, k))
    return meshes, frames


def blinking(closed_at, n_frames=30):
    """Return meshes and frames of a face that holds still but for its lids."""
    mesh = face_mesh()
    points = points_of(mesh)
    frames = [
        frame_of(drawn_face(points, (1.0, 1.0) if k in closed_at else (0, 0)), k)
        for k in range(n_frames)
    ]
    return [mesh] * n_frames, frames


def error_px(followed, mesh):
    return np.abs(followed.landmarks.points_px[:N_INTERNAL] - points_of(mesh)[:N_INTERNAL]).max()


def test_every_frame_is_just_what_the_network_sees():
    meshes, frames = nodding(5)
    follower = LandmarkFollower(KnowingAligner(meshes), FlowSettings("every"))
    for frame, mesh in zip(frames, meshes, strict=True):
        followed = follower.step(frame)
        assert followed.by_network
        np.testing.assert_array_equal(followed.landmarks.points_px, points_of(mesh)[:75])
        np.testing.assert_array_equal(followed.alignment.mesh_px, mesh[:, :2])


def test_flow_carries_the_face_between_looks_at_every_fifth_frame():
    meshes, frames = nodding(16)
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, FlowSettings(5))
    followed = [follower.step(frame) for frame in frames]
    assert aligner.looked_at == [0, 5, 10, 15]
    assert [one.by_network for one in followed] == [k % 5 == 0 for k in range(16)]
    assert [one.alignment is not None for one in followed] == [k % 5 == 0 for k in range(16)]
    for one, mesh in zip(followed, meshes, strict=True):
        internal = one.landmarks.points_px[:N_INTERNAL] - points_of(mesh)[:N_INTERNAL]
        assert np.sqrt(np.mean(np.sum(internal**2, axis=1))) < 0.5
        outline = one.landmarks.points_px[N_INTERNAL:] - points_of(mesh)[N_INTERNAL:75]
        assert np.abs(outline).max() < 1.0
        assert np.abs(one.landmarks.pupils_px - points_of(mesh)[75:]).max() < 1.0


def test_the_network_is_told_where_flow_has_carried_the_face():
    meshes, frames = nodding(9)
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, FlowSettings(8))
    for frame in frames:
        follower.step(frame)
    assert aligner.previous[0] is None
    told = aligner.previous[1]
    assert np.abs(told.mesh_px - meshes[8][:, :2]).max() < 2.5
    assert np.abs(told.region.center_px - 0.5 * np.ptp(meshes[8][:, :2], axis=0)
                  - meshes[8][:, :2].min(axis=0)).max() < 12  # fmt: skip


def test_a_small_correction_is_spread_and_a_large_one_comes_at_once():
    still = face_mesh()
    picture = drawn_face(points_of(still))
    for shift_px, at_once in ((0.5, False), (8.0, True)):
        seen = moved(still, [[1, 0, shift_px], [0, 1, 0]])
        follower = LandmarkFollower(KnowingAligner([still] * 4 + [seen] * 9), FlowSettings(4))
        followed = [follower.step(frame_of(picture, k)) for k in range(13)]
        gaps = [error_px(one, seen) for one in followed]
        assert gaps[3] == pytest.approx(shift_px, abs=0.05)
        assert (gaps[4] < 0.05) == at_once
        assert gaps[4] < 0.8 * shift_px
        assert gaps[8] < 0.1


def test_a_calm_face_is_hardly_looked_at_and_a_blink_at_once():
    meshes, frames = blinking({20, 21})
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, SPARING)
    for frame in frames:
        follower.step(frame)
    assert aligner.looked_at[:1] == [0]
    assert len([k for k in aligner.looked_at if 0 < k < 20]) == 0
    assert {20, 22} <= set(aligner.looked_at)


def test_landmarks_are_the_same_each_time_without_a_clock():
    meshes, frames = nodding(12, 4.0)
    runs = []
    for _ in range(2):
        follower = LandmarkFollower(KnowingAligner(meshes))
        runs.append([follower.step(frame).landmarks.points_px for frame in frames])
    np.testing.assert_array_equal(runs[0], runs[1])


def test_a_clock_that_finds_the_network_dear_makes_it_look_less():
    looks = []
    for network_s in (0.001, 0.5):
        meshes, frames = blinking(range(0, 40, 2), 40)
        aligner = KnowingAligner(meshes)
        clock = Ticking(aligner, network_s)
        follower = LandmarkFollower(aligner, FlowSettings(budget_ms=6.0), clock)
        for frame in frames:
            follower.step(frame)
        looks.append(len(aligner.looked_at))
    assert looks[0] > 2 * looks[1]


class Ticking:
    """A clock on which each look of an aligner takes its time, and nothing else does."""

    def __init__(self, aligner, network_s):
        self._aligner, self._network_s = aligner, network_s

    def __call__(self):
        return self._network_s * len(self._aligner.looked_at)


def test_without_a_face_there_is_nothing_and_the_next_face_is_a_new_one():
    meshes, frames = nodding(6)
    meshes[3] = None
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, FlowSettings(3))
    found = [follower.step(frame) for frame in frames]
    assert [one is None for one in found] == [False, False, False, True, False, False]
    assert aligner.looked_at == [0, 3, 4]
    assert aligner.previous[1] is not None
    assert aligner.previous[2] is None


def test_confidence_falls_while_flow_alone_carries_a_covered_mouth():
    mesh = face_mesh()
    picture = drawn_face(points_of(mesh))
    hand = picture.copy()
    top = int(points_of(mesh)[40:60, 1].min()) - 8
    hand[top:] = np.random.default_rng(0).integers(60, 200, hand[top:].shape)
    follower = LandmarkFollower(KnowingAligner([mesh] * 3), FlowSettings(100))
    before = [follower.step(frame_of(picture, k)) for k in range(2)][-1]
    after = follower.step(frame_of(hand, 2))
    lips = slice(40, 60)
    assert before.landmarks.confidence[lips].mean() > 0.9
    assert after.landmarks.confidence[lips].mean() < 0.5
    assert after.confidence < before.confidence


def test_pupils_are_sure_between_looks_only_as_far_as_the_lids_are_open():
    mesh, shut = face_mesh(), face_mesh()
    for name in ("eye_right", "eye_left"):
        lids = MESH478[list(GROUPS[name])]
        shut[lids[1:4], 1] = shut[lids[[7, 6, 5]], 1]
    for seen, low, high in ((mesh, 0.5, 1.0), (shut, 0.0, 0.1)):
        follower = LandmarkFollower(KnowingAligner([seen] * 2), FlowSettings(100))
        follower.step(frame_of(drawn_face(points_of(mesh)), 0))
        carried = follower.step(frame_of(drawn_face(points_of(mesh)), 1))
        assert not carried.by_network
        assert low <= carried.landmarks.pupil_confidence.min()
        assert carried.landmarks.pupil_confidence.max() <= high


@pytest.mark.parametrize("turn", [np.rot90, lambda p: p[:200], lambda p: cv2.resize(p, (640, 480))])
def test_another_frame_size_starts_anew(turn):
    meshes, frames = nodding(4)
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, FlowSettings(100))
    follower.step(frames[0])
    follower.step(frames[1])
    other = np.ascontiguousarray(turn(frames[2].gray))
    assert follower.step(frame_of(other, 2)).by_network
    assert aligner.previous == [None, None]
    follower.step(frame_of(other, 3))
    assert aligner.looked_at == [0, 2]


@pytest.mark.parametrize("time_s", [-1.0, 30.0])
def test_a_jump_in_time_is_looked_at(time_s):
    meshes, frames = nodding(3)
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, FlowSettings(100))
    follower.step(frames[0])
    follower.step(frames[1])
    cut = Frame(frames[2].rgb, frames[2].gray, time_s, 2)
    assert follower.step(cut).by_network


def test_a_cut_to_another_picture_is_looked_at_by_itself(rng):
    meshes, frames = nodding(5)
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, SPARING)
    for frame in frames[:4]:
        follower.step(frame)
    noise = rng.integers(0, 255, SIZE_PX[::-1], dtype=np.uint8)
    assert follower.step(frame_of(noise, 4)).by_network


def test_a_face_that_leaves_the_picture_has_no_confidence_there():
    meshes, frames = nodding(2)
    shift = np.array([[1.0, 0, 0], [0, 1, 130]])
    low = [moved(mesh, shift) for mesh in meshes]
    grays = [cv2.warpAffine(frame.gray, shift, SIZE_PX) for frame in frames]
    follower = LandmarkFollower(KnowingAligner(low), FlowSettings(100))
    for k in range(2):
        followed = follower.step(frame_of(grays[k], k))
    outside = followed.landmarks.points_px[:, 1] > SIZE_PX[1]
    assert outside.any()
    assert not followed.landmarks.confidence[outside].any()


def test_reset_makes_the_next_face_the_first():
    meshes, frames = nodding(2)
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, FlowSettings(100))
    follower.step(frames[0])
    follower.reset()
    assert follower.step(frames[1]).by_network
    assert aligner.previous == [None, None]


def test_a_long_search_for_a_face_does_not_starve_it_once_found():
    meshes, frames = blinking(range(40, 60, 2), 60)
    meshes[:30] = [None] * 30
    aligner = KnowingAligner(meshes)
    follower = LandmarkFollower(aligner, FlowSettings(budget_ms=5.0))
    for frame in frames:
        follower.step(frame)
    assert {40, 41, 42, 43} <= set(aligner.looked_at)


@pytest.fixture(scope="module")
def real_aligner():
    return FaceAligner(Path(__file__).resolve().parents[2] / "assets" / "aligner")


@pytest.mark.slow
def test_the_real_person_is_followed_with_the_network_in_a_third_of_the_frames(real_aligner, clips):
    capture = cv2.VideoCapture(str(clips / "person_a_2.mp4"))
    follower = LandmarkFollower(real_aligner)
    errors, looks, opening, truth = [], [], [], []
    reference = None
    for k in range(150):
        rgb = cv2.cvtColor(capture.read()[1], cv2.COLOR_BGR2RGB)
        frame = Frame(rgb, cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY), k / 25, k)
        followed = follower.step(frame)
        reference = real_aligner.follow(rgb, reference)
        seen = reference.landmarks.points_px
        errors.append(np.mean((followed.landmarks.points_px - seen)[:N_INTERNAL] ** 2) * 2)
        looks.append(followed.by_network)
        opening.append(np.linalg.norm(np.diff(followed.landmarks.points_px[[16, 24]], axis=0)))
        truth.append(np.linalg.norm(np.diff(seen[[16, 24]], axis=0)))
    assert np.mean(looks) < 0.4
    assert np.sqrt(np.mean(errors)) < 0.6
    assert np.corrcoef(opening, truth)[0, 1] > 0.95


def test_the_same_of_two_real_faces_is_kept_between_and_at_looks(real_aligner):
    bgr = cv2.imread(str(Path(__file__).resolve().parents[1] / "data" / "two_faces.jpg"))
    rgb = cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB)
    alone = rgb.copy()
    alone[:, :220] = 110
    follower = LandmarkFollower(real_aligner, FlowSettings(2))
    pictures = [alone, rgb, rgb, rgb, rgb]
    centers = []
    for k, picture in enumerate(pictures):
        gray = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
        followed = follower.step(Frame(picture, gray, k / 30, k))
        centers.append(followed.landmarks.points_px[:N_INTERNAL].mean(axis=0))
    assert np.abs(np.diff(centers, axis=0)).max() < 3.0
