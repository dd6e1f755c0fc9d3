import signal
from types import SimpleNamespace

import numpy as np
import pytest

from app.commands import modes
from app.commands.evaluate import evaluate, report_text
from app.commands.modes import FREE, TRAINED, Way, learn, way_of
from app.commands.track import interrupt_ends, track
from app.main import build_parser, main
from app.models import LEARNING_S
from app.recording.outputs import Outputs
from app.resources import asset
from core.blendshapes import mean_user
from core.camera import camera_for
from core.face_model import load_face_model
from core.free_live import UNKNOWN_CAMERA
from core.mean_face import load_mean_face
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


def asked(*arguments):
    return build_parser().parse_args(["track", *arguments])


def test_without_a_profile_nothing_is_trained_and_with_one_it_is(monkeypatch):
    way = way_of(asked("clip.mp4"))
    assert (way.mode, way.profile, way.focal_px, way.detection) == (FREE, None, None, None)
    monkeypatch.setattr(modes, "profile_folder", lambda name: name)
    monkeypatch.setattr("core.store.load", lambda folder: f"profile {folder}")
    way = way_of(asked("anna", "clip.mp4"))
    assert (way.mode, way.profile) == (TRAINED, "profile anna")
    way = way_of(asked("--mode", "free", "--detection", "5", "anna", "clip.mp4"))
    assert (way.mode, way.profile, way.detection) == (FREE, "profile anna", 5)


class Learning:
    """A tracker that counts what it saw."""

    def __init__(self):
        self.seen, self.resets = 0, 0

    def step(self, frame):
        self.seen += 1

    def reset(self):
        self.resets += 1


class Recorded(Playing):
    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass


@pytest.mark.parametrize("n_frames", [30, 500])
def test_a_face_is_learned_from_the_beginning_of_a_recording(monkeypatch, n_frames):
    monkeypatch.setattr(modes, "open_source", lambda name: Recorded(n_frames))
    tracker = Learning()
    learn(tracker, "clip.mp4")
    assert tracker.seen == min(n_frames, LEARNING_S * 25) and tracker.resets == 1


class Shipped:
    def __init__(self, model):
        mean = load_mean_face(asset("aligner") / "mean_face.npz")
        self.face_model, self.aligner, self.prior = model, SimpleNamespace(mean=mean), None


class Known:
    """What of a profile the training-free mode uses."""

    def __init__(self, model):
        self.camera, self.user = camera_for((400, 300), 390.0), mean_user(model)


def test_the_camera_of_the_free_mode_is_given_or_of_the_profile_or_guessed():
    models = Shipped(load_face_model(asset("face_model.npz")))
    camera = Playing(0, live=True)
    focal_px = {
        name: Way(FREE, profile, given, None).tracker(models, camera, "camera").camera.focal_px
        for name, profile, given in (
            ("given", Known(models.face_model), 77.0),
            ("profile", Known(models.face_model), None),
            ("guessed", None, None),
        )
    }
    assert focal_px == {"given": 77.0, "profile": 390.0, "guessed": UNKNOWN_CAMERA.focal_px}


@pytest.mark.slow
def test_a_real_clip_is_tracked_without_a_profile(clips, tmp_path, capsys):
    out = tmp_path / "free.npz"
    clip = clips / "person_a_2.mp4"
    assert main(["track", str(clip), "--out", str(out), "--frames", "60"]) == 0
    assert "60 frames, 0 without a face" in capsys.readouterr().out
    with np.load(out) as found:
        assert found["mode"] == "free" and not found["lost"].any()
        assert found["expression"].min() >= 0 and found["expression"].max() <= 1
        # 400 px wide; the profile of this person finds 398 px.
        assert found["focal_px"] == pytest.approx(400, rel=0.15)
        assert np.all(found["confidence"] > 0.5)
        moved = np.diff(found["rotation_wxyz"], axis=0)
        assert np.abs(moved).max() < 0.03
