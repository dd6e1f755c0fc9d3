"""This frame is wrong: put right in the editor, learned in the background, used without a stop."""

import sys
from collections.abc import Generator

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QVBoxLayout

from app.controllers.correction_tools import (
    Correction,
    CorrectionTools,
    Prepared,
    Retrained,
)
from app.controllers.editing import EditorController
from app.controllers.frame_book import FRAME
from app.controllers.live import LiveController
from app.controllers.profile_maker import ProfileMaker
from app.errors import AppError
from app.views.choice import Choice
from app.views.correction_window import CorrectionWindow
from app.views.job_row import JobRow
from app.views.live_window import LiveWindow
from app.workbook import Workbook
from app.workers.live_loop import LiveResult
from core.errors import CoreError
from core.records import Progress
from core.state_landmarks import confirmed

NO_FRAME = "There is no picture to correct: choose a source first."
TAKE_PLAYS = "A take is played: go back to the live picture to correct one of its frames."
NO_PROFILE = (
    "Corrections need a profile: they are added to its pictures, and it is trained again. Without "
    "one nothing learns from them."
)
SETUP = Choice("correct.setup", "Set up my face…", "The guided setup makes a profile")
LEARN = Choice("correct.learn", "Learn now", "Train the profile in the background")
AGAIN = Choice("correct.again", "Try again", "Keep what could not be kept")
NOT_KEPT = "{number} not kept yet: {error}"
LOST = "facepuppet: a correction of the profile {profile} is lost: {error}"
KEPT = "The frame is kept as {name}. The profile {profile} learns it in the background."
QUEUED = "The frame is kept as {name}, and learned after the training that is going on."
BROKEN = (
    "an error of the program stopped the training; the terminal shows the details. The corrections "
    "are kept, and the profile is as it was"
)
STOPPED = "The training was stopped. The corrections are kept, and learned with the next one."


