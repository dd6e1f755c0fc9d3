"""Facts about the performer who stands in for a camera in the guided setup."""

from itertools import pairwise

import numpy as np
import pytest

from app.performer.prompted import PromptedPerformer


@pytest.fixture(scope="module")
def performer():
    with PromptedPerformer(stride=1) as source:
        yield source


def watch(performer, n_frames):
    return [performer.read() for _ in range(n_frames)]


@pytest.mark.gl
def test_a_prompt_is_followed_and_its_pose_held(performer):
    performer.follow("pose_yaw+30")
    frames = watch(performer, 75)
    levels = [frame.gray.astype(float) for frame in frames[::8]]
    changes = [np.abs(a - b).mean() for a, b in pairwise(levels)]
    assert max(changes[:6]) > 1.0
    assert changes[-1] == 0.0
    assert [frame.index for frame in frames] == list(range(75))
    assert frames[30].time_s == pytest.approx(1.0)


@pytest.mark.gl
def test_another_prompt_gives_another_pose_and_the_same_one_changes_nothing(performer):
    held = watch(performer, 1)[0]
    performer.follow("pose_yaw+30")
    assert np.array_equal(watch(performer, 1)[0].gray, held.gray)
    performer.follow("pose_pitch-15")
    other = watch(performer, 75)[-1]
    assert np.abs(other.gray.astype(float) - held.gray).mean() > 1.0
