import sys
import threading
import time

import numpy as np
import pytest
from PySide6.QtCore import QObject, QThread

from app.errors import AppError, CameraLostError
from app.session import STAGES, Session
from app.workers.job import Job
from app.workers.job_slot import JobSlot
from app.workers.latest import Latest
from app.workers.live_loop import LiveLoop
from core.errors import NoFaceError
from core.records import Frame, Progress


class ListSource:
    """A source that plays frames from memory."""

    name, size_px = "list", (4, 4)

    def __init__(self, n_frames, live=True, fps=1000.0, error=None):
        self.live, self.fps, self.error = live, fps, error
        self.frames = [
            Frame(np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4), np.uint8), n / fps, n)
            for n in range(n_frames)
        ]
        self.closed_in = None

    def read(self):
        if self.frames:
            return self.frames.pop(0)
        if self.error:
            raise self.error
        return None

    def close(self):
        self.closed_in = threading.current_thread()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def solve_nothing(frame):
    return None, None


def test_mailbox_keeps_the_newest_and_tells_when_it_was_empty():
    box = Latest()
    assert box.take() is None
    assert [box.put(1), box.put(2)] == [True, False]
    assert box.take() == 2
    assert box.take() is None
    assert box.put(3)


def test_job_returns_what_the_generator_returns(qtbot):
    def steps():
        yield Progress(1, 2, "half")
        return "record"

    job, seen = Job(steps()), []
    job.progressed.connect(seen.append)
    with qtbot.waitSignal(job.returned) as caught, qtbot.waitSignal(job.finished):
        job.start()
    job.wait()
    assert [progress.label for progress in seen] == ["half"]
    assert caught.args == ["record"]


@pytest.mark.parametrize("error", [NoFaceError("a.png"), AppError("no disk")])
def test_job_reports_errors_meant_for_the_user(qtbot, error):
    def steps():
        yield Progress(1, 2, "half")
        raise error

    job = Job(steps())
    with qtbot.waitSignal(job.failed) as caught:
        job.start()
    job.wait()
    assert caught.args == [error]


def test_cancelled_job_takes_no_further_step_and_returns_nothing(qtbot):
    cleaned, returned = [], []
    reached = threading.Event()

    def steps():
        try:
            while True:
                reached.set()
                yield Progress(0, 1, "on and on")
        finally:
            cleaned.append(True)

    job = Job(steps())
    job.returned.connect(returned.append)
    job.start()
    assert reached.wait(5)
    job.cancel()
    assert job.isFinished() and cleaned == [True] and returned == []


def test_a_bug_in_a_job_goes_to_the_except_hook_and_the_job_still_finishes(qtbot, monkeypatch):
    caught = []
    monkeypatch.setattr(sys, "excepthook", lambda kind, *_: caught.append(kind))

    def steps():
        yield Progress(0, 1, "before the bug")
        raise ZeroDivisionError

    job = Job(steps())
    with qtbot.waitSignal(job.finished):
        job.start()
    job.wait()
    assert caught == [ZeroDivisionError]


def test_a_slot_is_free_when_the_next_job_may_come_also_after_a_stop(qtbot):
    ended, threads, parent = [], [], QObject()
    slot = JobSlot(
        parent, lambda: (ended.append(slot.busy), threads.append(QThread.currentThread()))
    )

    def endless():
        while True:
            yield Progress(0, 1, "on and on")

    slot.put(iter_of(1)).start()
    assert slot.busy
    qtbot.waitUntil(lambda: ended == [False])
    slot.stop()
    assert ended == [False]
    slot.put(endless()).start()
    slot.stop()
    assert ended == [False, False] and not slot.busy
    # What the stopped job still sends finds another job in the place, and leaves it there.
    slot.put(endless()).start()
    qtbot.wait(50)
    assert slot.busy
    slot.interrupt()
    qtbot.waitUntil(lambda: ended == [False] * 3)
    assert set(threads) == {parent.thread()}


def iter_of(n_steps):
    yield from (Progress(n, n_steps, "a step") for n in range(n_steps))


def test_live_loop_solves_every_frame_and_closes_the_source_in_its_thread(qtbot):
    source, stepped = ListSource(5), []
    loop = LiveLoop(source, lambda frame: (stepped.append(frame.index), None))
    with qtbot.waitSignal(loop.ended):
        loop.start()
    loop.wait()
    assert stepped == [0, 1, 2, 3, 4]
    assert loop.results.take().frame.index == 4
    assert source.closed_in is not threading.main_thread()


def test_unread_results_give_one_signal_only(qtbot):
    loop, posted = LiveLoop(ListSource(20), solve_nothing), []
    loop.posted.connect(lambda: posted.append(True))
    with qtbot.waitSignal(loop.finished):
        loop.start()
    loop.wait()
    assert posted == [True]


def test_recorded_frames_play_at_their_own_rate(qtbot):
    loop = LiveLoop(ListSource(6, live=False, fps=50.0), solve_nothing)
    started_s = time.perf_counter()
    with qtbot.waitSignal(loop.ended):
        loop.start()
    loop.wait()
    assert time.perf_counter() - started_s >= 5 / 50.0


def test_a_slow_step_leaves_recorded_frames_out(qtbot):
    seen = []

    def slow(frame):
        seen.append(frame.index)
        time.sleep(0.05)
        return None, None

    loop = LiveLoop(ListSource(20, live=False, fps=100.0), slow)
    with qtbot.waitSignal(loop.ended):
        loop.start()
    loop.wait()
    assert 1 < len(seen) <= 8 and seen == sorted(seen)


def test_lost_camera_is_reported_and_the_loop_ends(qtbot):
    error = CameraLostError("cam", 3)
    loop = LiveLoop(ListSource(3, error=error), solve_nothing)
    with qtbot.waitSignal(loop.failed) as caught, qtbot.waitSignal(loop.finished):
        loop.start()
    loop.wait()
    assert caught.args == [error]


def test_stopping_does_not_wait_for_the_end_of_the_source(qtbot):
    source = ListSource(10_000, live=False, fps=100.0)
    loop = LiveLoop(source, solve_nothing)
    with qtbot.waitSignal(loop.posted):
        loop.start()
    loop.stop()
    assert loop.isFinished() and source.closed_in is not None and source.frames


def test_a_new_record_drops_the_later_ones_and_tells_everyone():
    session, heard = Session(), []
    for stage in STAGES[:4]:
        session.put(stage, stage.upper())
    session.changed.connect(lambda stage, record: heard.append((stage, record)))
    session.put("landmarks", "new")
    assert heard == [("landmarks", "new"), ("camera", None), ("fit", None)]
    assert [session.get(stage) for stage in STAGES[:3]] == ["IMAGES", "new", None]


def test_an_unknown_stage_is_a_bug():
    with pytest.raises(ValueError, match=r"tuple\.index"):
        Session().put("no such stage", 1)
