"""Facts about corrections in place: from the frozen frame to a regressor that takes over."""

import os
import threading
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtTest import QTest

from app import workbook
from app.controllers import correction_tools
from app.controllers.correcting import CorrectingController
from app.controllers.correction_tools import (
    Correction,
    CorrectionWorkshop,
    NoPicturesError,
    Prepared,
    Retrained,
    held_out_text,
    next_name,
    picture_text,
)
from app.controllers.desk import open_desk
from app.controllers.frame_book import FRAME, FrameBook
from app.controllers.player import Performer
from app.priority import step_back, taking_turns
from app.workers.job import Job
from app.workers.live_loop import LiveLoop
from core.draft import Draft
from core.errors import NoFaceError
from core.generations import ProfileUnwritableError
from core.landmark_edit import points_of
from core.landmark_refit import Refitter
from core.landmarks import NAMES
from core.records import Progress
from core.store import load
from tests.app.live_fakes import FakeToolbox, FakeTracker, make_state
from tests.app.test_editor import drag, film, folder  # noqa: F401  fixtures
from tests.app.test_takes import frame
from tests.core.held_out_person import face_model
from tests.core.synthetic_fit import result_of

CORNER = NAMES.index("R_mouth_corner")


class FakeWorkshop:
    """Prepares and keeps at once; trains as long as its gate is closed."""

    def __init__(self, film, toolbox):  # noqa: F811
        self.film, self.toolbox = film, toolbox
        self.kept, self.trained, self.at_once, self.most_at_once = [], [], 0, 0
        self.gate = threading.Event()
        self.error = self.keep_error = None
        self.waiting = 0

    def prepare(self, profile, frame, state):
        yield Progress(0, 1, "Preparing")
        assert threading.current_thread() is not threading.main_thread()
        book = FrameBook(np.full((480, 640, 3), frame.gray[0, 0], np.uint8), self.film.landmarks[1])
        refitter = Refitter(face_model(), self.film.user, self.film.camera)
        return Prepared(profile, book, refitter)

    def keep(self, correction):
        yield Progress(0, 1, "Keeping")
        if self.keep_error is not None:
            raise self.keep_error
        self.kept.append(correction)
        return f"live-{len(self.kept):04d}"

    def train(self, profile):
        self.at_once += 1
        self.most_at_once = max(self.most_at_once, self.at_once)
        try:
            learned = len(self.kept)
            yield Progress(1, 4, "Training the regressor")
            while not self.gate.wait(0.005):
                yield Progress(2, 4, "Training the regressor")
            self.gate.clear()
            if self.error is not None:
                raise self.error
            self.trained.append(learned)
            performer = Performer(FakeTracker(self.toolbox, "trained"), None)
            return Retrained(profile, performer, "In live-0001 it is better.")
        finally:
            self.at_once -= 1

    def unlearned(self, profile):
        return self.waiting


class Desk:
    def __init__(self, qtbot, toolbox, workshop):
        self.qtbot, self.toolbox, self.workshop = qtbot, toolbox, workshop
        self.window, self.controller = open_desk(toolbox)
        qtbot.addWidget(self.window)
        self.correcting = self.controller.findChild(CorrectingController)
        self.correcting._tools = workshop
        self.window.show()
        self.controller.start()

    def until(self, done):
        self.qtbot.waitUntil(done, timeout=10000)

    def live(self):
        self.until(lambda: self.window.status.state.startswith("Tracking"))

    def open_editor(self):
        self.correcting.action.trigger()
        self.until(lambda: self.correcting.editor is not None)
        return self.correcting.editor

    def use(self, shift=(25, -10)):
        """Move a corner of the mouth and use the frame."""
        editor = self.open_editor()
        canvas = editor.canvas
        x, y = canvas.scene.points_px[CORNER]
        # What `drag` needs of an editor's desk.
        spot = canvas.zoom.to_widget(float(x), float(y)).toPoint()
        drag(editor, spot, shift)
        self.qtbot.mouseClick(editor.use_button, Qt.MouseButton.LeftButton)