class CorrectingController(QObject):
    """Runs at most one training; corrections that come meanwhile share the next one."""

    def __init__(
        self, controller: LiveController, window: LiveWindow, tools: CorrectionTools
    ) -> None:
        """Add the entry of the menu and the row of the progress.

        Args:
            controller: Of the live view; parent of this.
            window: Gets both.
            tools: The workshop of the corrections.
        """
        super().__init__(controller)
        self._controller, self._window, self._tools = controller, window, tools
        self._result: LiveResult | None = None
        self.editor: CorrectionWindow | None = None
        self._prepared: Prepared | None = None
        self._preparer, self._keeper = ProfileMaker(self), ProfileMaker(self)
        self._trainer = ProfileMaker(self)
        # To be kept, the first one at once; and profiles that have something to learn.
        self._kept: list[Correction] = []
        # Those that could not be kept, until the user tries again or the window is closed.
        self._failed: list[Correction] = []
        self._untrained: list[str] = []
        # `_told`: whether the user knows how the training ended.
        self._ending, self._told = False, True
        self.row = JobRow()
        self._place_row()
        self.action = QAction("This frame is &wrong…", window)
        self.action.setShortcut(QKeySequence("Ctrl+E"))
        self.action.setToolTip("Put its landmarks right, and let the profile learn it")
        self.action.triggered.connect(self.correct)
        window.menu("Face").addAction(self.action)
        self._connect()

    @property
    def busy(self) -> bool:
        """Whether a frame is prepared or kept, or a profile is trained."""
        return self._preparer.busy or self._keeper.busy or self._trainer.busy

    def correct(self) -> None:
        """Freeze the frame that is shown and open the editor on it."""
        if self.editor is not None:
            self.editor.raise_()
            self.editor.activateWindow()
            return
        result, profile = self._result, self._controller.wanted.profile
        if self._controller.lent:
            self._window.message_bar.tell(TAKE_PLAYS)
        elif result is None:
            self._window.message_bar.tell(NO_FRAME)
        elif not profile:
            self._window.message_bar.offer(NO_PROFILE, [SETUP])
        elif not self._preparer.busy:
            self._preparer.start(self._tools.prepare(profile, result.frame, result.state))

    def _place_row(self) -> None:
        center = self._window.centralWidget()
        layout = None if center is None else center.layout()
        if isinstance(layout, QVBoxLayout):
            layout.insertWidget(layout.indexOf(self._window.job_row) + 1, self.row)

    def _connect(self) -> None:
        controller, window = self._controller, self._window
        controller.solved.connect(self._on_solved)
        controller.source_changed.connect(lambda _: self._on_source_changed())
        controller.profile_changed.connect(self._offer_to_learn)
        controller.ending.connect(self._on_ending)
        window.message_bar.chosen.connect(self._on_chosen)
        self._preparer.made.connect(self._on_prepared)
        self._keeper.made.connect(self._on_kept)
        self._keeper.finished.connect(self._keep_next)
        self._trainer.progressed.connect(self.row.show_progress)
        self._trainer.made.connect(self._on_trained)
        self._trainer.finished.connect(self._on_training_finished)
        self.row.cancel_wanted.connect(self._on_cancel)
        self._trainer.failed.connect(self._on_training_failed)
        self._preparer.failed.connect(self._on_failed)
        self._keeper.failed.connect(self._on_not_kept)

    def _on_solved(self, result: LiveResult) -> None:
        self._result = result

    def _on_source_changed(self) -> None:
        self._result = None

    def _on_chosen(self, key: str) -> None:
        if key == SETUP.key:
            self._window.guided_wanted.emit()
        elif key == LEARN.key and self._controller.wanted.profile:
            self._untrained.append(self._controller.wanted.profile)
            self._train_next()
        elif key == AGAIN.key:
            again, self._failed = self._failed, []
            self._kept += again
            self._keep_next()

    def _offer_to_learn(self, profile: str) -> None:
        """Offer to learn what was kept before the program ended."""
        number = self._tools.unlearned(profile) if profile and not self.busy else 0
        if number:
            noun = "correction is" if number == 1 else "corrections are"
            text = f"{number} {noun} kept but not learned by the profile {profile} yet."
            self._window.message_bar.offer(text, [LEARN])

    def _on_failed(self, error: CoreError | AppError) -> None:
        self._window.message_bar.tell(str(error))

    def _on_not_kept(self, error: CoreError | AppError) -> None:
        number = len(self._failed)
        noun = "1 correction is" if number == 1 else f"{number} corrections are"
        self._window.message_bar.offer(NOT_KEPT.format(number=noun, error=error), [AGAIN])

    # -- the editor ----------------------------------------------------------------------

    def _on_prepared(self, prepared: Prepared) -> None:
        if self._ending:
            return
        window = CorrectionWindow(prepared.profile)
        editor = EditorController(window, prepared.book, lambda: prepared.refitter, _no_training)
        window.use_wanted.connect(self._on_use)
        window.closing.connect(self._on_editor_closed)
        self.editor, self._prepared = window, prepared
        window.show()
        editor.start(FRAME)
        window.canvas.fit_face()
        window.saved_label.setText("Nothing is kept before you use it.")

    def _on_use(self) -> None:
        prepared, window = self._prepared, self.editor
        if prepared is None or window is None:
            return
        book = prepared.book
        self._kept.append(
            Correction(prepared.profile, book.image(FRAME), confirmed(book.now), book.found)
        )
        window.close()
        self._keep_next()

    def _on_editor_closed(self) -> None:
        window, self.editor, self._prepared = self.editor, None, None
        if window is not None:
            window.deleteLater()

    # -- keeping and training ------------------------------------------------------------

    def _keep_next(self) -> None:
        """Keep one correction after the other; they are on the disk before they are learned."""
        if self._kept and not self._keeper.busy and not self._ending:
            self._keeper.start(self._keep_steps(self._kept[0]))
        elif not self._kept:
            self._train_next()

    def _keep_steps(self, one: Correction) -> Generator[Progress, None, tuple[str, str]]:
        try:
            name = yield from self._tools.keep(one)
        except Exception:
            self._kept.remove(one)
            self._failed.append(one)
            raise
        # At once, for the window may be closed before the signal comes.
        self._kept.remove(one)
        return one.profile, name

    def _on_kept(self, kept: tuple[str, str]) -> None:
        profile, name = kept
        if profile not in self._untrained:
            self._untrained.append(profile)
        text = QUEUED if self._trainer.busy else KEPT
        self._window.message_bar.announce(text.format(name=name, profile=profile))

    def _train_next(self) -> None:
        if self._untrained and not self._trainer.busy and not self._ending:
            profile, self._told = self._untrained.pop(0), False
            self.row.begin(f"Learning the corrections of {profile}")
            self._trainer.start(self._tools.train(profile))

    def _on_cancel(self) -> None:
        self._trainer.cancel()
        self._told = True
        self._window.message_bar.announce(STOPPED)

    def _on_trained(self, trained: Retrained) -> None:
        """Let the new regressor take over between two frames, if its person still plays."""
        self._told = True
        used = self._controller.wanted.profile == trained.profile
        if used:
            self._controller.swap_performer(trained.performer)
        text = "The avatar follows it from now on." if used else ""
        self._window.message_bar.announce(
            f"The profile {trained.profile} has learned its corrections. {trained.text} {text}"
        )

    def _on_training_failed(self, error: CoreError | AppError) -> None:
        self._told = True
        self._on_failed(error)

    def _on_training_finished(self) -> None:
        self.row.end()
        if not self._told and not self._ending:
            self._window.message_bar.tell(BROKEN)
        self._told = True
        self._train_next()

    def _on_ending(self) -> None:
        """End everything; what was to be kept is kept before."""
        self._ending = True
        if self.editor is not None:
            self.editor.close()
        self._preparer.stop()
        self._trainer.stop()
        self._keeper.stop()
        for one in (*self._failed, *self._kept):
            self._keep_at_last(one)

    def _keep_at_last(self, one: Correction) -> None:
        """Keep a correction while the window closes; one that cannot be costs no other."""
        try:
            for _ in self._tools.keep(one):
                pass
        except (CoreError, AppError, OSError) as error:
            # No window is there to tell it.
            sys.stderr.write(LOST.format(profile=one.profile, error=error) + "\n")


def _no_training(book: Workbook) -> Generator[Progress, None, object]:
    """Train nothing: the frame is learned with the other pictures."""
    yield from ()
    return ""
