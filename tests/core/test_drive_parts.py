"""The parts of the drive, each by itself: responses, rest, levels, linked lids, keys, the head."""

import numpy as np
import pytest

from core.blink_levels import BlinkLevels, LearnedLevels, blink_levels
from core.centring import Centre, centre_from_plain, centre_to_plain, rest_of, without_rest
from core.drive_presets import face_key
from core.drive_settings import DriveSettings, EyeSettings, Response, key_from
from core.expression_keys import KeyFaces, KeyFades
from core.eye_link import link_lids, turned_gaze, wink_share
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
    quaternion_from_matrix,
    rotation_angle_rad,
    rotation_facing_camera,
)
from core.head_place import HeadPlace, with_gains
from core.idle import Breathing, SelfBlink, eased
from core.kernels.drive import angles_of, facing, from_angles, times, times_back
from core.response import MEANT, PARTING, ResponseTable, Seen, learn_full, lips_rested
from core.setup_plan import SHOTS
from tests.core.driven_faces import FPS, N, face, index

RIGHT, LEFT = index("eyeBlinkRight"), index("eyeBlinkLeft")


# -- responses --------------------------------------------------------------------------------


def test_what_little_parts_resting_lips_is_none_and_the_rest_is_kept():
    noise = np.random.default_rng(0).uniform(0, 0.04, N)
    np.testing.assert_array_equal(lips_rested(noise), np.where(PARTING, 0.0, noise))
    wide = np.linspace(MEANT, 1, N)
    np.testing.assert_array_equal(lips_rested(wide), wide)
    jaw = index("jawOpen")
    ramp = np.array([lips_rested(np.full(N, x))[jaw] for x in np.linspace(0, 0.3, 601)])
    slope = np.diff(ramp) / np.diff(np.linspace(0, 0.3, 601))
    assert slope.min() >= 0
    assert slope.max() < 1.8
    assert np.abs(np.diff(slope)).max() < 0.05
    np.testing.assert_array_equal(lips_rested(noise, 1.0), noise)


def test_a_response_maps_its_range_to_zero_and_one():
    table = ResponseTable(tuple(Response(1.0, 0.1, 0.6) for _ in range(N)))
    for value, shown in ((0.0, 0.0), (0.1, 0.0), (0.35, 0.5), (0.6, 1.0), (0.9, 1.0)):
        np.testing.assert_allclose(table.applied(np.full(N, value)), shown, atol=1e-12)


def test_an_offset_is_what_a_resting_coefficient_shows():
    table = ResponseTable(tuple(Response(1.0, 0.2, 1.0, 0.3) for _ in range(N)))
    np.testing.assert_allclose(table.applied(np.zeros(N)), 0.3)
    np.testing.assert_allclose(table.applied(np.full(N, 0.6)), 0.8)


def test_a_range_that_is_upside_down_does_not_explode():
    table = ResponseTable(tuple(Response(1.0, 0.9, 0.05) for _ in range(N)))
    assert np.isfinite(table.applied(np.full(N, 0.5))).all()


def test_the_face_you_make_becomes_full_and_nothing_else_changes():
    wanted = face(jawOpen=0.6, mouthSmileLeft=0.45, browDownLeft=0.05)
    settings = learn_full(DriveSettings(), wanted)
    shown = ResponseTable(settings.responses).applied(wanted)
    assert shown[index("jawOpen")] == pytest.approx(1.0)
    assert shown[index("mouthSmileLeft")] == pytest.approx(1.0)
    assert settings.responses[index("browDownLeft")] == Response()
    only = learn_full(DriveSettings(), wanted, index("jawOpen"))
    assert only.responses[index("mouthSmileLeft")] == Response()


def test_extremes_are_those_seen():
    seen = Seen()
    assert not seen.range().any()
    for value in (0.3, 0.1, 0.7):
        seen.add(np.full(N, value))
    np.testing.assert_array_equal(seen.range(), np.tile([0.1, 0.7], (N, 1)))


# -- rest -------------------------------------------------------------------------------------