@pytest.fixture
def open_desk_with(qtbot, film):  # noqa: F811
    desks = []

    def make(profiles=("anna", "bert"), **options):
        toolbox = FakeToolbox(profiles=list(profiles), **options)
        desks.append(Desk(qtbot, toolbox, FakeWorkshop(film, toolbox)))
        return desks[-1]

    yield make
    for desk in desks:
        desk.window.close()
        threads = [*desk.controller.findChildren(LiveLoop), *desk.controller.findChildren(Job)]
        assert not any(thread.isRunning() for thread in threads)


def test_a_wrong_frame_is_put_right_learned_and_used_while_the_live_view_goes_on(open_desk_with):
    desk = open_desk_with()
    desk.live()
    (loop,) = [one for one in desk.controller.findChildren(LiveLoop) if one.isRunning()]
    before = tracker_of(desk)
    desk.use()
    desk.until(lambda: desk.correcting.row.text.startswith("Training"))
    (kept,) = desk.workshop.kept
    moved = np.linalg.norm(points_of(kept.landmarks) - points_of(kept.found), axis=1)
    assert set(np.flatnonzero(moved > 1e-9)) == {CORNER} and kept.landmarks.edited[CORNER]
    assert kept.profile == "anna" and "live-0001" in desk.window.message_bar.text
    assert tracker_of(desk) is before and loop.isRunning()
    desk.workshop.gate.set()
    desk.until(lambda: tracker_of(desk) is not before)
    desk.until(lambda: "In live-0001 it is better." in desk.window.message_bar.text)
    assert loop.isRunning() and desk.toolbox.opened == ["camera:0"]
    assert desk.correcting.row.text == ""
    desk.live()


def test_the_frame_is_frozen_while_the_live_view_moves_on(open_desk_with):
    desk = open_desk_with()
    desk.live()
    editor = desk.open_editor()
    level = editor.canvas.scene.image.pixelColor(5, 5).red()
    numbers = len(desk.toolbox.wishes)
    desk.until(lambda: len(desk.toolbox.wishes) > numbers + 20)
    assert editor.canvas.scene.image.pixelColor(5, 5).red() == level
    assert desk.open_editor() is editor


def test_the_key_opens_the_editor(open_desk_with):
    desk = open_desk_with()
    desk.live()
    desk.window.activateWindow()
    QTest.keyClick(desk.window, Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)
    desk.until(lambda: desk.correcting.editor is not None)
    assert desk.correcting.action in desk.window.menu("Face").actions()


@pytest.mark.parametrize("how", ["cancel", "close"])
def test_a_cancel_leaves_everything_as_it_was(open_desk_with, how):
    desk = open_desk_with()
    desk.live()
    before = tracker_of(desk)
    editor = desk.open_editor()
    if how == "cancel":
        desk.qtbot.mouseClick(editor.cancel_button, Qt.MouseButton.LeftButton)
    else:
        editor.close()
    assert desk.correcting.editor is None
    desk.qtbot.wait(50)
    assert not desk.workshop.kept and not desk.correcting.busy and tracker_of(desk) is before


def test_without_a_profile_the_guided_setup_is_offered(open_desk_with):
    desk = open_desk_with(profiles=())
    desk.toolbox.guided_setup = lambda source: made.append(FakeGuided()) or made[-1]
    made = []
    desk.live()
    desk.correcting.action.trigger()
    assert "need a profile" in desk.window.message_bar.text and desk.correcting.editor is None
    desk.window.message_bar.buttons[0].click()
    desk.until(lambda: len(made) == 1)


def test_without_a_picture_there_is_nothing_to_correct(open_desk_with):
    desk = open_desk_with(cameras=())
    desk.correcting.action.trigger()
    assert "no picture" in desk.window.message_bar.text


def test_corrections_that_come_while_training_are_kept_at_once_and_learned_next(open_desk_with):
    desk = open_desk_with()
    desk.live()
    desk.use()
    desk.until(lambda: desk.correcting.row.text.startswith("Training"))
    for number in (2, 3):
        desk.use()
        desk.until(lambda n=number: len(desk.workshop.kept) == n)
    desk.until(lambda: "after the training" in desk.window.message_bar.text)
    desk.workshop.gate.set()
    desk.until(lambda: desk.workshop.trained == [1])
    desk.until(lambda: desk.workshop.at_once == 1)
    desk.workshop.gate.set()
    desk.until(lambda: desk.workshop.trained == [1, 3])
    desk.until(lambda: not desk.correcting.busy)
    assert desk.workshop.most_at_once == 1


