"""Facts about takes on the disk: written while they happen, whole whatever happens next."""

import io
import json
import os
import threading
import time
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import cv2
import numpy as np
import pytest

from app.errors import AppError, OutputError
from app.takes import completing
from app.takes import film as film_module
from app.takes import recorder as recorder_module
from app.takes.completing import SILENT_S, STATES, abandoned, recovered, unfinished
from app.takes.exporting import FilmWish, evenly, export_arrays, export_film, export_table
from app.takes.film import FilmReader
from app.takes.library import (
    HEADER,
    TakeError,
    TakeFacts,
    delete,
    name_at,
    name_trouble,
    part_folder,
    renamed,
    takes,
    takes_folder,
    with_trim,
)
from app.takes.recorder import Recorder, RecordingError
from app.takes.rows import ROW, moment_of
from app.takes.solving import SolveWish, solve
from core.arkit import EXPRESSION_NAMES
from core.camera import camera_for
from core.records import Frame
from tests.app.live_fakes import make_state
from tests.core.synthetic_fit import result_of

SIZE = (64, 48)
FPS = 30.0
#: What README promises of every track.
README_ARRAYS = {
    "time_s", "lost", "confidence", "landmarks_px", "shape_mm", "rotation_wxyz", "translation_mm",
    "expression", "expression_names", "arkit", "arkit_names", "focal_px", "size_px", "mode",
}  # fmt: skip
NOON = datetime(2026, 11, 22, 12, 0, 0)


def facts(video=False, **changes):
    base = TakeFacts(
        NOON.isoformat(), "Camera 0", "anna", "nora", "auto", FPS, SIZE, 60.0, video=video
    )
    return replace(base, **changes)


def frame(index, time_s=None):
    """A grey frame whose level tells its number."""
    gray = np.full((SIZE[1], SIZE[0]), level_of(index), np.uint8)
    rgb = np.repeat(gray[..., None], 3, axis=2)
    return Frame(rgb, gray, index / FPS if time_s is None else time_s, index)


def level_of(index):
    """The grey level of a frame, far from those of its neighbours."""
    return 20 + 18 * (index % 12)


def number_of(level):
    """The frame, modulo 12, of a level that went through a video."""
    return round((float(level) - 20 + 3) / 18)


def jaw(share, time_s):
    """A face whose jaw is open by a share, and the same twice as much for the avatar."""
    expression = np.zeros(len(EXPRESSION_NAMES))
    expression[EXPRESSION_NAMES.index("jawOpen")] = share
    solved = replace(make_state(time_s), expression=expression)
    return solved, replace(solved, expression=2 * expression)


class Recording:
    """A recorder with its end."""

    def __init__(self, told=None, **options):
        self.endings = []
        told = facts(True) if told is None else told
        self.part = part_folder(name_at(NOON))
        self.recorder = Recorder(self.part, told, self.endings.append, **options)
        self.recorder.start()

    def take(self, indices, times_s=None):
        for place, index in enumerate(indices):
            shown = frame(index, None if times_s is None else times_s[place])
            self.recorder.take(shown, *jaw(index / 100, shown.time_s))

    def end(self):
        self.recorder.stop()
        self.recorder.wait()
        (ending,) = self.endings
        return ending


def recorded(n_frames=12, video=True, **changes):
    recording = Recording(facts(video, **changes))
    recording.take(range(n_frames))
    return recording.end().take


def test_a_take_holds_what_was_solved_and_driven_and_the_pictures():
    take = recorded()
    rows = take.rows()
    moment = moment_of(rows[7])
    at = EXPRESSION_NAMES.index("jawOpen")
    assert len(rows) == take.facts.frames == 12
    assert moment.solved.expression[at] == pytest.approx(0.07)
    assert moment.driven.expression[at] == pytest.approx(0.14)
    assert (moment.solved.mode, moment.solved.lost, moment.frame_index) == ("trained", False, 7)
    assert np.allclose(moment.solved.landmarks_px, 20.0)
    reader = FilmReader(take.film)
    for n in (moment.video_index, 3, 11, 0):
        assert number_of(reader.picture(n).mean()) == n
    reader.close()
    assert not unfinished()


def test_its_arrays_are_those_of_a_track_and_more():
    take = recorded(3)
    with np.load(take.folder / "track.npz", allow_pickle=False) as arrays:
        assert set(arrays.files) >= README_ARRAYS
        assert arrays["arkit"].shape == (3, 52) and arrays["mode"] == "trained"
        assert arrays["driven_expression"].shape == (3, 46)
        assert arrays["focal_px"] == 60.0 and tuple(arrays["size_px"]) == SIZE


