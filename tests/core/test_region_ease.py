"""What is covered is held, let go, and comes back without a jump."""

from dataclasses import replace

import numpy as np
import pytest

from core.arkit import EXPRESSION_NAMES
from core.landmarks import REGION_NAMES
from core.live import resting_state
from core.region_ease import REGIONS, EaseSettings, RegionEase

FPS = 30.0
JAW, SMILE = EXPRESSION_NAMES.index("jawOpen"), EXPRESSION_NAMES.index("mouthSmileLeft")
BROW = EXPRESSION_NAMES.index("browInnerUpLeft")
BLINKS = [EXPRESSION_NAMES.index("eyeBlinkRight"), EXPRESSION_NAMES.index("eyeBlinkLeft")]


def regions(**confidence):
    return np.array([confidence.get(name, 1.0) for name in REGION_NAMES])


def state(index, coefficients=None, gaze=None, lost=False, **confidence):
    expression = np.zeros(len(EXPRESSION_NAMES))
    for k, value in (coefficients or {}).items():
        expression[k] = value
    return replace(
        resting_state("free"), time_s=index / FPS, expression=expression, lost=lost,
        gaze_rad=np.zeros((2, 2)) if gaze is None else gaze, regions=regions(**confidence),
    )  # fmt: skip


def played(states):
    ease = RegionEase()
    return [ease.step(one) for one in states]


def test_a_face_that_is_seen_is_handed_on_as_it_is():
    states = [state(n, {JAW: n / 30}) for n in range(20)]
    assert all(one is other for one, other in zip(played(states), states, strict=True))


def test_a_covered_mouth_is_held_then_falls_to_rest_and_the_brows_go_on():
    seen = [state(n, {JAW: 0.6, BROW: 0.1}) for n in range(10)]
    # What is solved of a covered mouth is nonsense, in every frame another.
    wild = [state(n, {JAW: n % 2, SMILE: 1, BROW: 0.5}, mouth=0.1) for n in range(10, 100)]
    shown = played(seen + wild)[10:]
    jaw = np.array([one.expression[JAW] for one in shown])
    held = round(EaseSettings().hold_s * FPS) - 1
    assert jaw[:held] == pytest.approx(0.6)
    assert np.all(np.diff(jaw) <= 1e-12) and jaw[-1] < 0.02
    assert max(one.expression[SMILE] for one in shown) == 0
    assert {one.expression[BROW] for one in shown} == {0.5}


def test_what_is_seen_again_comes_back_without_a_jump():
    states = [state(n) for n in range(5)] + [state(n, mouth=0.1) for n in range(5, 60)]
    states += [state(n, {JAW: 0.8}) for n in range(60, 75)]
    jaw = np.array([one.expression[JAW] for one in played(states)])
    assert jaw[59] == 0
    assert np.diff(jaw).max() < 0.8 * 0.35
    assert jaw[round(60 + EaseSettings().back_s * FPS)] == pytest.approx(0.8)


def test_a_confidence_between_both_levels_changes_nothing():
    settings = EaseSettings()
    between = 0.5 * (settings.covered + settings.seen)
    held = [state(0, {JAW: 0.3}), state(1, {JAW: 0.9}, mouth=0.0)]
    still = [state(n, {JAW: 0.9}, mouth=between) for n in range(2, 6)]
    assert [one.expression[JAW] for one in played(held + still)][1:] == pytest.approx([0.3] * 5)
    open_ = [state(n, {JAW: 0.9}, mouth=between) for n in range(6)]
    assert [one.expression[JAW] for one in played(open_)] == [0.9] * 6


def test_a_covered_eye_goes_with_the_other_one():
    gaze = np.array([[0.3, 0.1], [0.2, 0.0]])
    states = [state(n, gaze=gaze) for n in range(3)]
    wild = np.array([[-0.6, -0.5], [0.0, 0.1]])
    states += [
        state(n, {BLINKS[0]: 0.0, BLINKS[1]: 1.0}, wild, eye_right=0.0) for n in range(3, 90)
    ]
    shown = played(states)
    assert shown[-1].expression[BLINKS] == pytest.approx([1, 1], abs=0.03)
    assert shown[-1].gaze_rad == pytest.approx(np.array([[0.0, 0.1], [0.0, 0.1]]), abs=0.01)
    steps = np.diff([one.gaze_rad[0, 0] for one in shown])
    assert np.abs(steps).max() < 0.1


def test_a_covered_eye_turns_as_fast_whatever_the_frame_rate():
    def after_a_tenth(fps):
        ease = RegionEase()
        ease.step(replace(state(0), time_s=0.0))
        gaze = np.array([[0.0, 0.0], [0.3, 0.0]])
        for n in range(1, fps // 10 + 1):
            one = ease.step(replace(state(n, gaze=gaze, eye_right=0.0), time_s=n / fps))
        return one.gaze_rad[0, 0]

    assert after_a_tenth(30) == pytest.approx(after_a_tenth(120), rel=1e-6)
    assert 0.15 < after_a_tenth(30) < 0.25


def test_a_lost_face_stays_as_it_was_shown_and_a_long_gap_begins_anew():
    states = [state(0, {JAW: 0.4}), state(1, {JAW: 1.0}, mouth=0.0)]
    states += [state(2, {JAW: 1.0}, lost=True), state(200, {JAW: 0.9}, mouth=0.0)]
    assert [one.expression[JAW] for one in played(states)] == pytest.approx([0.4, 0.4, 0.4, 0.9])


def test_every_coefficient_is_seen_in_one_region():
    for name, region in (("cheekSquintLeft", "eye_left"), ("eyeWideRight", "eye_right"),
                         ("noseSneerLeft", "nose"), ("browDownLeft", "brows"),
                         ("jawForward", "mouth"), ("cheekPuffLeft", "mouth")):  # fmt: skip
        assert REGION_NAMES[REGIONS[EXPRESSION_NAMES.index(name)]] == region