def test_a_stopped_training_keeps_the_corrections(open_desk_with):
    desk = open_desk_with()
    desk.live()
    before = tracker_of(desk)
    desk.use()
    desk.until(lambda: desk.correcting.row.text.startswith("Training"))
    desk.correcting.row.cancel_button.click()
    desk.until(lambda: "stopped" in desk.window.message_bar.text)
    assert len(desk.workshop.kept) == 1 and tracker_of(desk) is before
    desk.use()
    desk.until(lambda: desk.correcting.row.text.startswith("Training"))
    desk.workshop.gate.set()
    desk.until(lambda: desk.workshop.trained == [2])


def test_a_training_that_fails_is_told_and_the_old_regressor_stays(open_desk_with):
    desk = open_desk_with()
    desk.live()
    before = tracker_of(desk)
    desk.workshop.error = ProfileUnwritableError("anna", "no space left")
    desk.use()
    desk.workshop.gate.set()
    desk.until(lambda: "no space left" in desk.window.message_bar.text)
    desk.until(lambda: not desk.correcting.busy)
    assert tracker_of(desk) is before


def test_a_bug_in_the_training_is_told_and_the_live_view_goes_on(open_desk_with, qtbot):
    desk = open_desk_with()
    desk.live()
    before = tracker_of(desk)
    desk.workshop.error = ZeroDivisionError("a bug")
    with qtbot.capture_exceptions() as caught:
        desk.use()
        desk.workshop.gate.set()
        desk.until(lambda: "an error of the program" in desk.window.message_bar.text.lower())
    assert "a bug" in str(caught[0][1]) and tracker_of(desk) is before
    assert len(desk.workshop.kept) == 1
    desk.live()


def test_a_correction_that_cannot_be_kept_is_told_and_nothing_is_trained(open_desk_with):
    desk = open_desk_with()
    desk.live()
    desk.workshop.keep_error = ProfileUnwritableError("anna", "no space left")
    desk.use()
    desk.until(lambda: "no space left" in desk.window.message_bar.text)
    desk.until(lambda: not desk.correcting.busy)
    assert not desk.workshop.trained and desk.workshop.at_once == 0


def test_a_correction_that_could_not_be_kept_is_kept_when_tried_again(open_desk_with):
    desk = open_desk_with()
    desk.live()
    desk.workshop.keep_error = ProfileUnwritableError("anna", "no space left")
    desk.use()
    desk.until(lambda: "1 correction is not kept yet" in desk.window.message_bar.text)
    desk.until(lambda: not desk.correcting.busy)
    desk.workshop.keep_error = None
    [again] = desk.window.message_bar.buttons
    assert again.text() == "Try again"
    again.click()
    desk.until(lambda: desk.correcting.row.text.startswith("Training"))
    assert len(desk.workshop.kept) == 1
    desk.workshop.gate.set()
    desk.until(lambda: "has learned" in desk.window.message_bar.text)


def test_a_correction_that_cannot_be_kept_at_the_end_costs_no_other(open_desk_with, film, capsys):  # noqa: F811
    desk = open_desk_with()
    desk.live()
    rgb, marks = np.zeros((480, 640, 3), np.uint8), film.landmarks[1]
    one, gone, other = (Correction(name, rgb, marks, marks) for name in ("anna", "gone", "bert"))
    keep = desk.workshop.keep

    def keep_or_fail(correction):
        if correction is gone:
            raise ProfileUnwritableError("gone", "no such folder")
        return keep(correction)

    desk.workshop.keep = keep_or_fail
    desk.correcting._failed, desk.correcting._kept = [one], [gone, other]
    desk.window.close()
    assert desk.workshop.kept == [one, other]
    assert "a correction of the profile gone is lost" in capsys.readouterr().err


def test_another_profile_chosen_meanwhile_is_not_replaced(open_desk_with):
    desk = open_desk_with()
    desk.live()
    desk.use()
    desk.until(lambda: desk.correcting.row.text.startswith("Training"))
    desk.window.profile_chosen.emit("bert")
    desk.live()
    desk.qtbot.wait(100)
    before = tracker_of(desk)
    desk.workshop.gate.set()
    desk.until(lambda: "has learned" in desk.window.message_bar.text)
    assert tracker_of(desk) is before and "from now on" not in desk.window.message_bar.text


