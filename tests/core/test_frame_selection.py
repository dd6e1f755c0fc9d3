from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from core.alignment import Alignment, FaceAligner
from core.face_cover import POINTS as SKIN_POINTS
from core.face_regions import Region
from core.frame_selection import (
    Candidate,
    SelectionSettings,
    candidate,
    choose,
    good_frames,
    sharpness,
)
from core.geometry import matrix_from_head_angles
from core.landmarks import GROUPS, MESH478, N_INTERNAL, N_LANDMARKS, PUPILS478
from core.records import Landmarks2D

ALIGNER = Path(__file__).resolve().parents[2] / "assets" / "aligner"
FACE = np.random.default_rng(3).normal(0, 1, (478, 3)) * [40, 40, 15]


def seen(index, yaw=0.0, mouth=0.0, sharp=1.0, presence=1.0, size_px=40.0, skin=None):
    shape = FACE[[*MESH478[:N_INTERNAL], *PUPILS478], :2] / 56
    shape = shape + mouth * np.arange(2 * len(shape)).reshape(-1, 2) / 100
    skin = np.zeros(len(SKIN_POINTS)) if skin is None else skin
    place = np.full(2, 0.5)
    return Candidate(index, np.array([yaw, 0, 0]), shape, size_px, sharp, presence, skin, place)


def aligned(head_rad, shift, scale):
    rotation = matrix_from_head_angles(*head_rad)
    mesh = scale * FACE @ rotation.T + [*shift, 0]
    marks = Landmarks2D(
        mesh[MESH478, :2], np.zeros(N_LANDMARKS, bool), np.ones(N_LANDMARKS), np.zeros((2, 2)),
        np.ones(2),
    )  # fmt: skip
    region = Region(np.zeros(2), 100.0, 0.0)
    return Alignment(marks, mesh[:, :2], mesh[:, 2], rotation, 0.97, region)


def test_shape_of_a_face_does_not_depend_on_pose_place_and_distance(rng):
    gray = rng.integers(0, 255, (200, 200), dtype=np.uint8)
    front = candidate(0, gray, aligned((0, 0, 0), (100, 100), 1.0))
    turned = candidate(1, gray, aligned((0.5, -0.2, 0.1), (80, 120), 0.7))
    np.testing.assert_allclose(front.shape, turned.shape, atol=1e-9)
    np.testing.assert_allclose(turned.head_rad, [0.5, -0.2, 0.1], atol=1e-9)
    assert turned.size_px == pytest.approx(0.7 * front.size_px)
    assert turned.presence == 0.97
    middle = np.mean(aligned((0, 0, 0), (100, 100), 1.0).mesh_px[MESH478[:N_INTERNAL]], axis=0)
    np.testing.assert_allclose(front.place, middle / 200)


def test_rare_poses_and_expressions_are_chosen_before_more_of_the_usual(rng):
    resting = [seen(n, *rng.normal(0, 0.005, 2)) for n in range(200)]
    rare = [seen(200, yaw=0.6), seen(201, yaw=-0.6), seen(202, mouth=0.5), seen(203, size_px=80)]
    chosen = choose(resting[:100] + rare + resting[100:], 5)
    assert {200, 201, 202, 203} <= set(chosen) and len(chosen) == 5


def test_chosen_frames_come_in_order_of_time_and_once_each(rng):
    frames = [seen(n, *rng.normal(0, 0.3, 2)) for n in range(80)]
    chosen = choose(frames, 30)
    assert list(chosen) == sorted(set(chosen)) and len(chosen) == 30
    assert chosen == choose(frames, 30)


def test_blurred_and_doubtful_frames_are_left_out():
    frames = [seen(n, yaw=0.01 * n) for n in range(30)]
    frames[10] = seen(10, yaw=0.9, sharp=0.5)
    frames[20] = seen(20, yaw=-0.9, presence=0.5)
    assert {one.index for one in good_frames(frames, SelectionSettings())} == (
        set(range(30)) - {10, 20}
    )
    assert not {10, 20} & set(choose(frames, 30))


def test_sharpness_is_judged_against_the_frames_around():
    near, far = [[seen(n, sharp=level) for n in range(40)] for level in (1.0, 0.4)]
    assert len(good_frames(near + far, SelectionSettings(settling=0))) > 70


def test_frames_whose_skin_looks_otherwise_are_left_out_if_there_are_frames_to_compare(rng):
    skins = rng.normal(0, 0.1, (200, len(SKIN_POINTS)))
    skins[150:165, -8:] += 1.5
    frames = [seen(n, *rng.normal(0, 0.2, 2), skin=skin) for n, skin in enumerate(skins)]
    good = {one.index for one in good_frames(frames, SelectionSettings())}
    assert not good & set(range(150, 165)) and len(good) > 160
    few = [frames[n] for n in range(120, 170)]
    assert len(good_frames(few, SelectionSettings())) == 50


def test_the_unsettled_start_of_a_video_is_left_out():
    frames = [seen(7 + n, yaw=0.01 * n) for n in range(100)]
    assert min(choose(frames, 50)) == 7 + SelectionSettings().settling


def test_a_blink_is_as_rare_as_a_turned_head(rng):
    frames = [seen(n, *rng.normal(0, 0.02, 2)) for n in range(90)]
    shape = frames[40].shape.copy()
    lids = list(GROUPS["eye_right"]) + list(GROUPS["eye_left"])
    shape[lids] += [0, 0.06]
    frames[40] = replace(frames[40], shape=shape)
    assert 40 in choose(frames, 6)


@pytest.mark.slow
def test_frames_with_the_hand_at_the_chin_are_not_chosen(clips):
    aligner = FaceAligner(ALIGNER)
    capture, found, offers = cv2.VideoCapture(str(clips / "person_a_1.mp4")), None, []
    for index in range(1337):
        gray = (rgb := capture.read()[1][:, :, ::-1]).mean(axis=2).astype(np.uint8)
        if index % 6 == 0:
            found = aligner.follow(np.ascontiguousarray(rgb), found)
            offers.append(candidate(index, gray, found))
    chosen = np.array(choose(offers, 60))
    covered = ((chosen >= 1104) & (chosen < 1133)) | ((chosen >= 1184) & (chosen < 1291))
    assert len(chosen) == 60 and not covered.any()
    # The open mouth, the blink, both head turns and the face far away are there.
    for first, last in ((280, 370), (636, 648), (495, 512), (520, 536), (900, 1020)):
        assert np.any((chosen >= first) & (chosen <= last))


def test_nothing_is_chosen_from_nothing():
    assert choose([], 60) == ()
    assert choose([seen(0, presence=0.1)], 60) == ()


def test_blur_lowers_sharpness_and_light_does_not_change_it(rng):
    gray = rng.integers(40, 200, (120, 120)).astype(float)
    corners = np.array([[10.0, 10], [110, 110]])
    blurred = sum(np.roll(gray, n, axis=1) for n in range(5)) / 5
    plain = sharpness(gray.astype(np.uint8), corners)
    assert sharpness(blurred.astype(np.uint8), corners) < 0.7 * plain
    assert sharpness((gray * 0.6).astype(np.uint8), corners) == pytest.approx(plain, rel=0.05)


def test_a_face_outside_the_picture_has_no_sharpness():
    assert sharpness(np.zeros((50, 50), np.uint8), np.array([[-9.0, -9], [-3, -3]])) == 0.0