def test_take_json_tells_what_it_is():
    take = recorded()
    told = json.loads((take.folder / HEADER).read_text())
    assert (told["format"], told["schema"], told["name"]) == ("facepuppet take", 1, take.name)
    assert (told["source"], told["profile"], told["avatar"]) == ("Camera 0", "anna", "nora")
    assert told["frames"] == 12 and told["seconds"] == pytest.approx(0.4) and told["trim_s"] is None


def test_frames_left_out_by_the_live_view_leave_a_gap_of_time():
    recording = Recording()
    recording.take([0, 1, 4, 5])
    rows = recording.end().take.rows()
    assert np.allclose(rows["play_s"] * FPS, [0, 1, 4, 5]) and list(rows["frame_index"]) == [
        0, 1, 4, 5
    ]  # fmt: skip


def test_a_pause_takes_no_time_in_the_take():
    recording = Recording()
    recording.take([0, 1])
    recording.recorder.pause(True)
    recording.take(range(2, 40))
    recording.recorder.pause(False)
    recording.take([40, 41])
    rows = recording.end().take.rows()
    assert list(rows["frame_index"]) == [0, 1, 40, 41]
    assert np.allclose(rows["play_s"] * FPS, [0, 1, 2, 3])


def test_a_source_that_begins_again_does_not_turn_the_time_back():
    recording = Recording(facts(False))
    recording.take([5, 6], [5.0, 5.1])
    recording.take([7, 8], [0.0, 0.1])
    assert np.all(np.diff(recording.end().take.rows()["play_s"]) > 0)


def test_without_video_none_is_written():
    take = recorded(video=False)
    assert take.film is None and list(take.rows()["video_index"]) == [-1] * 12
    assert sorted(path.name for path in take.folder.iterdir()) == ["take.json", "track.npz"]


def test_a_recording_without_a_frame_leaves_nothing():
    recording = Recording()
    assert recording.end().take is None
    assert list(takes_folder().iterdir()) == []


def test_a_slow_disk_costs_pictures_but_no_states_and_no_time(monkeypatch):
    gate = threading.Event()
    write = recorder_module.FilmWriter.write
    monkeypatch.setattr(recorder_module, "MOST_WAITING_BYTES", 5 * SIZE[0] * SIZE[1] * 3)
    monkeypatch.setattr(
        recorder_module.FilmWriter, "write", lambda *args: gate.wait(20) and write(*args)
    )
    recording = Recording()
    recording.take(range(20))
    gate.set()
    take = recording.end().take
    kept = list(take.rows()["video_index"])
    assert take.facts.frames == 20 and len(kept) == 20
    assert take.facts.pictures_left_out == kept.count(-1) >= 10
    assert [n for n in kept if n >= 0] == list(range(20 - kept.count(-1)))


def test_on_an_almost_full_disk_the_take_so_far_is_kept(monkeypatch):
    monkeypatch.setattr(recorder_module, "SIGN_EVERY_S", 0.0)
    free = [10**12]
    recording = Recording(facts(True), free_bytes=lambda path: free[0])
    recording.take(range(6))
    wait_for(lambda: rows_on_disk(recording.part) == 6)
    free[0] = 10**6
    recording.take([6])
    recording.recorder.wait()
    (ending,) = recording.endings
    assert isinstance(ending.trouble, RecordingError) and "almost full" in str(ending.trouble)
    assert ending.take is not None and ending.take.facts.frames >= 6
    recording.take([7])


def test_a_disk_that_fails_while_writing_ends_the_recording_with_its_reason(monkeypatch):
    def fail(moment):
        if moment.frame_index == 3:
            raise OSError(28, "No space left on device")
        return row_of(moment)

    row_of = recorder_module.row_of
    monkeypatch.setattr(recorder_module, "row_of", fail)
    recording = Recording(facts(False))
    recording.take(range(6))
    recording.recorder.wait()
    (ending,) = recording.endings
    assert "no space left" in str(ending.trouble) and ending.take.facts.frames == 3


