"""Which webcam picture to show: the one that the shown avatar's pose was solved from."""

from core.records import Frame

#: Frames that the avatar may be behind before the webcam picture stops waiting for it.
PATIENCE_FRAMES = 12


class DelayMatch:
    """Decides, for each frame solved and each avatar picture painted, what is shown.

    As long as the avatar keeps up, frames are shown when their avatar picture comes. Where it does
    not - hidden, being made, or drawn too slowly - they are shown at once; never does an older one
    follow a newer one.
    """

    def __init__(self) -> None:
        self.waits = True
        self.reset()

    def reset(self) -> None:
        """Forget the past, for another source."""
        self._shown, self._painted = -1, -1

    def on_solved(self, frame: Frame) -> bool:
        """Return whether to show a frame as soon as it is solved."""
        if self.waits and frame.index - self._painted <= PATIENCE_FRAMES and self._painted >= 0:
            return False
        return self._show(frame)

    def on_painted(self, frame: Frame) -> bool:
        """Return whether to show a frame now that its avatar picture is there."""
        self._painted = max(self._painted, frame.index)
        return self.waits and self._show(frame)

    def _show(self, frame: Frame) -> bool:
        newer = frame.index > self._shown
        self._shown = max(self._shown, frame.index)
        return newer