def test_closing_the_window_ends_a_training_and_keeps_what_was_to_be_kept(open_desk_with):
    desk = open_desk_with()
    desk.live()
    desk.use()
    desk.window.close()
    assert len(desk.workshop.kept) == 1 and not desk.correcting.busy


def test_corrections_left_from_before_are_offered_to_be_learned(open_desk_with):
    desk = open_desk_with()
    desk.workshop.waiting = 2
    desk.live()
    desk.window.profile_chosen.emit("bert")
    desk.until(lambda: "2 corrections are kept but not learned" in desk.window.message_bar.text)
    desk.window.message_bar.buttons[0].click()
    desk.until(lambda: desk.correcting.row.text.startswith("Training"))
    desk.workshop.gate.set()
    desk.until(lambda: "bert has learned" in desk.window.message_bar.text)


# -- the workshop ----------------------------------------------------------------------------


class NoOpener:
    def open_profile(self, key):
        return Performer(None, None)


@pytest.fixture(autouse=True)
def blind(monkeypatch):
    """The aligner sees nothing."""
    monkeypatch.setattr(correction_tools, "_find", lambda rgb: None)


def solved(film, **changes):  # noqa: F811
    state = make_state()
    return replace(state, landmarks_px=film.landmarks[1].points_px, **changes)


def test_a_frame_is_prepared_at_the_size_of_the_profiles_pictures(film, folder):  # noqa: F811
    picture = replace(frame(3), rgb=np.full((960, 1280, 3), 70, np.uint8))
    state = replace(solved(film), landmarks_px=2 * film.landmarks[1].points_px + 0.5)
    workshop = CorrectionWorkshop(NoOpener())
    prepared = result_of(workshop.prepare(str(folder), picture, state))
    book = prepared.book
    assert book.image(FRAME).shape == (480, 640, 3) and np.isnan(book.standard(FRAME)).all()
    assert np.allclose(book.now.points_px[:60], film.landmarks[1].points_px[:60])
    assert not book.outdated
    moved = book.now.moved(CORNER, *(book.now.points_px[CORNER] + [12, 4]))
    refitted = prepared.refitter.refit(moved, book.standard(FRAME))
    assert np.array_equal(refitted.points_px[CORNER], moved.points_px[CORNER])
    near = NAMES.index("R_lipin_corner")
    assert refitted.points_px[near, 0] > book.now.points_px[near, 0]


def test_the_outline_is_where_the_model_has_it_not_where_the_tracker_keeps_points(
    film, folder  # noqa: F811
):  # fmt: skip
    inside = film.landmarks[1].points_px.copy()
    inside[60:] += 0.5 * (inside[:60].mean(axis=0) - inside[60:])
    state = replace(solved(film), landmarks_px=inside)
    workshop = CorrectionWorkshop(NoOpener())
    now = result_of(workshop.prepare(str(folder), wide(frame(3)), state)).book.now
    off = np.linalg.norm(now.points_px[60:] - film.landmarks[1].points_px[60:], axis=1)
    assert np.median(off) < 4 and not now.edited.any()


def test_a_lost_face_is_where_the_aligner_sees_it_or_where_it_was_last(
    film, folder, monkeypatch  # noqa: F811
):  # fmt: skip
    workshop, shown = CorrectionWorkshop(NoOpener()), frame(3)
    monkeypatch.setattr(correction_tools, "_find", lambda rgb: film.landmarks[2])
    lost = replace(solved(film), lost=True)
    book = result_of(workshop.prepare(str(folder), wide(shown), lost)).book
    assert np.allclose(book.now.points_px, film.landmarks[2].points_px)
    monkeypatch.setattr(correction_tools, "_find", lambda rgb: None)
    book = result_of(workshop.prepare(str(folder), wide(shown), lost)).book
    assert np.allclose(book.now.points_px, film.landmarks[1].points_px)
    never = replace(lost, landmarks_px=np.zeros((75, 2)))
    with pytest.raises(NoFaceError, match="this frame"):
        result_of(workshop.prepare(str(folder), wide(shown), never))


def wide(shown):
    return replace(shown, rgb=np.full((480, 640, 3), 70, np.uint8))


