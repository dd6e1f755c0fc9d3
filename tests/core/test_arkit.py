"""The 46 names, the 52 ARKit names, and the map between them."""

import numpy as np
import pytest

from core.arkit import (
    ARKIT_NAMES,
    EXPRESSION_NAMES,
    FULL_LOOK_RAD,
    arkit_from,
    mirror_permutation,
)

STILL = np.zeros((2, 2))


def arkit(name, expression=None, gaze_rad=STILL):
    values = arkit_from(np.zeros(46) if expression is None else expression, gaze_rad)
    return values[ARKIT_NAMES.index(name)]


def one(name, amount=0.7):
    out = np.zeros(46)
    out[EXPRESSION_NAMES.index(name)] = amount
    return out


def test_there_are_46_and_52_different_names():
    assert len(set(EXPRESSION_NAMES)) == 46
    assert len(set(ARKIT_NAMES)) == 52


def test_ours_lack_only_gaze_tongue_and_the_two_that_are_split():
    missing = {name for name in ARKIT_NAMES if name not in EXPRESSION_NAMES}
    looks = {name for name in ARKIT_NAMES if name.startswith("eyeLook")}
    assert missing == looks | {"tongueOut", "browInnerUp", "cheekPuff"}


def test_mirroring_twice_changes_nothing_and_swaps_sides_once():
    mirror = np.array(mirror_permutation())
    assert mirror[mirror].tolist() == list(range(46))
    assert EXPRESSION_NAMES[mirror[EXPRESSION_NAMES.index("jawLeft")]] == "jawRight"
    assert EXPRESSION_NAMES[mirror[EXPRESSION_NAMES.index("mouthFunnel")]] == "mouthFunnel"


@pytest.mark.parametrize("name", [n for n in EXPRESSION_NAMES if n in ARKIT_NAMES])
def test_shared_names_pass_their_value(name):
    values = arkit_from(one(name), STILL)
    assert values[ARKIT_NAMES.index(name)] == pytest.approx(0.7)
    assert np.delete(values, ARKIT_NAMES.index(name)).max() == 0


@pytest.mark.parametrize("name", ["browInnerUp", "cheekPuff"])
def test_split_shapes_come_together_as_their_mean(name):
    both = one(name + "Left", 0.8) + one(name + "Right", 0.4)
    assert arkit(name, both) == pytest.approx(0.6)


def test_cheek_suck_has_no_place_in_arkit():
    assert arkit_from(one("cheekSuck"), STILL).max() == 0


def test_looking_to_the_subjects_left_turns_the_left_eye_out_and_the_right_eye_in():
    left = np.array([[0.5 * FULL_LOOK_RAD, 0.0]] * 2)
    assert arkit("eyeLookOutLeft", gaze_rad=left) == pytest.approx(0.5)
    assert arkit("eyeLookInRight", gaze_rad=left) == pytest.approx(0.5)
    assert arkit("eyeLookInLeft", gaze_rad=left) == 0
    assert arkit("eyeLookOutRight", gaze_rad=left) == 0


def test_pitch_up_looks_up_with_the_eye_that_it_is_of():
    up = np.array([[0.0, FULL_LOOK_RAD], [0.0, 0.0]])
    assert arkit("eyeLookUpRight", gaze_rad=up) == pytest.approx(1)
    assert arkit("eyeLookUpLeft", gaze_rad=up) == 0
    assert arkit("eyeLookDownRight", gaze_rad=-up) == pytest.approx(1)


def test_looks_beyond_the_full_angle_stay_at_one():
    values = arkit_from(np.zeros(46), np.full((2, 2), 3.0))
    assert values.max() == 1


def test_many_frames_map_at_once():
    rng = np.random.default_rng(0)
    expressions, gazes = rng.random((5, 46)), rng.normal(0, 0.2, (5, 2, 2))
    together = arkit_from(expressions, gazes)
    assert together.shape == (5, 52)
    for row, expression, gaze in zip(together, expressions, gazes, strict=True):
        np.testing.assert_array_equal(row, arkit_from(expression, gaze))
