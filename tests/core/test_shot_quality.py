"""Facts about what makes a frame a good setup picture."""

import numpy as np
import pytest

from core.shot_quality import ADVICE, HARMLESS, WHY_WEAK, Advisor, Looked, is_blank, troubles


def picture(face=120, around=110):
    gray = np.full((480, 640), around, np.uint8)
    gray[150:350, 230:410] = face
    return gray


def face_points(scale=1.0, shift=(0.0, 0.0)):
    across, down = np.meshgrid(np.linspace(-80, 80, 9), np.linspace(-70, 90, 9))
    points = np.column_stack([across.ravel(), down.ravel()])
    return scale * points + [320, 250] + np.array(shift)


def told(gray=None, points_px=None, **facts):
    gray = picture() if gray is None else gray
    return troubles(Looked(gray, face_points() if points_px is None else points_px, **facts))


def test_a_good_frame_has_no_troubles():
    assert told(sharpness=0.3, fps=30.0) == []


@pytest.mark.parametrize(
    ("trouble", "facts"),
    [
        ("several", {"rivals": 1}),
        ("blurred", {"sharpness": 0.02}),
        ("slow", {"fps": 7.0}),
        ("slow_dark", {"fps": 7.0, "gray": picture(60, 50)}),
        ("off_center", {"points_px": face_points(1.0, (140, 0))}),
        ("off_center", {"points_px": face_points(0.7, (-135, 0))}),
        ("far", {"points_px": face_points(0.4)}),
        ("near", {"points_px": face_points(2.6)}),
        ("outside", {"points_px": face_points(1.0, (250, 0))}),
        ("dark", {"gray": picture(20, 15)}),
        ("clipped", {"gray": picture(255, 200)}),
        ("backlit", {"gray": picture(80, 230)}),
    ],
)
def test_each_trouble_is_seen(trouble, facts):
    assert trouble in told(**facts)


def test_a_picture_of_nothing_is_blank(rng):
    noise = rng.normal(0, 2, (480, 640))
    assert is_blank(np.full((480, 640), 16, np.uint8))
    assert is_blank(np.clip(16 + noise, 0, 255).astype(np.uint8))
    assert not is_blank(picture(face=90, around=40))


def test_every_trouble_has_advice_and_a_reason():
    assert set(WHY_WEAK) | HARMLESS == set(ADVICE) and not set(WHY_WEAK) & HARMLESS


def test_no_face_is_told_before_all_else():
    assert troubles(Looked(picture(), None, rivals=0, fps=5.0)) == ["no_face", "slow"]
    assert "dark" in troubles(Looked(picture(10, 10), None))


def test_a_turned_face_is_not_far_away():
    narrow = face_points() * [0.45, 1.0] + [176, 0]
    assert told(points_px=narrow) == []


def test_advice_waits_until_a_trouble_lasts_and_leaves_when_it_is_over():
    advisor = Advisor(patience_s=1.5, leave_s=0.7)
    told = [advisor.step(["dark"], n / 10) for n in range(20)]
    assert told[:15] == [""] * 15 and told[16:] == ["dark"] * 4
    after = [advisor.step([], 2.0 + n / 10) for n in range(12)]
    assert after[0] == "dark" and after[-1] == ""


def test_a_flickering_trouble_is_still_one():
    advisor = Advisor()
    told = [advisor.step(["dark"] if n % 3 else [], n / 10) for n in range(30)]
    assert told[-1] == "dark"


def test_one_trouble_is_told_at_a_time_and_not_changed_while_it_lasts():
    advisor = Advisor()
    for n in range(20):
        advisor.step(["blurred"], n / 10)
    told = {advisor.step(["dark", "blurred"], 2.0 + n / 10) for n in range(30)}
    assert told == {"blurred"}


def test_every_trouble_has_advice_that_can_be_followed():
    assert all(len(text) > 15 for text in ADVICE.values())