def test_a_profile_whose_pictures_were_deleted_says_that_it_cannot_learn(
    film, folder, monkeypatch  # noqa: F811
):  # fmt: skip
    monkeypatch.setattr(correction_tools, "pictures_kept", lambda folder: False)
    with pytest.raises(NoPicturesError, match="guided setup"):
        result_of(CorrectionWorkshop(NoOpener()).prepare(str(folder), frame(3), solved(film)))


def test_a_correction_joins_the_draft_under_the_next_free_name(film, folder):  # noqa: F811
    workshop = CorrectionWorkshop(NoOpener())
    rgb, marks = np.full((480, 640, 3), 90, np.uint8), film.landmarks[1]
    one = Correction(str(folder), rgb, marks.moved(3, 10.0, 20.0), marks)
    assert workshop.unlearned(str(folder)) == 0
    assert [result_of(workshop.keep(one)) for _ in range(2)] == ["live-0001", "live-0002"]
    assert workshop.unlearned(str(folder)) == 2
    book = workbook.Workbook(folder, lambda rgb: None)
    assert np.array_equal(book.image("live-0001"), rgb) and book.outdated
    assert np.array_equal(book.landmarks("live-0001").points_px[3], [10.0, 20.0])
    assert np.array_equal(book.automatic("live-0001").points_px, marks.points_px)
    assert np.isnan(book.standard("live-0001")).all()


def test_a_picture_put_while_a_training_runs_is_not_lost(film, folder, monkeypatch):  # noqa: F811
    workshop = CorrectionWorkshop(NoOpener())
    one = Correction(str(folder), np.zeros((480, 640, 3), np.uint8), *2 * [film.landmarks[1]])
    result_of(workshop.keep(one))
    made = []

    def make_profile(model, pictures, focal_px, rng):
        yield Progress(0, 1, "Training")
        result_of(workshop.keep(one))
        made.append(pictures.images.names)
        old = load(folder)
        return old, workbook.load_setup_images(folder, old)

    monkeypatch.setattr(workbook, "make_profile", make_profile)
    monkeypatch.setattr("app.controllers.correction_tools.errors_px", lambda *_: {"live-0001": 2.0})
    trained = result_of(workshop.train(str(folder)))
    assert "live-0001" in made[0] and "live-0002" not in made[0]
    assert Draft(folder).names() == ["live-0002"]
    assert "In live-0001 the landmarks are 2.0 px off now." in trained.text
    assert picture_text("live-0001", 9.0, 2.0).endswith("2.0 px off now, 9.0 px before.")


def test_names_go_on_after_the_last_one():
    assert next_name(set()) == "live-0001"
    assert next_name({"live-0002", "live-0009", "smile_yaw+0", "live-x"}) == "live-0010"


def test_what_has_changed_is_told_as_far_as_it_is_known():
    after = {"held_out": {"share_under_px": {"2": 0.97, "4": 1.0}}}
    before = {"held_out": {"share_under_px": {"2": 0.9}}}
    assert held_out_text(before, after) == (
        "On pictures kept for testing, 97 % are within 2 px (90 % before)."
    )
    assert held_out_text({}, after) == "" and held_out_text(before, {}) == ""


def test_of_two_trainings_the_second_waits_and_says_so():
    order = []

    def training(name):
        for step in range(2):
            order.append((name, step))
            yield Progress(step, 2, name)

    first, second = (taking_turns(training(name)) for name in ("a", "b"))
    next(first)
    assert next(second).label.startswith("Waiting")
    first.close()
    assert [progress.label for progress in second] == ["b", "b"]
    assert order == [("a", 0), ("b", 0), ("b", 1)]


def test_a_thread_steps_back_alone():
    if not hasattr(os, "setpriority"):
        pytest.skip("this system knows no priority of threads")
    seen = []

    def work():
        seen.append((step_back(3), os.getpriority(os.PRIO_PROCESS, threading.get_native_id())))

    before = os.getpriority(os.PRIO_PROCESS, threading.get_native_id())
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    (told,) = seen
    assert told in ((True, 3), (False, before)) or before > 3
    assert os.getpriority(os.PRIO_PROCESS, threading.get_native_id()) == before


def tracker_of(desk):
    return desk.controller._performing._tracker.tracker


class FakeGuided(QObject):
    finished = Signal(str)

    def show(self):
        pass

    def close(self):
        self.finished.emit("")