def test_pictures_of_another_size_end_the_recording():
    recording = Recording()
    recording.take([0, 1])
    small = Frame(np.zeros((24, 32, 3), np.uint8), np.zeros((24, 32), np.uint8), 0.1, 2)
    recording.recorder.take(small, *jaw(0, 0.1))
    recording.recorder.wait()
    (ending,) = recording.endings
    assert "32x24" in str(ending.trouble) and ending.take.facts.frames == 2


def test_what_a_crash_left_becomes_a_take_at_the_next_start(tmp_path):
    whole = recorded(40)
    part = part_folder("broken off")
    whole.folder.rename(part)
    film = part / "video.mkv"
    film.write_bytes(film.read_bytes()[:-300])
    rows = whole_rows(part)
    (part / STATES).write_bytes(rows.tobytes()[: -ROW.itemsize // 2])
    (part / "track.npz").unlink()
    assert not abandoned() and unfinished() == [part] and not list(recovered())
    abandon(part)
    (take,) = recovered()
    assert take.name == "broken off" and take.facts.frames == 39 and take.facts.video
    assert not unfinished() and not (take.folder / STATES).exists()
    reader = FilmReader(take.film)
    assert reader.picture(20) is not None and reader.picture(3) is not None
    reader.close()


def test_a_take_that_cannot_be_completed_is_kept_and_told(monkeypatch):
    recording = Recording(facts(False))
    recording.take(range(4))
    wait_for(lambda: rows_on_disk(recording.part) == 4)
    with monkeypatch.context() as patch:
        patch.setattr("app.takes.completing.write_columns", fail_to_write)
        ending = recording.end()
        assert ending.take is None and "cannot be completed now" in str(ending.trouble)
        abandon(recording.part)
        (error,) = recovered()
        assert isinstance(error, TakeError) and "make room" in str(error)
    abandon(recording.part)
    (take,) = recovered()
    assert take.facts.frames == 4


def test_a_take_that_cannot_be_moved_in_place_is_completed_by_the_next_start(monkeypatch):
    part = broken_off()
    with monkeypatch.context() as patch:
        patch.setattr("pathlib.Path.rename", fail_to_write)
        (error,) = recovered()
    assert isinstance(error, TakeError) and (part / STATES).exists()
    abandon(part)
    (take,) = recovered()
    assert len(take.rows()) == take.facts.frames == 12 and not (take.folder / STATES).exists()


def test_a_finished_track_without_its_rows_is_moved_in_place_not_deleted():
    part = part_folder("nearly")
    recorded(5).folder.rename(part)
    abandon(part)
    (take,) = recovered()
    assert take.name == "nearly" and len(take.rows()) == 5 and take.film is not None


def test_a_recording_of_a_newer_program_or_without_facts_is_kept_and_told():
    part = broken_off()
    told = json.loads((part / HEADER).read_text())
    for text in (json.dumps(told | {"schema": 99}), "", None):
        (part / HEADER).unlink() if text is None else (part / HEADER).write_text(text)
        abandon(part)
        (error,) = recovered()
        assert isinstance(error, TakeError) and str(part) in str(error)
        assert rows_on_disk(part) == 12 and (part / "video.mkv").exists()
    empty = part_folder("empty")
    empty.mkdir()
    abandon(empty)
    assert len(list(recovered())) == 1 and unfinished() == [part]


def test_what_is_being_written_is_not_taken_for_abandoned_however_long_it_takes():
    take = recorded()
    steps = solve(take, SolveWish("", "free", "again"), Counting(), lambda state: state)
    next(steps)
    (part,) = unfinished()
    assert abandoned(time.time() + 1000) == [] == list(recovered())
    abandon(part)
    next(steps)
    assert time.time() - (part / HEADER).stat().st_mtime < SILENT_S
    steps.close()
    recording = Recording(facts(False))
    assert unfinished() == [recording.part] and abandoned(time.time() + 1000) == []
    recording.end()
    left = broken_off()
    assert abandoned() == [left]


def test_completing_shows_that_it_lives(monkeypatch):
    part = broken_off()
    write = completing.write_columns

    def write_slowly(path, rows, camera, sign):
        abandon(part)
        write(path, rows, camera, sign)
        assert time.time() - (part / HEADER).stat().st_mtime < SILENT_S

    monkeypatch.setattr(completing, "write_columns", write_slowly)
    (take,) = recovered()
    assert take.facts.frames == 12


def test_a_video_is_not_mended_on_a_full_disk(monkeypatch):
    part = broken_off()
    film, before = part / "video.mkv", (part / "video.mkv").read_bytes()
    no_room = type("Usage", (), {"free": 10**6})()
    with monkeypatch.context() as patch:
        patch.setattr(film_module.shutil, "disk_usage", lambda path: no_room)
        with pytest.raises(OSError, match="space"):
            film_module.mend(film)
    assert film.read_bytes() == before
    write = film_module.FilmWriter.write

    def write_until_full(self, rgb):
        # As OpenCV does: what finds no place is left out without a word.
        if self.n_frames < 7:
            return write(self, rgb)
        self.n_frames += 1
        return self.n_frames - 1

    with monkeypatch.context() as patch:
        patch.setattr(film_module.FilmWriter, "write", write_until_full)
        with pytest.raises(OSError, match="space"):
            film_module.mend(film)
    assert film.read_bytes() == before and not list(part.glob(".mended*"))
    assert film_module.mend(film) == 12 and not list(part.glob(".mended*"))


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
@pytest.mark.parametrize("place", ["write", "close"])
def test_an_error_of_the_program_ends_the_recording_too(monkeypatch, place):
    def fail(*_):
        raise cv2.error("broken")

    monkeypatch.setattr(recorder_module.FilmWriter, place, fail)
    recording = Recording()
    recording.take([0])
    recording.recorder.stop()
    recording.recorder.wait()
    (ending,) = recording.endings
    assert "error of the program" in str(ending.trouble)
    abandon(recording.part) if recording.part.exists() else None
    assert len(takes() + list(recovered())) == (1 if place == "close" else 0)


def test_takes_are_listed_the_newest_first_and_what_is_none_is_left_out():
    first = renamed(recorded(), "first")
    renamed(recorded(made="2026-11-23T08:00:00"), "second")
    (takes_folder() / "strange").mkdir()
    (takes_folder() / "file").write_text("")
    newer = takes_folder() / "newer"
    newer.mkdir()
    (newer / "track.npz").write_text("")
    (newer / HEADER).write_text(json.dumps({"format": "facepuppet take", "schema": 2}))
    assert [take.name for take in takes()] == ["second", "first"]
    assert first.n_bytes > 1000


def test_a_take_is_renamed_trimmed_and_deleted():
    take = with_trim(recorded(), (0.1, 0.3))
    take = renamed(take, "my best one (2)")
    (again,) = takes()
    assert again.range_s == (0.1, 0.3) and again.facts == take.facts
    assert json.loads((again.folder / HEADER).read_text())["name"] == "my best one (2)"
    other = recorded()
    with pytest.raises(TakeError, match="already"):
        renamed(other, "my best one (2)")
    with pytest.raises(TakeError, match="no name for a take"):
        renamed(other, "../up")
    delete(again)
    assert [one.name for one in takes()] == [other.name]


@pytest.mark.parametrize("name", ["", ".hidden", "a/b", "end ", "a\\b", "..", "con?"])
def test_names_that_are_no_folder_are_refused(name):
    assert name_trouble(name)


def test_two_takes_of_one_second_get_two_names():
    assert recorded().name != recorded().name


def test_a_damaged_take_says_so():
    take = recorded()
    (take.folder / "track.npz").write_bytes(b"nonsense")
    with pytest.raises(TakeError, match="damaged"):
        take.rows()


@pytest.mark.parametrize("call", ["write_text", "replace"])
def test_what_cannot_be_kept_of_a_take_is_an_error_that_leaves_it_as_it_was(monkeypatch, call):
    take = recorded()
    before = sorted(take.folder.rglob("*")), (take.folder / HEADER).read_text()
    place = "os.replace" if call == "replace" else "pathlib.Path.write_text"
    with monkeypatch.context() as patch:
        patch.setattr(place, fail_to_write)
        with pytest.raises(OutputError, match="no space"):
            with_trim(take, (0.1, 0.2))
        with pytest.raises(TakeError, match="cannot rename"):
            renamed(take, "other")
    assert before == (sorted(take.folder.rglob("*")), (take.folder / HEADER).read_text())
    assert [one.name for one in takes()] == [take.name]


def test_a_take_damaged_anywhere_says_so_or_is_read():
    take = recorded(6, video=False)
    path, rng = take.folder / "track.npz", np.random.default_rng(7)
    whole, said = path.read_bytes(), 0
    for number in range(400):
        bad = bytearray(whole)
        # The list of what is in the archive is at its end.
        first = 0 if number % 2 else len(whole) - 3000
        for at in rng.integers(first, len(whole), 4):
            bad[at] = rng.integers(256)
        path.write_bytes(bad if number % 8 else bad[: rng.integers(len(bad))])
        try:
            take.rows()
        except TakeError as error:
            assert "damaged" in str(error)
            said += 1
    assert said > 200


def test_a_film_that_cannot_be_begun_names_the_file_and_leaves_nothing(tmp_path, monkeypatch):
    take, closed = recorded(), []
    close = FilmReader.close
    monkeypatch.setattr(FilmReader, "close", lambda self: (closed.append(1), close(self)))
    monkeypatch.setattr(film_module.cv2, "VideoWriter", Shut)
    with pytest.raises(TakeError) as told:
        result_of(export_film(take, tmp_path / "a.mp4", FilmWish(SIZE), lambda *_: None))
    assert str(tmp_path / "a.mp4") in str(told.value) and "Matroska" not in str(told.value)
    assert not list(tmp_path.glob(".a*")) and closed == [1]


def test_exported_arrays_are_those_between_the_trim_marks(tmp_path):
    take = with_trim(recorded(), (0.1, 0.2))
    path = result_of(export_arrays(take, tmp_path / "a.npz"))
    with np.load(path, allow_pickle=False) as arrays:
        assert list(arrays["frame_index"]) == [3, 4, 5, 6]
        assert set(arrays.files) >= README_ARRAYS


@pytest.mark.parametrize("driven", [True, False])
def test_an_exported_table_tells_what_was_asked_for_from_time_zero(tmp_path, driven):
    take = with_trim(recorded(), (0.1, 0.2))
    path = result_of(export_table(take, tmp_path / "a.csv", driven))
    lines = path.read_text().splitlines()
    header, first, last = (line.split(",") for line in (lines[0], lines[1], lines[-1]))
    assert float(first[header.index("time_s")]) == 0.0
    assert float(last[header.index("time_s")]) == pytest.approx(0.1)
    share = float(first[header.index("jawOpen")])
    assert share == pytest.approx(0.06 if driven else 0.03)


@pytest.mark.parametrize("shut", [True, False])
def test_a_table_on_a_full_disk_is_an_error_that_leaves_what_was_there(tmp_path, monkeypatch, shut):
    take, path = recorded(), tmp_path / "a.csv"
    path.write_text("old")
    really_open = Path.open
    monkeypatch.setattr(
        Path,
        "open",
        lambda self, mode="r", **more: (
            FullFile() if mode == "w" else really_open(self, mode, **more)
        ),
    )
    steps = export_table(take, path, driven=True)
    if shut:
        with pytest.raises(AppError, match="no space"):
            result_of(steps)
    else:
        next(steps)
        steps.close()
    monkeypatch.undo()
    assert path.read_text() == "old" and not list(tmp_path.glob(".a*"))


def test_an_exported_film_keeps_the_time_although_frames_are_missing(tmp_path):
    recording = Recording()
    recording.take([0, 1, 2, 9, 10])
    take = recording.end().take

    def draw(moment, frame):
        assert number_of(frame.gray.mean()) == moment.frame_index
        return np.full((48, 64, 4), level_of(moment.frame_index), np.uint8)

    wish = FilmWish(SIZE, FPS, beside=True)
    path = result_of(export_film(take, tmp_path / "a.mp4", wish, draw))
    levels = film_levels(path, np.s_[:, 64:])
    assert [number_of(level) for level in levels] == [0, 1, 2, 2, 2, 2, 2, 2, 2, 9, 10]
    beside = film_levels(path, np.s_[:, :64])
    assert np.allclose(beside, levels, atol=6)


def test_a_cancelled_export_leaves_what_was_there(tmp_path):
    take = recorded()
    (tmp_path / "a.mp4").write_text("old")
    picture = np.zeros((48, 64, 4), np.uint8)
    steps = export_film(take, tmp_path / "a.mp4", FilmWish(SIZE), lambda *_: picture)
    next(steps)
    steps.close()
    assert (tmp_path / "a.mp4").read_text() == "old" and len(list(tmp_path.glob("*.mp4"))) == 1
    assert not list(tmp_path.glob(".a*"))


def test_what_cannot_be_written_is_told(tmp_path):
    take = recorded()
    (tmp_path / "file").write_text("")
    for steps in (
        export_arrays(take, tmp_path / "file" / "a.npz"),
        export_table(take, tmp_path / "file" / "a.csv", driven=True),
        export_film(take, tmp_path / "file" / "a.mp4", FilmWish(SIZE), lambda *_: None),
    ):
        with pytest.raises(OutputError):
            result_of(steps)


def test_trim_marks_with_nothing_between_are_told(tmp_path):
    take = with_trim(recorded(), (5.0, 5.0))
    with pytest.raises(TakeError, match="move them"):
        result_of(export_arrays(take, tmp_path / "a.npz"))


def test_ticks_show_the_newest_frame_that_has_come():
    assert evenly(np.array([0.0, 0.033, 0.066, 0.2]), 30.0) == [0, 1, 2, 2, 2, 2, 3]
    assert evenly(np.array([2.0]), 30.0) == [0]


class Counting:
    """Opens the jaw by the level of the picture."""

    camera = camera_for(SIZE, 77.0)

    def __init__(self):
        self.seen = []

    def step(self, frame):
        self.seen.append((frame.index, frame.time_s))
        return replace(jaw(frame.gray.mean() / 1000, frame.time_s)[0], mode="free")


def test_a_take_is_solved_again_from_its_video_into_another_take():
    take = with_trim(recorded(), (0.1, 0.2))
    tracker = Counting()
    wish = SolveWish("bert", "free", "again")
    made = result_of(solve(take, wish, tracker, lambda state: jaw(1.0, state.time_s)[0]))
    rows, before = made.rows(), take.rows()
    at = EXPRESSION_NAMES.index("jawOpen")
    assert (made.name, made.facts.profile, made.facts.solved_from) == ("again", "bert", take.name)
    assert (
        made.range_s == take.range_s and made.facts.focal_px == 77.0 and made.facts.mode == "free"
    )
    levels = [level_of(index) for index in range(12)]
    assert np.allclose(1000 * rows["expression"][:, at], levels, atol=6)
    assert np.allclose(rows["driven_expression"][:, at], 1.0)
    assert np.array_equal(rows["time_s"], before["time_s"])
    assert np.array_equal(rows["play_s"], before["play_s"])
    assert [index for index, _ in tracker.seen] == list(range(12))
    assert take.rows()["expression"][3, at] == pytest.approx(0.03)
    delete(take)
    assert FilmReader(made.film).picture(5) is not None


def test_solving_that_is_cancelled_or_impossible_leaves_nothing():
    take = recorded()
    steps = solve(take, SolveWish("", "free", "again"), Counting(), lambda state: state)
    for _ in range(4):
        next(steps)
    steps.close()
    assert [one.name for one in takes()] == [take.name] and not unfinished()
    without = recorded(video=False)
    with pytest.raises(TakeError, match="has no video"):
        result_of(solve(without, SolveWish("", "free", "x"), Counting(), lambda state: state))


def test_recording_where_nothing_can_be_written_is_an_error(home):
    home.mkdir()
    (home / "takes").write_text("")
    with pytest.raises((OSError, AppError)):
        Recording()


class FullFile(io.StringIO):
    """A file that finds no room when it is closed, for the first time."""

    def close(self):
        if not self.closed:
            super().close()
            fail_to_write()


class Shut:
    """A video that cannot be written."""

    fourcc = cv2.VideoWriter.fourcc

    def __init__(self, *_):
        pass

    def isOpened(self):
        return False


def abandon(part):
    """Let a recording have been silent for long."""
    old = time.time() - SILENT_S - 1
    os.utime(part / HEADER if (part / HEADER).exists() else part, (old, old))


def broken_off(name="broken off", n_frames=12):
    """Return the folder of a recording that a crash ended."""
    part = part_folder(name)
    recorded(n_frames).folder.rename(part)
    (part / STATES).write_bytes(whole_rows(part).tobytes())
    (part / "track.npz").unlink()
    abandon(part)
    return part


def whole_rows(part):
    from app.takes.rows import read_columns

    return read_columns(part / "track.npz")


def rows_on_disk(part):
    path = part / STATES
    return path.stat().st_size // ROW.itemsize if path.exists() else 0


def wait_for(done, seconds=10.0):
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end
        time.sleep(0.01)


def fail_to_write(*_, **__):
    raise OSError(28, "No space left on device")


def film_levels(path, region):
    video, levels = cv2.VideoCapture(str(path)), []
    while (read := video.read())[0]:
        levels.append(float(read[1][region].mean()))
    return levels
