"""The parts of the live controller that need no window."""

import numpy as np
import pytest

from app.controllers.filming import film_performer
from app.controllers.meter import WARM_UP_FRAMES, Meter
from app.controllers.progress import STEPS, between, remaining_text
from app.controllers.toolbox import Toolbox
from app.errors import NoImagesError, SourceUnreadableError
from app.sources import PERFORMER
from core.records import Frame, Progress
from core.setup_plan import SHOTS
from tests.app.live_fakes import make_state


def make_frame(index, time_s=0.0):
    return Frame(np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4), np.uint8), time_s, index)


class Clock:
    def __init__(self):
        self.now_s = 100.0

    def __call__(self):
        return self.now_s


def test_the_rate_is_that_of_the_last_frames_and_falls_to_zero_when_none_come():
    clock = Clock()
    meter = Meter(clock)
    assert meter.frames_per_second() == 0
    for index in range(50):
        clock.now_s += 0.1 if index < 10 else 0.04
        meter.count(make_frame(index), make_state(), 1.0)
    assert meter.frames_per_second() == pytest.approx(25)
    clock.now_s += 1.5
    assert meter.frames_per_second() == 0


def test_frames_dropped_before_tracking_runs_do_not_count():
    meter = Meter()
    index = 0
    for _ in range(WARM_UP_FRAMES + 1):
        index += 10
        meter.count(make_frame(index), make_state(), 50.0)
    assert meter.dropped == 0
    for step in (1, 3, 1):
        index += step
        meter.count(make_frame(index), make_state(), 4.0)
    assert meter.dropped == 2
    assert meter.solve_ms == pytest.approx(4.0)
    meter.reset()
    assert (meter.dropped, meter.solve_ms, meter.confidence) == (0, 0, 0)


def test_progress_of_parts_is_that_of_the_whole_and_never_goes_back():
    def part(label):
        for done in (0, 50, 100):
            yield Progress(done, 100, label)
        return label

    def twice():
        yield from part("look")
        return (yield from part("take"))

    def whole():
        first = yield from between(0.0, 0.4, twice())
        return first, (yield from between(0.4, 1.0, part("train")))

    seen, steps = [], whole()
    while True:
        try:
            seen.append(next(steps))
        except StopIteration as end:
            assert end.value == ("take", "train")
            break
    assert [one.done for one in seen] == [0, 200, 400, 400, 400, 400, 400, 700, 1000]
    assert {one.total for one in seen} == {STEPS}
    assert [one.label for one in seen] == ["look"] * 3 + ["take"] * 3 + ["train"] * 3


@pytest.mark.parametrize(
    ("share", "elapsed_s", "text"),
    [
        (0.5, 1.0, ""),
        (0.01, 60.0, ""),
        (0.9, 60.0, "a few seconds left"),
        (0.5, 42.0, "about 40 s left"),
        (0.25, 60.0, "about 3 min left"),
    ],
)
def test_remaining_time_is_told_when_it_can_be(share, elapsed_s, text):
    assert remaining_text(share, elapsed_s) == text


def test_the_toolbox_loops_files_and_lets_live_sources_live(tmp_path):
    toolbox = Toolbox()
    with pytest.raises(SourceUnreadableError):
        empty = tmp_path / "clip.mp4"
        empty.write_bytes(b"")
        toolbox.open_source(str(empty), lambda: None)
    with toolbox.open_source(toolbox.performances()[0].key, lambda: None) as source:
        assert source.live
    assert all(one.key.startswith(f"{PERFORMER}:") for one in toolbox.performances())
    assert toolbox.avatars()[0].text.startswith("Your own head (Nora until")


def test_a_profile_that_comes_to_nothing_leaves_nothing_behind(tmp_path, home):
    (tmp_path / "empty").mkdir()
    steps = Toolbox().profile_steps("anna", str(tmp_path / "empty"))
    with pytest.raises(NoImagesError):
        list(steps)
    assert list((home / "profiles").iterdir()) == []


def test_a_cancelled_profile_leaves_nothing_behind(home):
    steps = Toolbox().profile_steps("anna", PERFORMER)
    assert next(steps).label == "Filming the virtual performer"
    steps.close()
    assert list((home / "profiles").iterdir()) == []


def test_names_that_would_be_paths_are_refused():
    toolbox = Toolbox()
    assert toolbox.name_trouble("Anna-Lena 2") == ""
    assert "no name for a profile" in toolbox.name_trouble("what?")
    assert "no slash" in toolbox.name_trouble("here/anna")


class Blind:
    def detect(self, rgb):
        return []

    def first(self, rgb):
        return None

    def follow(self, rgb, previous):
        return None


@pytest.mark.gl
def test_the_performer_is_filmed_in_the_poses_of_the_shots():
    steps = film_performer(Blind(), every=20)
    labels = []
    while True:
        try:
            labels.append(next(steps).label)
        except StopIteration as end:
            pictures = end.value
            break
    assert pictures.images.names == tuple(shot.name for shot in SHOTS[::20])
    np.testing.assert_array_equal(pictures.images.standard, [shot.standard for shot in SHOTS[::20]])
    assert len(labels) == 3 and not any(one.confidence.any() for one in pictures.landmarks)
    assert np.abs(np.diff(np.stack(pictures.images.images).astype(int), axis=0)).mean() > 1
