"""The drive: what is passed on, what is added, and that nothing ever jumps."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from core.arkit import EXPRESSION_NAMES
from core.blink_levels import BlinkLevels
from core.centring import Centre
from core.drive import Drive
from core.drive_presets import PRESETS
from core.drive_settings import (
    Centring,
    DriveSettings,
    EyeSettings,
    HeadMotion,
    IdleSettings,
    Response,
)
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
    quaternion_from_matrix,
    rotation_angle_rad,
    rotation_facing_camera,
)
from core.head_place import HeadPlace
from tests.core.driven_faces import FPS, face, index, solved, stay

AS_TRACKED = PRESETS["As tracked"][1]
QUIET = replace(AS_TRACKED, idle=IdleSettings(breathing="never", blinking="never", hold_s=0.5))


def seen_deg(state):
    """Return yaw, pitch, roll of a head against the line of sight."""
    rotation = matrix_from_quaternion(state.rotation_wxyz)
    facing = rotation_facing_camera(state.translation_mm)
    return np.rad2deg(head_angles_from_matrix(facing.T @ rotation))


def largest_step(states):
    """Return the largest change of a coefficient, of mm and of degrees between two frames."""
    pairs = list(pairwise(states))
    return (
        max(np.abs(b.expression - a.expression).max() for a, b in pairs),
        max(np.abs(b.translation_mm - a.translation_mm).max() for a, b in pairs),
        max(np.rad2deg(rotation_angle_rad(a.rotation_wxyz, b.rotation_wxyz)) for a, b in pairs),
    )


def test_as_tracked_changes_nothing():
    rng, drive = np.random.default_rng(0), Drive(AS_TRACKED)
    for k in range(20):
        expression = rng.uniform(0, 1, 46)
        expression[index("mouthClose")] = 0.5 * expression[index("jawOpen")]
        state = solved(k / FPS, expression, rng.normal(0, 20, 3), rng.normal([0, 0, 600], 60),
                       rng.normal(0, 0.2, (2, 2)))  # fmt: skip
        driven = drive.step(state)
        for name in ("rotation_wxyz", "translation_mm", "expression", "gaze_rad"):
            np.testing.assert_allclose(getattr(driven, name), getattr(state, name), atol=1e-9)
        assert (driven.time_s, driven.mode, driven.lost) == (state.time_s, state.mode, state.lost)


def test_the_same_faces_give_the_same_driven_ones():
    def run():
        drive, rng = Drive(PRESETS["Lively"][1]), np.random.default_rng(3)
        return [drive.step(solved(k / FPS, rng.uniform(0, 1, 46), lost=k > 30)) for k in range(90)]

    for a, b in zip(run(), run(), strict=True):
        np.testing.assert_array_equal(a.expression, b.expression)
        np.testing.assert_array_equal(a.translation_mm, b.translation_mm)


def test_recentring_makes_the_present_pose_the_middle_and_the_present_face_the_rest():
    drive = Drive(QUIET)
    stay(drive, 1.0)
    tired = face(mouthPucker=0.3, browDownLeft=0.2)
    pose = {"expression": tired, "angles_deg": (12, -8, 3), "place_mm": (60, -20, 700)}
    stay(drive, 1.0, 1.0, **pose)
    drive.recentre()
    last = stay(drive, 1.0, 2.0, **pose)[-1]
    np.testing.assert_allclose(seen_deg(last), 0, atol=1e-6)
    np.testing.assert_allclose(last.translation_mm, [0, 0, 600], atol=1e-6)
    np.testing.assert_allclose(last.expression, 0, atol=1e-9)
    assert drive.centre is not None
    np.testing.assert_allclose(drive.centre.translation_mm, [60, -20, 700])


def test_recentring_goes_smoothly_and_waits_for_a_face():
    drive = Drive(QUIET)
    shown = stay(drive, 0.5, angles_deg=(20, 0, 0))
    drive.recentre()
    shown += stay(drive, 0.4, 0.5, lost=True, angles_deg=(20, 0, 0))
    assert drive.centre is None
    shown += stay(drive, 1.0, 0.9, angles_deg=(20, 0, 0))
    assert largest_step(shown)[2] < 5
    np.testing.assert_allclose(seen_deg(shown[-1]), 0, atol=1e-6)


def test_a_centre_from_an_earlier_day_is_used_and_full_stays_full():
    rotation = quaternion_from_matrix(matrix_from_head_angles(0.2, 0.0, 0.0))
    drive = Drive(QUIET)
    drive.put_centre(Centre(rotation, np.array([0, 0, 600.0]), face(mouthPucker=0.4)))
    away = {"angles_deg": np.rad2deg([0.2, 0, 0]), "expression": face(mouthPucker=1.0)}
    states = stay(drive, 0.6, **away)
    np.testing.assert_allclose(seen_deg(states[-1]), 0, atol=1e-6)
    assert states[-1].expression[index("mouthPucker")] == pytest.approx(1.0)


def test_with_a_set_centre_the_first_picture_shows_it_so_that_the_view_is_centred_there():
    drive = Drive(QUIET)
    drive.put_centre(Centre(np.array([1.0, 0, 0, 0]), np.array([0, 0, 600.0])))
    states = stay(drive, 0.6, place_mm=(80, 0, 600))
    np.testing.assert_allclose(states[0].translation_mm, [0, 0, 600], atol=1e-6)
    np.testing.assert_allclose(states[-1].translation_mm, [80, 0, 600], atol=1e-6)
    assert largest_step(states)[1] < 20


def test_a_centre_that_comes_while_another_one_is_put_is_not_lost(monkeypatch):
    first, second = (Centre(np.array([1.0, 0, 0, 0]), np.array([x, 0, 600.0])) for x in (0, 40.0))
    drive = Drive(QUIET)
    put = HeadPlace.put

    def interrupted(head, centre):
        put(head, centre)
        if centre is first:
            drive.put_centre(second)

    monkeypatch.setattr(HeadPlace, "put", interrupted)
    drive.put_centre(first)
    stay(drive, 0.1)
    np.testing.assert_allclose(drive.centre.translation_mm, [40, 0, 600])


def test_another_centre_while_a_face_is_seen_makes_no_jump():
    drive = Drive(QUIET)
    states = stay(drive, 0.5, angles_deg=(15, 0, 0))
    drive.put_centre(Centre(states[0].rotation_wxyz, np.array([0, 0, 600.0])))
    states += stay(drive, 0.6, 0.5, angles_deg=(15, 0, 0))
    drive.put_centre(None)
    states += stay(drive, 0.6, 1.1, angles_deg=(15, 0, 0))
    assert largest_step(states)[2] < 4
    np.testing.assert_allclose(seen_deg(states[31]), 0, atol=1e-6)
    np.testing.assert_allclose(seen_deg(states[-1]), [15, 0, 0], atol=1e-6)


def test_the_middle_is_how_the_avatars_view_thinks_the_user_usually_looks():
    usual = quaternion_from_matrix(matrix_from_head_angles(0.0, -0.3, 0.0))
    drive = Drive(QUIET)
    drive.know_usual_rotation(usual)
    stay(drive, 0.2, angles_deg=(10, 0, 0))
    drive.recentre()
    last = stay(drive, 1.0, 0.2, angles_deg=(10, 0, 0))[-1]
    assert rotation_angle_rad(last.rotation_wxyz, usual) < 1e-6


def test_auto_centre_follows_a_slow_slide_in_the_chair():
    drive = Drive(replace(QUIET, centring=Centring(head=True, face=True, time_s=5.0)))
    stay(drive, 1.0)
    slid = {"angles_deg": (6, -5, 2), "place_mm": (40, 30, 620)}
    last = stay(drive, 40.0, 1.0, expression=face(mouthPucker=0.1), **slid)[-1]
    assert np.abs(seen_deg(last)).max() < 0.5
    assert np.abs(last.translation_mm - [0, 0, 600]).max() < 1.5
    assert last.expression.max() < 0.01


@pytest.mark.parametrize(
    "meant",
    [
        {"expression": face(mouthSmileLeft=0.5, mouthSmileRight=0.5)},
        {"angles_deg": (30, 0, 0)},
        {"confidence": 0.1},
        {"lost": True},
    ],
)
def test_auto_centre_learns_nothing_from_a_face_that_means_something(meant):
    drive = Drive(replace(QUIET, centring=Centring(head=True, face=True, time_s=5.0)))
    stay(drive, 0.5)
    stay(drive, 20.0, 0.5, **meant)
    assert drive.centre is None


def test_auto_centre_is_off_unless_wanted():
    drive = Drive(DriveSettings())
    stay(drive, 20.0, angles_deg=(5, 0, 0))
    assert drive.centre is None


def test_head_gains_scale_each_axis_about_the_centre():
    drive = Drive(replace(QUIET, head=HeadMotion(0.5, 2.0, 0.0, 2.0, 0.5, 0.0)))
    stay(drive, 0.5)
    # Small angles, for which the line of sight to the moved head does not matter.
    last = stay(drive, 0.5, 0.5, angles_deg=(4, 3, 5), place_mm=(2, 4, 650))[-1]
    plain = seen_deg(solved(angles_deg=(4, 3, 5), place_mm=(2, 4, 650)))
    np.testing.assert_allclose(seen_deg(last), plain * [0.5, 2.0, 0.0], atol=0.02)
    np.testing.assert_allclose(last.translation_mm, [4, 2, 600], atol=1e-9)


def test_responses_are_applied_and_live_extremes_recorded_before_them():
    responses = list(QUIET.responses)
    responses[index("jawOpen")] = Response(gain=2.0, low=0.1, high=0.5, offset=0.1)
    drive = Drive(replace(QUIET, responses=tuple(responses)))
    assert not drive.seen.any()
    stay(drive, 0.2, expression=face(jawOpen=0.2))
    last = stay(drive, 0.2, 0.2, expression=face(jawOpen=0.3))[-1]
    assert last.expression[index("jawOpen")] == pytest.approx(1.0)
    np.testing.assert_allclose(drive.seen[index("jawOpen")], [0.2, 0.3])
    assert drive.now[index("jawOpen")] == pytest.approx(0.3)
    drive.forget_seen()
    stay(drive, 0.1, 0.4, expression=face(jawOpen=0.3))
    np.testing.assert_allclose(drive.seen[index("jawOpen")], [0.3, 0.3])


def test_lips_are_never_closed_further_than_the_jaw_is_open():
    responses = list(QUIET.responses)
    responses[index("jawOpen")] = Response(gain=0.5)
    drive = Drive(replace(QUIET, responses=tuple(responses)))
    shown = stay(drive, 0.1, expression=face(jawOpen=0.4, mouthClose=0.4))[-1].expression
    assert shown[index("mouthClose")] == shown[index("jawOpen")] == pytest.approx(0.2)


def test_blink_levels_of_the_profile_make_full_closure_one_and_open_zero():
    drive = Drive(replace(QUIET, eyes=EyeSettings()))
    drive.know_levels(BlinkLevels(np.array([0.15, 0.1]), np.array([0.7, 0.8])))
    opened = face(eyeBlinkRight=0.15, eyeBlinkLeft=0.1)
    closed = face(eyeBlinkRight=0.7, eyeBlinkLeft=0.8)
    assert stay(drive, 0.1, expression=opened)[-1].expression.max() == 0
    lids = stay(drive, 0.1, 0.1, expression=closed)[-1].expression
    assert lids[index("eyeBlinkRight")] == pytest.approx(1.0)
    assert lids[index("eyeBlinkLeft")] == pytest.approx(1.0)


def test_without_a_profile_blink_levels_are_learned_on_the_way():
    drive = Drive(replace(QUIET, eyes=EyeSettings()))
    opened, closed = (face(eyeBlinkRight=v, eyeBlinkLeft=v) for v in (0.12, 0.65))
    for k in range(40 * FPS):
        blinks = k % (3 * FPS) < 5
        state = drive.step(solved(k / FPS, closed if blinks else opened))
        if k > 35 * FPS:
            lid = state.expression[index("eyeBlinkLeft")]
            assert lid > 0.95 if blinks else lid < 0.05


def test_a_lost_face_is_held_then_rests_breathes_and_blinks():
    drive = Drive(DriveSettings())
    talking = {"expression": face(jawOpen=0.6), "angles_deg": (25, 10, 0)}
    before = stay(drive, 1.0, **talking)[-1]
    held = stay(drive, 0.4, 1.0, lost=True, **talking)
    np.testing.assert_allclose(held[-1].expression, before.expression, atol=1e-6)
    idle = stay(drive, 30.0, 1.4, lost=True, **talking)
    assert all(state.lost for state in idle)
    resting = idle[3 * FPS :]
    assert max(state.expression[index("jawOpen")] for state in resting) < 0.01
    blinks = np.array([state.expression[index("eyeBlinkLeft")] for state in resting])
    assert 4 <= np.sum((blinks[1:] >= 0.5) & (blinks[:-1] < 0.5)) <= 14
    assert blinks.max() > 0.95
    places = np.array([state.translation_mm for state in resting])
    assert 1.0 < np.ptp(places[:, 1]) < 6.0
    pitches = np.array([seen_deg(state)[1] for state in resting])
    assert 0.1 < np.ptp(pitches) < 1.0


def test_neither_leaving_nor_returning_jumps():
    drive = Drive(QUIET)
    shown = stay(drive, 1.0, expression=face(jawOpen=0.8), angles_deg=(30, 0, 0))
    shown += stay(drive, 4.0, 1.0, lost=True)
    away = {"expression": face(mouthPucker=0.9), "angles_deg": (-30, 0, 0),
            "place_mm": (-80, 0, 500)}  # fmt: skip
    shown += stay(drive, 1.0, 5.0, **away)
    coefficient, mm, degrees = largest_step(shown)
    assert coefficient < 0.2
    assert mm < 25
    assert degrees < 8
    np.testing.assert_allclose(shown[-1].translation_mm, [-80, 0, 500], atol=1e-6)
    np.testing.assert_allclose(shown[-1].expression, face(mouthPucker=0.9), atol=1e-9)


def test_a_face_back_after_one_frame_is_caught_up_with_in_a_tenth_of_a_second():
    drive = Drive(QUIET)
    stay(drive, 1.0)
    stay(drive, 1 / FPS, 1.0, lost=True)
    states = stay(drive, 0.2, 1.0 + 1 / FPS, expression=face(jawOpen=1.0))
    assert states[3].expression[index("jawOpen")] == pytest.approx(1.0)


def test_before_any_face_the_avatar_rests_and_lives():
    drive = Drive(DriveSettings())
    states = stay(drive, 10.0, lost=True)
    assert np.isfinite(states[-1].rotation_wxyz).all()
    assert np.ptp([state.translation_mm[1] for state in states]) > 0.5


def test_keys_show_their_faces_also_while_nobody_is_seen():
    drive = Drive(replace(PRESETS["Natural"][1], idle=QUIET.idle))
    drive.press(3)
    assert drive.keys_shown[2]
    last = stay(drive, 1.0, lost=True)[-1]
    assert last.expression[index("eyeWideLeft")] == pytest.approx(0.85)
    drive.press(3)
    last = stay(drive, 1.0, 1.0, lost=True)[-1]
    assert last.expression.max() == 0
    drive.press(7 + 5)
    assert not any(drive.keys_shown)


def test_settings_can_be_replaced_between_two_frames():
    drive = Drive(QUIET)
    stay(drive, 0.1, expression=face(jawOpen=0.4))
    responses = tuple(Response(gain=2.0) for _ in EXPRESSION_NAMES)
    drive.use(replace(QUIET, responses=responses))
    last = stay(drive, 0.1, 0.1, expression=face(jawOpen=0.4))[-1]
    assert last.expression[index("jawOpen")] == pytest.approx(0.8)
    assert drive.settings.responses == responses


def test_a_film_that_begins_again_is_followed_at_once():
    drive = Drive(DriveSettings())
    stay(drive, 1.0, 10.0, angles_deg=(0, 0, 0))
    state = drive.step(solved(0.0, angles_deg=(20, 0, 0)))
    np.testing.assert_allclose(seen_deg(state)[0], 20, atol=1e-6)


def test_reset_forgets_a_person_but_not_the_centre_that_was_set():
    drive = Drive(QUIET)
    stay(drive, 0.5, expression=face(jawOpen=0.5), angles_deg=(10, 0, 0))
    drive.recentre()
    stay(drive, 0.5, 0.5, angles_deg=(10, 0, 0))
    drive.reset()
    stay(drive, 0.2, 1.0, angles_deg=(10, 0, 0))
    assert drive.seen[index("jawOpen"), 1] == 0
    assert drive.centre is not None


def test_linked_gaze_and_its_gain_are_passed_on():
    eyes = EyeSettings(link_gaze=True, gaze_gain=1.5, gaze_up_rad=0.05)
    drive = Drive(replace(QUIET, eyes=eyes))
    gaze = np.array([[0.1, 0.02], [0.2, 0.02]])
    last = stay(drive, 0.2, gaze_rad=gaze)[-1]
    np.testing.assert_allclose(last.gaze_rad, [[0.225, 0.08], [0.225, 0.08]])
