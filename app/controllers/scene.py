"""The avatar's side of the live view: who plays, and pictures of nobody else."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.errors import AppError
from app.painting import Cast, LiveWish, resting
from app.render.look import AvatarLook
from app.render.quality import Drawn
from app.workers.avatar_loop import AvatarLoop, DrawingThread, Painted
from core.records import FaceState, Frame, UserBlendshapes

#: How often it is asked whether a new avatar is made, where no frames come that ask.
ASK_EVERY_MS = 150


class Studio(Protocol):
    """What is needed of the toolbox."""

    def make_render_thread(
        self, done: Callable[[Painted], None], failed: Callable[[AppError], None]
    ) -> DrawingThread:
        """Return the thread that draws avatars."""
        ...


class AvatarScene(QObject):
    """Keeps one render thread, started when first needed, for all that play one after another."""

    painted = Signal(object)  # Painted, of who plays now
    failed = Signal(object)  # AppError: nothing is drawn until the next choice

    def __init__(self, studio: Studio, avatar: str, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._studio, self.avatar = studio, avatar
        self._loop: AvatarLoop | None = None
        self._cast: Cast | None = None
        self._look = AvatarLook()
        self._last: LiveWish | None = None
        self._drawn = Drawn()
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(ASK_EVERY_MS)
        self._timer.timeout.connect(self._on_waited)

    @property
    def plays(self) -> bool:
        """Whether somebody plays."""
        return self._cast is not None

    @property
    def look_now(self) -> AvatarLook:
        """How the pictures are taken."""
        return self._look

    @property
    def drawn(self) -> Drawn:
        """How well the last picture was drawn: what is too slow is drawn smaller for a while."""
        return self._drawn

    def enter(self, user: UserBlendshapes | None, folder: Path | None = None) -> None:
        """Let the chosen avatar play a user, at rest before the first state comes.

        Args:
            user: None without a profile.
            folder: Of the profile.
        """
        self._last = None
        self._play(user, folder)

    def prepare(self) -> None:
        """Have the chosen avatar made while the first source is still being opened."""
        if self._cast is None:
            self._begin().ask(LiveWish(Cast(self.avatar, None), resting(), look=self._look))

    def become(self, user: UserBlendshapes | None, folder: Path | None = None) -> None:
        """Go on as somebody else, or who is better known now."""
        if self._cast is not None:
            self._play(user, folder)

    def leave(self) -> None:
        """Let nobody play."""
        self._cast = None

    def choose(self, avatar: str) -> None:
        """Let another avatar play from now on."""
        self.avatar = avatar
        if self._cast is not None:
            self._play(self._cast.user, self._cast.folder)

    def show(
        self,
        driven: FaceState,
        delivered_s: float,
        frame: Frame | None = None,
        solved: FaceState | None = None,
    ) -> None:
        """Ask for a picture of a state; called in the live thread.

        Args:
            driven: What the avatar does.
            delivered_s: When the frame came, on the clock of time.perf_counter.
            frame: The frame; comes back in the wish of `painted`.
            solved: What the tracker found in it; comes back as well.
        """
        loop, cast = self._loop, self._cast
        if loop is not None and cast is not None:
            self._last = LiveWish(cast, driven, delivered_s, frame, solved, self._look)
            loop.ask(self._last)

    def look(self, look: AvatarLook) -> None:
        """Take the pictures like this from now on, and the last one again at once."""
        self._look = look
        if self._cast is not None:
            self._ask_again(self._cast)

    def stop(self) -> None:
        """End the render thread and wait for that."""
        self._cast = None
        if self._loop is not None:
            self._loop.stop()
            self._loop.deleteLater()
            self._loop = None

    def _play(self, user: UserBlendshapes | None, folder: Path | None) -> None:
        self._cast = Cast(self.avatar, user, folder)
        self._begin()
        self._ask_again(self._cast)

    def _begin(self) -> AvatarLoop:
        """Return the loop, started if there is none."""
        if self._loop is None:
            self._loop = AvatarLoop(self._studio.make_render_thread, self)
            self._loop.posted.connect(self._on_posted)
            self._loop.failed.connect(self._on_failed, Qt.ConnectionType.QueuedConnection)
            self._loop.start()
        return self._loop

    def _ask_again(self, cast: Cast) -> None:
        """Ask for what was last shown, or rest, as it is to look now."""
        last = self._last or LiveWish(cast, resting())
        if self._loop is not None:
            self._loop.ask(replace(last, cast=cast, delivered_s=None, look=self._look))

    def _on_posted(self) -> None:
        painted = self._loop.pictures.take() if self._loop is not None else None
        if painted is not None and painted.wish.cast is self._cast:
            self._drawn = painted.drawn
            if painted.drawn.making:
                self._timer.start()
            else:
                self._timer.stop()
            self.painted.emit(painted)

    def _on_waited(self) -> None:
        """Ask again for who was not made yet."""
        if self._cast is not None:
            self._ask_again(self._cast)

    def _on_failed(self, error: AppError) -> None:
        """Forget the thread, which has ended; the next choice starts another."""
        if self._loop is None:
            return
        self._loop.stop()
        self._loop.deleteLater()
        self._loop = None
        if self._cast is not None:
            self.failed.emit(error)
