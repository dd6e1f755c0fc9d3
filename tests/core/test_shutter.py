"""Facts about the hands-free shutter."""

import numpy as np

from core.shutter import Shutter

FACE = np.array([[0.0, 0.0], [100.0, 0.0], [50.0, 120.0]])
FPS = 30


def play(shutter, frames, start_s=0.0):
    """Step through (good, shift, sharpness) frames; return the states."""
    return [
        shutter.step(good, FACE + shift, sharp, start_s + n / FPS)
        for n, (good, shift, sharp) in enumerate(frames)
    ]


def phases(states):
    return [state.phase for state in states]


def test_it_shoots_once_after_the_face_was_right_and_still_long_enough():
    states = play(Shutter(), [(True, 0.0, 1.0)] * 45)
    seen = phases(states)
    first = seen.index("shooting")
    assert 0.65 < first / FPS < 0.95
    assert seen.count("done") == 1 and seen.index("done") / FPS < 1.3
    assert set(seen[:first]) == {"waiting", "holding"}


def test_a_moving_face_is_not_shot():
    assert "shooting" not in phases(play(Shutter(), [(True, 2.5 * n, 1.0) for n in range(60)]))


def test_a_trembling_one_is():
    rng = np.random.default_rng(0)
    frames = [(True, 1.2 * rng.normal(size=(3, 2)), 1.0) for _ in range(90)]
    assert "done" in phases(play(Shutter(), frames))


def test_a_wrong_face_is_not_shot():
    assert set(phases(play(Shutter(), [(False, 0.0, 1.0)] * 60))) == {"waiting"}


def test_a_short_lapse_is_forgiven_and_a_longer_one_is_not():
    right, wrong = (True, 0.0, 1.0), (False, 0.0, 1.0)
    short = play(Shutter(), [right] * 18 + [wrong] * 2 + [right] * 12)
    assert "shooting" in phases(short)
    long = play(Shutter(), [right] * 18 + [wrong] * 6 + [right] * 12)
    assert "shooting" not in phases(long)


def test_the_sharpest_frame_of_the_burst_is_the_best():
    sharp = [0.5] * 26 + [0.3, 0.9, 0.4, 0.8, 0.2, 0.1, 0.1, 0.1, 0.1, 0.1]
    states = play(Shutter(), [(True, 0.0, value) for value in sharp])
    kept = [n for n, state in enumerate(states) if state.best]
    assert kept[-1] == 27
    assert all(states[n].phase in ("shooting", "done") for n in kept)


def test_after_a_picture_and_after_a_new_prompt_there_is_a_pause():
    shutter = Shutter()
    seen = phases(play(shutter, [(True, 0.0, 1.0)] * 75))
    first = seen.index("done")
    assert set(seen[first + 1 : first + 14]) == {"waiting"}
    shutter.reset(10.0)
    assert set(phases(play(shutter, [(True, 0.0, 1.0)] * 14, start_s=10.0))) == {"waiting"}


def test_no_points_count_as_moving():
    shutter = Shutter()
    seen = {shutter.step(True, None, 1.0, n / FPS).phase for n in range(40)}
    assert seen == {"waiting"}
