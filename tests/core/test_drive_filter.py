"""The drive's filter: a still face is steady, a fast one is not late, and lips stay together."""

import numpy as np
import pytest

from core.arkit import EXPRESSION_NAMES
from core.drive_filter import (
    GAZE,
    PLACE,
    TURN,
    FilterSettings,
    GroupFilter,
    group_of,
    group_order,
    noise_of,
)
from core.drive_settings import Steadiness
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
    quaternion_from_matrix,
)
from tests.core.driven_faces import FPS, N, index

STILL = np.array([1.0, 0, 0, 0])
PLACE_MM = np.array([0.0, 0.0, 600.0])


def filtered(rows, taste=None):
    """Return the filtered coefficients of rows (K, 46), the head being still."""
    one = GroupFilter()
    one.use(one.table(taste or Steadiness()))
    steps = [one.step(STILL, PLACE_MM, row, np.zeros((2, 2)), 1 / FPS) for row in rows]
    return np.array([step[2] for step in steps])


def turned(yaws_deg):
    one, out = GroupFilter(), []
    for yaw in yaws_deg:
        rotation = quaternion_from_matrix(matrix_from_head_angles(np.deg2rad(yaw), 0.1, 0.0))
        step = one.step(rotation, PLACE_MM, np.zeros(N), np.zeros((2, 2)), 1 / FPS)
        out.append(np.rad2deg(head_angles_from_matrix(matrix_from_quaternion(step[0]))[0]))
    return np.array(out)


def test_every_value_is_in_one_group_and_has_noise():
    order, starts = group_order()
    assert sorted(order) == list(range(PLACE.stop))
    assert starts[0] == 0
    assert starts[-1] == PLACE.stop
    assert (noise_of(FilterSettings()) > 0).all()
    assert (GAZE.stop, TURN.stop) == (TURN.start, PLACE.start)
    assert [group_of(n) for n in ("browDownLeft", "eyeBlinkLeft", "jawOpen")] == [
        "brows", "eyes", "mouth",
    ]  # fmt: skip


def test_noise_of_a_still_face_falls_to_a_quarter_from_frame_to_frame():
    rng = np.random.default_rng(0)
    rows = 0.3 + rng.standard_normal((300, N)) * noise_of(FilterSettings())[:N]
    out = filtered(rows)[30:]
    assert np.abs(np.diff(out, axis=0)).mean() < 0.25 * np.abs(np.diff(rows, axis=0)).mean()
    yaws = rng.normal(0, np.rad2deg(0.003), 300)
    assert np.abs(np.diff(turned(yaws)[30:])).mean() < 0.2 * np.abs(np.diff(yaws)).mean()


@pytest.mark.parametrize("name", ["eyeBlinkLeft", "jawOpen", "mouthPressLeft", "browInnerUpLeft"])
@pytest.mark.parametrize("frames", [1, 2, 3])
def test_a_blink_and_a_plosive_of_few_frames_keep_nine_tenths_of_their_height(name, frames):
    rows = np.zeros((60, N))
    rows[30 : 30 + frames, index(name)] = 0.9
    out = filtered(rows)[:, index(name)]
    assert out.max() > 0.9 * 0.9
    assert out[30 + frames + 2 :].max() < 0.1


def test_a_head_that_turns_is_followed_within_a_quarter_of_a_frame():
    yaws = np.concatenate([np.zeros(10), 4.0 * np.arange(15)])
    late_deg = (yaws - turned(yaws))[14:]
    assert late_deg.max() < 0.25 * 4.0


def test_what_belongs_together_in_the_lips_stays_together():
    rows = np.zeros((60, N))
    rows[30:, index("jawOpen")] = rows[30:, index("mouthClose")] = 0.12
    out = filtered(rows)
    np.testing.assert_array_equal(out[:, index("jawOpen")], out[:, index("mouthClose")])


def test_a_blink_does_not_let_the_brows_shake():
    rng = np.random.default_rng(1)
    rows = np.clip(0.2 + 0.01 * rng.standard_normal((90, N)), 0, 1)
    calm = filtered(rows)
    rows[60:66, index("eyeBlinkLeft")] = rows[60:66, index("eyeBlinkRight")] = 1.0
    blinking = filtered(rows)
    brows = [n for n in range(N) if group_of(EXPRESSION_NAMES[n]) == "brows"]
    np.testing.assert_array_equal(calm[:, brows], blinking[:, brows])


def test_taste_goes_from_steady_to_as_tracked():
    rng = np.random.default_rng(0)
    rows = 0.3 + rng.standard_normal((200, N)) * noise_of(FilterSettings())[:N]
    shakes = [
        np.abs(np.diff(filtered(rows, Steadiness(t, t, t, t))[30:], axis=0)).mean()
        for t in (0.0, 0.25, 0.5, 0.75, 1.0)
    ]
    assert shakes == sorted(shakes)
    np.testing.assert_allclose(filtered(rows, Steadiness(1, 1, 1, 1)), rows, atol=1e-9)


@pytest.mark.parametrize("step_s", [-1.0, 0.0, 2.0])
def test_after_a_gap_or_a_step_back_a_face_passes_unchanged(step_s):
    one, row = GroupFilter(), np.full(N, 0.01)
    one.step(STILL, PLACE_MM, np.zeros(N), np.zeros((2, 2)), 1 / FPS)
    np.testing.assert_array_equal(one.step(STILL, PLACE_MM, row, np.zeros((2, 2)), step_s)[2], row)


def test_dropped_frames_change_no_more_than_their_time():
    rows = np.zeros((40, N))
    rows[10:, index("jawOpen")] = 0.03
    whole = filtered(rows)[:, index("jawOpen")]
    one, half = GroupFilter(), []
    for row in rows[::2]:
        half.append(one.step(STILL, PLACE_MM, row, np.zeros((2, 2)), 2 / FPS)[2][index("jawOpen")])
    assert abs(half[-1] - whole[-2]) < 0.003