def test_rest_is_taken_off_lids_left_alone_and_full_stays_full():
    rest = rest_of(face(mouthPucker=0.4, jawOpen=0.9, eyeBlinkLeft=0.3))
    assert rest[index("jawOpen")] == 0.6
    assert rest[LEFT] == 0
    assert without_rest(rest, rest).max() == 0
    np.testing.assert_allclose(without_rest(np.ones(N), rest), 1.0)


def test_a_centre_survives_a_file_and_anything_else_is_none():
    centre = Centre(np.array([0.8, 0.6, 0, 0]), np.array([1.0, 2.0, 600.0]), face(jawOpen=0.1))
    again = centre_from_plain(centre_to_plain(centre))
    assert again is not None
    np.testing.assert_allclose(again.rotation_wxyz, centre.rotation_wxyz)
    np.testing.assert_allclose(again.expression, centre.expression)
    plain = centre_to_plain(centre)
    for broken in (
        None, [], {}, plain | {"rotation_wxyz": [0, 0, 0, 0]}, plain | {"expression": [1]},
        plain | {"translation_mm": [0, 0, -5]}, plain | {"translation_mm": ["a", 0, 5]},
        plain | {"translation_mm": [0, float("nan"), 5]},
    ):  # fmt: skip
        assert centre_from_plain(broken) is None


# -- blink levels -----------------------------------------------------------------------------


def test_levels_come_from_the_prompted_pictures():
    rng = np.random.default_rng(0)
    standard = np.stack([shot.standard for shot in SHOTS])
    found = 0.12 + 0.6 * standard + rng.normal(0, 0.01, standard.shape)
    levels = blink_levels(standard, np.clip(found, 0, 1))
    np.testing.assert_allclose(levels.open, 0.12, atol=0.02)
    np.testing.assert_allclose(levels.closed, 0.72, atol=0.03)
    np.testing.assert_allclose(levels.applied(np.array([0.12, 0.75])), [0, 1], atol=0.03)


def test_pictures_of_no_prompt_tell_no_levels():
    assert blink_levels(np.full((5, N), np.nan), np.full((5, N), 0.4)) is None
    assert blink_levels(np.zeros((5, N)), np.full((5, N), 0.1)) is None


def test_one_squeezed_eye_says_nothing_of_the_other():
    shots = [s for s in SHOTS if s.expression_name in ("neutral", "squeeze_left_eye")]
    standard = np.stack([shot.standard for shot in shots])
    levels = blink_levels(standard, 0.7 * standard)
    np.testing.assert_allclose(levels.closed, [1.0, 0.7])


def test_levels_that_cannot_be_are_limited():
    standard = np.zeros((4, N))
    standard[2:, [RIGHT, LEFT]] = 1.0
    levels = blink_levels(standard, np.full((4, N), 0.9))
    assert (levels.open <= 0.4).all()
    assert (levels.closed >= levels.open + 0.3).all()


def test_levels_are_learned_from_a_face_that_blinks_and_not_from_one_that_sleeps():
    awake, asleep = LearnedLevels(), LearnedLevels()
    for k in range(60 * FPS):
        down = k % (4 * FPS) < 5
        levels = awake.add(np.full(2, 0.7 if down else 0.15), 1 / FPS)
        asleep.add(np.full(2, 0.75), 1 / FPS)
    np.testing.assert_allclose(levels.open, 0.15, atol=0.03)
    np.testing.assert_allclose(levels.closed, 0.7, atol=0.04)
    assert (asleep.levels.open <= 0.4).all()
    assert asleep.levels.applied(np.full(2, 0.75)).min() > 0.5


def test_learned_levels_never_jump():
    learned = LearnedLevels()
    last = learned.levels
    for k in range(20 * FPS):
        levels = learned.add(np.full(2, 0.65 if k % 60 < 6 else 0.2), 1 / FPS)
        assert np.abs(levels.closed - last.closed).max() < 0.02
        assert np.abs(levels.open - last.open).max() < 0.02
        last = levels


