import signal

import numpy as np
import pytest

from app.commands.evaluate import evaluate, report_text
from app.commands.track import interrupt_ends, track
from app.recording.outputs import Outputs
from core.camera import camera_for
from core.records import FaceState, Frame


class Playing:
    """A source of grey frames."""

    name, size_px, fps = "clip.mp4", (64, 48), 25.0

    def __init__(self, n_frames, promised=0, live=False):
        self.left, self.n_frames, self.live = n_frames, promised, live
        self.given = 0

    def read(self):
        if self.given == self.left:
            return None
        gray = np.zeros((48, 64), np.uint8)
        frame = Frame(np.zeros((48, 64, 3), np.uint8), gray, self.given / 25, self.given)
        self.given += 1
        return frame

    def cut_short(self):
        return self.given < 0.9 * self.n_frames


class EveryThirdLost:
    """A tracker that knows where the face is, except in every third frame."""

    camera = camera_for((64, 48), 80.0)

    def step(self, frame):
        return FaceState(
            frame.time_s, [1, 0, 0, 0], [0, 0, 600], np.zeros(46), np.zeros((2, 2)),
            np.zeros((75, 3)), np.full((75, 2), 20.0 + frame.index), 0.9, "trained",
            frame.index % 3 == 2,
        )  # fmt: skip


class Kept:
    def __init__(self):
        self.rows, self.finished = [], False

    def write(self, frame, state):
        self.rows.append((frame.index, state.lost))

    def finish(self):
        self.finished = True


def follow(steps):
    progress = []
    while True:
        try:
            progress.append(next(steps))
        except StopIteration as end:
            return end.value, progress


def test_every_frame_is_solved_and_written_in_order():
    kept = Kept()
    with Outputs() as outputs:
        outputs.add(kept)
        summary, progress = follow(track(Playing(7, promised=7), EveryThirdLost(), outputs))
    assert kept.finished and kept.rows == [(n, n % 3 == 2) for n in range(7)]
    assert (summary.frames, summary.lost, summary.note) == (7, 2, "")
    assert [(one.done, one.total) for one in progress] == [(n, 7) for n in range(1, 8)]


def test_progress_of_a_source_of_unknown_length_has_no_total():
    _, progress = follow(track(Playing(2), EveryThirdLost(), Outputs()))
    assert [one.total for one in progress] == [0, 0]


def test_a_video_that_ends_early_is_mentioned():
    summary, _ = follow(track(Playing(4, promised=100), EveryThirdLost(), Outputs()))
    assert "may be damaged" in summary.note


def test_only_the_asked_number_of_frames_is_tracked():
    source = Playing(100, promised=100)
    summary, _ = follow(track(source, EveryThirdLost(), Outputs(), most_frames=5))
    assert summary.frames == source.given == 5 and summary.note == ""


@pytest.fixture
def as_in_a_terminal():
    """Python's own answer to Ctrl-C; programs started in the background ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_ends_a_live_recording_with_its_frames(as_in_a_terminal):
    with interrupt_ends(live=True) as stopped:
        steps = track(Playing(100, live=True), EveryThirdLost(), Outputs(), stopped=stopped)
        next(steps)
        signal.raise_signal(signal.SIGINT)
        summary, _ = follow(steps)
    assert summary.frames == 1
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_ctrl_c_breaks_off_a_file(as_in_a_terminal):
    with pytest.raises(KeyboardInterrupt), interrupt_ends(live=False):
        signal.raise_signal(signal.SIGINT)


class OffByOne:
    """An aligner whose landmarks lie 3 px right and 4 px below the tracker's: 5 px away."""

    def __init__(self):
        self.index = -1

    def first(self, rgb):
        self.index += 1
        if self.index == 4:
            return None
        points = np.full((75, 2), 20.0 + self.index) + np.array([0.3, 0.4])
        landmarks = type("Landmarks", (), {"points_px": points})
        return type("Alignment", (), {"landmarks": landmarks})


def test_evaluation_compares_at_640_px_and_counts_lost_frames_as_misses():
    report, _ = follow(evaluate(Playing(6, promised=6), EveryThirdLost(), OffByOne()))
    assert report["compared"] == 5 and report["lost"] == 2
    # 0.5 px of 64 px are 5 px of 640; frames 2 and 5 are lost, frame 4 has no reference.
    assert report["median_rmse_px"] == pytest.approx(5.0)
    assert report["share_under_px"] == {"3": 0.0, "4.5": 0.0, "6": pytest.approx(3 / 5)}
    text = report_text(report)
    assert "6 px    60.0 %" in text and "median 5.00 px" in text
