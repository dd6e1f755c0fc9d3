"""Other light is told when it stays; other exposures, turned heads and moments are not."""

from dataclasses import replace

import numpy as np
import pytest

from core.camera import camera_for, project
from core.light_change import LightSettings, LightWatch, light_reference
from core.live import resting_state
from core.records import Frame, SetupShapes
from tests.core.painted_user import painted_user

CAMERA = camera_for((320, 240), 400.0)
FPS = 10


def face_mm():
    return painted_user().shape()[:77]


def lit(side=0.0, level=120.0):
    """A picture whose brightness rises by a factor of e^side per 100 px to the right."""
    x = np.arange(320.0)[None, :, None]
    picture = level * np.exp(side * (x - 160) / 100) * np.ones((240, 320, 3))
    return np.clip(picture, 0, 255).astype(np.uint8)


def shapes(n, yaw_rad=0.0):
    points = np.stack([face_mm()] * n)
    turned = [np.cos(yaw_rad / 2), 0, np.sin(yaw_rad / 2), 0]
    return SetupShapes(
        points, np.tile(turned, (n, 1)), np.zeros((n, 3)), np.zeros((n, 46)), np.ones(n)
    )


def state(time_s, **changes):
    points = project(CAMERA, face_mm()[:75])
    seen = replace(
        resting_state("trained"), time_s=time_s, landmarks_px=points, shape_mm=face_mm()[:75],
        confidence=1.0, lost=False,
    )  # fmt: skip
    return replace(seen, **changes)


@pytest.fixture
def watch():
    pictures = [lit(level=level) for level in (110.0, 120.0, 130.0)]
    return LightWatch(light_reference(pictures, shapes(3), CAMERA))


def watched(watch, picture, seconds, start_s=0.0, **changes):
    """The verdicts on a picture that stays for a while."""
    gray = picture[..., 0].copy()
    times = start_s + np.arange(round(seconds * FPS)) / FPS
    return [
        watch.step(Frame(picture, gray, float(t), n), state(float(t), **changes))
        for n, t in enumerate(times)
    ]


@pytest.mark.parametrize(
    "picture, kind",
    [(lit(side=0.5), "side"), (lit(side=-0.5), "side"), (lit(level=40.0), "dark"),
     (lit(level=235.0), "bright")],
)  # fmt: skip
def test_light_that_stays_otherwise_is_told_after_some_seconds(watch, picture, kind):
    verdicts = watched(watch, picture, 8.0)
    told = [n for n, verdict in enumerate(verdicts) if verdict is not None]
    assert 2.5 * FPS < told[0] < 5.5 * FPS and told[-1] == len(verdicts) - 1
    assert verdicts[-1].kind == kind
    assert verdicts[-1].reason.endswith("setup pictures.") and verdicts[-1].amount > 0


@pytest.mark.parametrize("picture", [lit(), lit(level=150.0), lit(level=80.0), lit(side=0.05)])
def test_the_setups_light_under_other_exposures_is_no_change(watch, picture):
    assert watched(watch, picture, 8.0) == [None] * (8 * FPS)


def test_a_lamp_that_is_off_for_a_moment_is_no_change(watch):
    verdicts = watched(watch, lit(), 4.0) + watched(watch, lit(level=30.0), 2.0, 4.0)
    verdicts += watched(watch, lit(), 6.0, 6.0)
    assert verdicts == [None] * len(verdicts)


@pytest.mark.parametrize(
    "changes",
    [
        {"lost": True},
        {"rotation_wxyz": np.array([np.cos(0.3), 0, np.sin(0.3), 0])},
        {"regions": np.array([1, 1, 1, 1, 0.1, 1.0])},
    ],
)
def test_lost_turned_and_covered_faces_tell_nothing(watch, changes):
    assert watched(watch, lit(side=0.5), 8.0, **changes) == [None] * (8 * FPS)


def test_a_gap_or_a_reset_begins_the_seconds_anew(watch):
    assert watched(watch, lit(side=0.5), 6.0)[-1] is not None
    watch.reset()
    assert watched(watch, lit(side=0.5), 2.0, 6.0) == [None] * (2 * FPS)
    assert watched(watch, lit(side=0.5), 2.0, 300.0) == [None] * (2 * FPS)


def test_spots_of_light_are_told_as_another_look(watch):
    picture = lit()
    points = project(CAMERA, face_mm()[:75])[60:]
    for k in (4, 5, 6, 7):
        x, y = points[k].astype(int)
        picture[y - 6 : y + 7, x - 6 : x + 7] = 60
    assert watched(watch, picture, 8.0)[-1].kind == "look"


def test_a_setup_of_turned_heads_or_lost_pictures_is_no_reference():
    pictures = [lit()] * 3
    assert light_reference(pictures, shapes(3, 0.6), CAMERA) is None
    assert light_reference([lit(), None, None], shapes(3), CAMERA) is None
    assert light_reference(pictures, shapes(3), CAMERA, LightSettings(facing_rad=0.1)) is not None