# -- both eyes --------------------------------------------------------------------------------


def lids(right, left, way="blinks", yaw_rad=0.0):
    out = face(eyeBlinkRight=right, eyeBlinkLeft=left)
    link_lids(out, yaw_rad, way)
    return out[RIGHT], out[LEFT]


def test_a_blink_that_one_eye_follows_late_closes_both_alike():
    assert lids(0.9, 0.7) == pytest.approx((0.8, 0.8))


def test_a_wink_stays_a_wink_and_its_other_eye_opens():
    right, left = lids(0.3, 1.0)
    assert left == 1.0
    assert right < 0.1


def test_always_and_never_are_meant():
    assert lids(0.0, 1.0, "always") == pytest.approx((0.5, 0.5))
    assert lids(0.9, 0.7, "never") == (0.9, 0.7)


def test_between_blink_and_wink_nothing_jumps():
    shown = np.array([lids(0.4, 0.4 + d) for d in np.linspace(0, 0.6, 200)])
    assert np.abs(np.diff(shown, axis=0)).max() < 0.03
    assert wink_share(0.0) == 0
    assert wink_share(-1.0) == 1


def test_of_a_turned_head_the_nearer_eye_counts():
    assert lids(0.2, 0.4, yaw_rad=0.7) == pytest.approx((0.2, 0.2))
    assert lids(0.2, 0.4, yaw_rad=-0.7) == pytest.approx((0.4, 0.4))


def test_linked_eyes_look_in_one_direction():
    gaze = np.array([[0.1, 0.0], [0.3, 0.1]])
    np.testing.assert_allclose(turned_gaze(gaze, EyeSettings(link_gaze=True)), [[0.2, 0.05]] * 2)
    np.testing.assert_array_equal(turned_gaze(gaze, EyeSettings()), gaze)


def test_closed_levels_are_kept_apart_for_both_eyes():
    levels = BlinkLevels(np.zeros(2), np.array([0.5, 1.0]))
    np.testing.assert_allclose(levels.applied(np.array([0.5, 0.5])), [1.0, 0.5])


# -- keys -------------------------------------------------------------------------------------


def play(key, presses, seconds=1.0):
    """Return the levels of a key that is pressed and released at frames."""
    fades, out = KeyFades(), []
    for k in range(round(seconds * FPS)):
        for frame, what in presses:
            if k == frame:
                getattr(fades, what)(1, key.hold)
        out.append(fades.step((key,), 1 / FPS)[0])
    return out


def test_a_held_face_fades_in_stays_and_fades_out_on_release():
    levels = play(face_key("Smile", hold=True), [(3, "press"), (15, "release")], 1.5)
    assert max(levels[:3]) == 0
    assert levels[14] == 1
    assert levels[-1] == 0
    assert np.abs(np.diff(levels)).max() < 0.35


def test_a_toggled_face_stays_after_release_and_goes_with_the_next_press():
    presses = [(3, "press"), (5, "release"), (30, "press"), (32, "release")]
    levels = play(face_key("Smile"), presses, 2.0)
    assert levels[29] == 1
    assert levels[-1] == 0


def test_added_faces_leave_the_tracked_one_and_never_pass_one():
    tracked = face(jawOpen=0.5, mouthSmileLeft=0.9)
    shown = KeyFaces((face_key("Smile"),)).applied(tracked, [1.0])
    assert shown[index("jawOpen")] == 0.5
    assert 0.9 < shown[index("mouthSmileLeft")] <= 1
    assert shown[index("mouthSmileRight")] == pytest.approx(0.85)


def test_replacing_a_part_leaves_the_others_and_replacing_the_face_leaves_none():
    tracked = face(jawOpen=0.5, eyeWideLeft=0.4)
    part = KeyFaces((face_key("Eyes closed", way="part"),)).applied(tracked, [1.0])
    assert part[index("jawOpen")] == 0.5
    assert part[index("eyeWideLeft")] == 0
    whole = KeyFaces((face_key("Eyes closed", way="face"),)).applied(tracked, [1.0])
    assert whole[index("jawOpen")] == 0
    assert whole[LEFT] == 1


