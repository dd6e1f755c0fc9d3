"""The landmark editor at work: wishes of the window become new records, kept at once."""

from collections.abc import Callable, Generator

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from app.controllers.edit_points import Hand
from app.controllers.profile_maker import ProfileMaker
from app.errors import AppError
from app.picture_names import opposite, title_of
from app.views.editor.editor_window import EditorWindow
from app.views.editor.filmstrip import THUMB, Cell
from app.views.editor.scene import Scene
from app.views.picture_view import image_from_array
from app.workbook import Workbook, thumbnail, toned
from core.edit_history import Change, EditHistory
from core.errors import CoreError
from core.landmark_edit import PUPIL_NAMES, hidden, mirrored, placed_like, points_of
from core.landmark_refit import FittedModel, Refitter
from core.landmarks import CURVES, GROUPS, NAMES
from core.records import Landmarks2D, Progress
from core.suspicion import Suspicion, suspicion

__all__ = ["EditorController", "is_placed", "opposite", "title_of"]

OUT_NOTE = "left out: the next training drops it"
POINT_NAMES = (*(name.replace("_", " ") for name in (*NAMES, *PUPIL_NAMES)),)


class EditorController(QObject):
    """Joins the editor's window with a workbook."""

    trained = Signal()  # the profile on the disk is a new one

    def __init__(
        self, window: EditorWindow, book: Workbook, refitter: Callable[[], Refitter],
        train: Callable[[Workbook], Generator[Progress, None, object]],
    ) -> None:  # fmt: skip
        """Show a workbook.

        Args:
            window: To show it in.
            book: The pictures and their landmarks.
            refitter: Makes the refitter of the book's present profile.
            train: The steps of a training; they return what to tell the user.
        """
        super().__init__(window)
        self._window, self._book = window, book
        self._make_refitter, self._train = refitter, train
        self._refitter = refitter()
        self._history, self._hand = EditHistory(), Hand()
        self._order: list[str] = []
        self._suspicions: dict[str, Suspicion] = {}
        self._found: dict[str, Landmarks2D] = {}
        self._name, self._look = "", (0, 0)
        self._maker = ProfileMaker(self)
        self._waiting: list[str] = []
        self._timer = QTimer(self)
        self._connect()

    @property
    def name(self) -> str:
        """The picture that is shown large."""
        return self._name

    @property
    def selected(self) -> frozenset[int]:
        """The points in the hand."""
        return self._hand.selected

    def start(self, name: str = "") -> None:
        """Show all pictures, one of them large: the asked one, or the most suspicious."""
        for one in self._book.names:
            self._judge(one)
        self._order = sorted(self._book.names, key=lambda one: -self._suspicions[one].score)
        self._name = name if name in self._order else self._order[0]
        self._window.strip.show_cells([self._cell(one) for one in self._order], self._name)
        self._waiting = list(self._order)
        self._timer.start(0)
        self._window.saved_label.setText("Every change is kept at once.")
        self._show_picture()
        self._window.canvas.setFocus()

    def stop(self) -> None:
        """End all work; what was changed is already kept."""
        self._timer.stop()
        self._maker.stop()

    # -- showing -------------------------------------------------------------------------

    @property
    def _now(self) -> Landmarks2D:
        """The landmarks of the picture shown, as the hand has them."""
        return self._hand.held or self._book.landmarks(self._name)

    def _judge(self, name: str) -> None:
        marks = self._book.landmarks(name)
        model_px = marks.points_px
        if is_placed(marks):
            model_px = self._refitter.model_points(marks, self._book.standard(name))
        self._suspicions[name] = suspicion(marks, model_px)

    def _cell(self, name: str) -> Cell:
        doubt, marks = self._suspicions[name], self._book.landmarks(name)
        edited = bool(marks.edited.any())
        if name in self._book.taken_out:
            return Cell(name, title_of(name), "out", OUT_NOTE, edited)
        return Cell(name, title_of(name), doubt.level, doubt.note, edited)

    def _show_thumb(self) -> None:
        """Make the thumbnails one by one, between two events."""
        if not self._waiting:
            self._timer.stop()
            return
        name = self._waiting.pop(0)
        small = thumbnail(self._book.image(name), 2 * THUMB.width())
        self._window.strip.show_thumb(name, image_from_array(small))
        self._window.strip.viewport().update()

    def _show_picture(self) -> None:
        self._show_scene()
        doubt, out = self._suspicions[self._name], self._name in self._book.taken_out
        place = f"{self._order.index(self._name) + 1} of {len(self._order)}"
        self._window.panel.picture_label.setText(
            f"<b>{title_of(self._name)}</b> ({place})<br>{OUT_NOTE if out else doubt.note}"
        )
        self._window.strip.show_current(self._name)
        self._show_possible()

    def _show_scene(self) -> None:
        marks, book = self._now, self._book
        sure = np.concatenate([marks.confidence, marks.pupil_confidence])
        self._window.canvas.show_scene(
            Scene(
                self._name,
                image_from_array(toned(book.image(self._name), *self._look)),
                points_of(marks),
                np.concatenate([marks.edited & (marks.confidence > 0), np.zeros(2, bool)]),
                np.concatenate([hidden(marks), np.zeros(2, bool)]),
                sure,
                POINT_NAMES,
                CURVES,
                self._hand.selected,
                self._fitted(marks),
            )
        )
        told = self._hand.told(marks, self._as_found(marks), POINT_NAMES)
        self._window.panel.point_label.setText(told)

    def _as_found(self, marks: Landmarks2D) -> Landmarks2D:
        """Return the points as they were found, as far as what is held needs them."""
        if not any(index >= len(marks.points_px) for index in self._hand.selected):
            return marks
        if self._name not in self._found:
            # To look again takes longer than a drag has time.
            self._found[self._name] = self._book.automatic(self._name)
        return self._found[self._name]

    def _fitted(self, marks: Landmarks2D) -> FittedModel | None:
        if not self._window.panel.model_box.isChecked() or not is_placed(marks):
            return None
        return self._refitter.fitted(marks, self._book.standard(self._name))

    def _show_possible(self) -> None:
        history, window = self._history, self._window
        window.show_deed("undo", bool(history.next_undo), f"Undo {history.next_undo}".strip())
        window.show_deed("redo", bool(history.next_redo), f"Redo {history.next_redo}".strip())
        window.show_deed("previous", self._book.names.index(self._name) > 0)
        out = self._name in self._book.taken_out
        can_go = out or (len(self._book.used_names) > 1 and not self._maker.busy)
        window.show_deed("out", can_go, "Use it after all" if out else "Leave this picture out")
        window.show_deed("mirror", opposite(self._name) in self._book.names)
        window.show_outdated(self._book.outdated and not self._maker.busy)

    # -- wishes --------------------------------------------------------------------------

    def _connect(self) -> None:
        window, canvas = self._window, self._window.canvas
        self._timer.timeout.connect(self._show_thumb)
        window.strip.chosen.connect(self._go)
        window.wished.connect(self._do)
        window.model_wanted.connect(self._show_scene)
        window.panel.look_changed.connect(self._on_look)
        window.retrain_wanted.connect(self._on_retrain)
        window.cancel_wanted.connect(self._maker.cancel)
        window.closing.connect(self.stop)
        canvas.picked.connect(lambda index, adds: self._select(self._hand.with_point(index, adds)))
        canvas.boxed.connect(lambda indices, adds: self._select(self._hand.with_box(indices, adds)))
        canvas.dragged.connect(self._on_dragged)
        canvas.dropped.connect(self._on_dropped)
        canvas.nudged.connect(self._on_nudged)
        self._maker.progressed.connect(window.job_row.show_progress)
        self._maker.made.connect(self._on_trained)
        self._maker.failed.connect(lambda error: window.message_bar.tell(str(error)))
        self._maker.finished.connect(self._on_training_finished)

    def _do(self, key: str) -> None:
        """Do what a Deed of the window says."""
        deeds: dict[str, Callable[[], None]] = {
            "undo": lambda: self._return_to(self._history.undo(), back=True),
            "redo": lambda: self._return_to(self._history.redo(), back=False),
            "back": lambda: self._step(-1),
            "forth": lambda: self._step(1),
            "point_back": lambda: self._step_point(-1),
            "point_forth": lambda: self._step_point(1),
            "all": lambda: self._select(frozenset(range(len(POINT_NAMES)))),
            "none": lambda: self._select(frozenset()),
            "group": lambda: self._select(self._hand.whole_features(GROUPS)),
            "hide": lambda: self._change("hiding", self._hand.hiding(self._now)),
            "reset": self._reset,
            "refit": self._refit,
            "previous": self._copy_previous,
            "similar": self._copy_similar,
            "mirror": self._mirror,
            "out": self._take_out,
        }
        deeds[key]()

    def _go(self, name: str) -> None:
        self._name = name
        self._hand.let_go()
        self._show_picture()

    def _step(self, by: int) -> None:
        place = self._order.index(self._name) + by
        if 0 <= place < len(self._order):
            self._go(self._order[place])

    def _step_point(self, by: int) -> None:
        index = self._hand.next_point(by, len(POINT_NAMES))
        self._select(frozenset({index}))
        self._window.canvas.show_point(index)

    def _select(self, selected: frozenset[int]) -> None:
        self._hand.take(selected)
        self._show_scene()

    def _on_look(self, brightness: int, contrast: int) -> None:
        self._look = (brightness, contrast)
        self._show_scene()

    def _on_dragged(self, x_px: float, y_px: float, soft: bool) -> None:
        self._hand.drag(self._book.landmarks(self._name), (x_px, y_px), soft)
        self._show_scene()

    def _on_dropped(self) -> None:
        held = self._hand.drop()
        if held is not None:
            self._change("move", held)

    def _on_nudged(self, x_px: float, y_px: float) -> None:
        if self._hand.selected:
            self._hand.drag(self._book.landmarks(self._name), (x_px, y_px), soft=False)
            self._on_dropped()

    def _reset(self) -> None:
        found = self._book.automatic(self._name)
        self._change("reset", self._hand.reset(self._now, found))

    def _refit(self) -> None:
        if is_placed(self._now):
            standard = self._book.standard(self._name)
            self._change("refit", self._refitter.refit(self._now, standard))

    def _copy_previous(self) -> None:
        previous = self._book.names[self._book.names.index(self._name) - 1]
        self._copy(self._book.landmarks(previous))

    def _copy_similar(self) -> None:
        others = [name for name in self._book.names if name != self._name]
        best = min(others, key=lambda name: self._unlikeness(name))
        self._copy(self._book.landmarks(best))

    def _mirror(self) -> None:
        other = opposite(self._name)
        if other in self._book.names:
            width = self._book.image(other).shape[1]
            self._copy(mirrored(self._book.landmarks(other), width))

    def _copy(self, landmarks: Landmarks2D) -> None:
        width = self._book.image(self._name).shape[1]
        self._change("copy", placed_like(self._now, landmarks, width))

    def _unlikeness(self, name: str) -> float:
        """Return how little a picture looks like the present one, at the size of a thumbnail."""
        here, there = (thumbnail(self._book.image(one), 40) for one in (self._name, name))
        return float(np.abs(here.astype(float) - there).mean())

    def _take_out(self) -> None:
        """Leave the picture out of the next training, or use it after all."""
        book, name = self._book, self._name
        try:
            book.take_out(name, name not in book.taken_out)
        except (CoreError, AppError) as error:
            self._window.message_bar.tell(str(error))
        self._window.strip.show_cell(self._cell(name))
        self._show_picture()

    # -- changes -------------------------------------------------------------------------

    def _change(self, label: str, after: Landmarks2D) -> None:
        before = self._book.landmarks(self._name)
        self._history.add(Change(self._name, label, before, after))
        self._keep(self._name, after)

    def _return_to(self, change: Change | None, back: bool) -> None:
        if change is not None:
            self._name = change.name
            self._hand.let_go()
            self._keep(change.name, change.before if back else change.after)

    def _keep(self, name: str, landmarks: Landmarks2D) -> None:
        try:
            self._book.correct(name, landmarks)
        except (CoreError, AppError) as error:
            self._window.message_bar.tell(f"this change is not on the disk yet: {error}")
        self._judge(name)
        self._window.strip.show_cell(self._cell(name))
        self._show_picture()

    # -- training ------------------------------------------------------------------------

    def _on_retrain(self) -> None:
        self._window.message_bar.tell("")
        self._window.job_row.begin("Training again")
        self._maker.start(self._train(self._book))
        self._show_possible()

    def _on_trained(self, text: object) -> None:
        self._refitter = self._make_refitter()
        # Pictures that were left out are gone.
        self._order = [name for name in self._order if name in self._book.names]
        if self._name not in self._order:
            self._hand.let_go()
            self._name = self._order[0]
        if len(self._order) < self._window.strip.count():
            self._history = EditHistory()
            self._waiting = list(self._order)
            self._window.strip.show_cells([self._cell(one) for one in self._order], self._name)
            self._timer.start(0)
        for name in self._book.names:
            self._judge(name)
            self._window.strip.show_cell(self._cell(name))
        self._window.message_bar.announce(str(text))
        self.trained.emit()

    def _on_training_finished(self) -> None:
        self._window.job_row.end()
        self._show_picture()


def is_placed(landmarks: Landmarks2D) -> bool:
    """Return whether the points lie anywhere at all; without a face and a prompt all are at 0."""
    return bool(np.ptp(landmarks.points_px) > 1.0)