def test_half_a_face_is_half_shown():
    key = key_from("Open", face(jawOpen=1.0))
    shown = KeyFaces((key,)).applied(np.zeros(N), [0.5])
    assert shown[index("jawOpen")] == 0.5


# -- by itself --------------------------------------------------------------------------------


def test_breathing_fades_in_is_small_and_can_be_made_larger():
    def run(size):
        breathing = Breathing()
        return np.array([breathing.step(True, size, 1 / FPS) for _ in range(12 * FPS)])

    one, two = run(1.0), run(2.0)
    assert np.abs(np.diff(one, axis=0)).max() < 0.3
    assert np.rad2deg(np.ptp(one[:, 1])) < 0.5
    assert 1 < np.ptp(one[:, 4]) < 4
    np.testing.assert_allclose(two, 2 * one)


def test_blinks_by_itself_come_at_uneven_times_and_end():
    blink = SelfBlink()
    closure = np.array([blink.step(True, 1 / FPS) for _ in range(60 * FPS)])
    starts = np.flatnonzero((closure[1:] > 0) & (closure[:-1] == 0)) / FPS
    gaps = np.diff(starts)
    assert gaps.min() > 2
    assert gaps.max() < 7
    assert gaps.std() > 0.5
    assert (eased(-1), eased(0.5), eased(2)) == (0, 0.5, 1)
    while blink.step(True, 1 / FPS) == 0:
        pass
    tail = [blink.step(False, 1 / FPS) for _ in range(30)]
    assert max(tail) > 0
    assert tail[-1] == 0


# -- the head ---------------------------------------------------------------------------------


def random_head(rng):
    angles = rng.uniform([-1.2, -1.0, -1.0], [1.2, 1.0, 1.0])
    return quaternion_from_matrix(matrix_from_head_angles(*angles)), rng.normal([0, 0, 600], 90)


@pytest.mark.parametrize("seed", range(5))
def test_kernels_agree_with_the_matrices_of_geometry(seed):
    rng = np.random.default_rng(seed)
    (a, place), (b, _) = random_head(rng), random_head(rng)
    out, angles = np.empty(4), np.empty(3)
    times(a, b, out)
    matrices = matrix_from_quaternion(a), matrix_from_quaternion(b)
    np.testing.assert_allclose(matrix_from_quaternion(out), matrices[0] @ matrices[1], atol=1e-12)
    times_back(a, b, out)
    np.testing.assert_allclose(matrix_from_quaternion(out), matrices[0] @ matrices[1].T, atol=1e-12)
    facing(place, out)
    np.testing.assert_allclose(
        matrix_from_quaternion(out), rotation_facing_camera(place), atol=1e-12
    )
    angles_of(a, angles)
    np.testing.assert_allclose(angles, head_angles_from_matrix(matrices[0]), atol=1e-12)
    from_angles(angles, out)
    assert rotation_angle_rad(out, a) < 1e-7


@pytest.mark.parametrize("seed", range(3))
def test_a_head_goes_through_its_deviation_and_back(seed):
    rng, head = np.random.default_rng(seed), HeadPlace()
    rotation, place = random_head(rng)
    head.usually(random_head(rng)[0])
    head.away(*random_head(rng))
    again, there = head.placed(head.away(rotation, place))
    assert rotation_angle_rad(again, rotation) < 1e-6
    np.testing.assert_allclose(there, place, atol=1e-9)


def test_gains_do_not_turn_a_head_further_than_a_neck_can_unless_the_user_does():
    away = np.array([1.2, 0.9, 0.1, 5.0, 0.0, 0.0])
    out = with_gains(away, np.full(6, 3.0))
    assert out[0] == pytest.approx(1.7)
    assert out[2] == pytest.approx(0.3)
    np.testing.assert_array_equal(with_gains(away * 2, np.ones(6)), away * 2)
