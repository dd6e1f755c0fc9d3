"""A camera that may be unplugged: waits until it is back, and goes on.

Reading a device can hang for many seconds, in the driver, when its cable is pulled; opening one
can, too. Both are done in a thread of their own, so that who reads here can always leave at once.
"""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import replace
from queue import Empty, SimpleQueue
from threading import Condition, Thread
from typing import Any

from app.capture.holding import Held
from app.capture.source import ClosedOnExit, FrameSource, fit_to
from app.capture.webcam import CameraEntry, WebcamSource, list_cameras
from app.errors import AppError, CameraLostError, NoCameraError
from core.records import Frame

#: Time between two tries to open a camera that is gone.
RETRY_S = 1.0
#: A camera that gives nothing for so long hangs.
HANGS_S = 2.0
#: How long closing waits for the device to be given back.
CLOSING_S = 0.09
#: Holding a camera's settings takes some dozen frames, at most so long.
HOLDING_S = 10.0

#: Opens a camera; raises AppError where that cannot be. With what `hold` returned before.
OpenCamera = Callable[[CameraEntry, Sequence[Held]], Any]


class PatientCamera(ClosedOnExit):
    """Reads a camera as long as it is wanted; where it is gone, `read` waits for it.

    The same camera is known by its name and path: it may come back under another number.
    """

    live = True

    def __init__(
        self,
        index: int = 0,
        size_px: tuple[int, int] = (640, 480),
        cameras: Callable[[], Sequence[CameraEntry]] = list_cameras,
        open_camera: OpenCamera | None = None,
        retry_s: float = RETRY_S,
    ) -> None:
        """Open a camera, which must be there now.

        Args:
            index: The camera's number.
            size_px: Asked size; the camera may choose another. All frames have the first one's.
            cameras: Lists what is plugged in.
            open_camera: Opens one of those.
            retry_s: Time between two tries.

        Raises:
            NoCameraError: There is no camera of this number.
            CameraBusyError: It gives no picture.
        """

        def webcam(entry: CameraEntry, held: Sequence[Held]) -> WebcamSource:
            return WebcamSource(entry.index, size_px, [entry], held=held)

        self._cameras, self._open = cameras, open_camera or webcam
        self._retry_s = retry_s
        self._held: tuple[Held, ...] = ()
        self._wishes: SimpleQueue[tuple[str, Future[tuple[Held, ...]]]] = SimpleQueue()
        self._entry = _numbered(index, cameras())
        device = self._open(self._entry, self._held)
        self.size_px, self.fps, self.name = device.size_px, device.fps, device.name
        self._ready = Condition()
        self._frame: Frame | None = None
        self._index, self._stopped, self._why = 0, False, ""
        self._seen_s = time.monotonic()
        self._thread = Thread(target=self._serve, args=(device,), name="camera", daemon=True)
        self._thread.start()

    @property
    def trouble(self) -> str:
        """Why there are no pictures now, for people; empty while there are. From any thread."""
        if self._why:
            return self._why
        if time.monotonic() - self._seen_s > HANGS_S:
            return f"The camera {self.name} gives no pictures. Waiting for it."
        return ""

    def read(self) -> Frame | None:
        """Return the newest frame that was not read yet, waiting for it; None once interrupted."""
        with self._ready:
            self._ready.wait_for(lambda: self._frame is not None or self._stopped)
            frame, self._frame = self._frame, None
            return None if self._stopped else frame

    def interrupt(self) -> None:
        """End reading for good, from any thread: `read` returns None at once."""
        with self._ready:
            self._stopped = True
            self._ready.notify_all()

    def hold(self) -> tuple[Held, ...]:
        """Hold exposure, focus and white balance, now and after the camera was lost.

        Takes some dozen frames, which nobody sees. Empty if the camera is gone.
        """
        return self._wish("hold")

    def let_go(self) -> None:
        """Let the camera choose by itself again."""
        self._wish("let_go")

    def close(self) -> None:
        """Give the camera back; one that hangs is given back as soon as it does no longer."""
        self.interrupt()
        self._thread.join(CLOSING_S)

    def _wish(self, name: str) -> tuple[Held, ...]:
        """Let the camera's thread call a method of the camera, and wait for that."""
        answer: Future[tuple[Held, ...]] = Future()
        self._wishes.put((name, answer))
        try:
            return answer.result(HOLDING_S)
        except TimeoutError:
            return ()

    def _grant(self, device: Any) -> None:
        """Do what was wished for; without a camera that is nothing."""
        while True:
            try:
                name, answer = self._wishes.get_nowait()
            except Empty:
                return
            self._held = (getattr(device, name)() or ()) if device is not None else ()
            answer.set_result(self._held)

    def _serve(self, device: FrameSource | None) -> None:
        """Read the camera until nobody wants it; open it again where it was lost."""
        while not self._stopped:
            if device is None:
                device = self._found()
            else:
                self._pass_on(device)
                device.close()
                device = None
        if device is not None:
            device.close()
        self._grant(None)

    def _pass_on(self, device: FrameSource) -> None:
        """Hand on the pictures of a camera until it is lost or nobody wants them."""
        self._why = ""
        while not self._stopped:
            self._grant(device)
            try:
                frame = device.read()
            except CameraLostError:
                frame = None
            if frame is None:
                self._why = _gone(self.name)
                return
            self._put(frame)

    def _put(self, frame: Frame) -> None:
        if frame.gray.shape[::-1] != self.size_px:
            rgb, gray = (fit_to(picture, self.size_px) for picture in (frame.rgb, frame.gray))
            frame = replace(frame, rgb=rgb, gray=gray)
        with self._ready:
            self._frame = replace(frame, index=self._index)
            self._index, self._seen_s = self._index + 1, time.monotonic()
            self._ready.notify_all()

    def _found(self) -> FrameSource | None:
        """Return the camera if it is back, after a pause if it is not."""
        entry = self._listed()
        try:
            if entry is not None:
                device: FrameSource = self._open(entry, self._held)
                self._entry = entry
                return device
            self._why = _gone(self.name)
        except AppError:
            self._why = f"The camera {self.name} is there but gives no picture. Waiting for it."
        self._grant(None)
        with self._ready:
            self._ready.wait_for(lambda: self._stopped, self._retry_s)
        return None

    def _listed(self) -> CameraEntry | None:
        """Return the camera if it is plugged in; where listing itself fails it is not found."""
        try:
            return same_camera(self._entry, self._cameras())
        except Exception:  # noqa: BLE001  whatever a driver throws must not end the waiting
            return None


def same_camera(known: CameraEntry, found: Sequence[CameraEntry]) -> CameraEntry | None:
    """Return the camera of a known one's name, best at its path or number; None if it is gone."""
    same = [entry for entry in found if entry.name == known.name]
    return max(
        same, key=lambda entry: (entry.path == known.path, entry.index == known.index), default=None
    )


def _numbered(index: int, cameras: Sequence[CameraEntry]) -> CameraEntry:
    for entry in cameras:
        if entry.index == index:
            return entry
    raise NoCameraError(index, [f"camera:{entry.index} {entry.name}" for entry in cameras])


def _gone(name: str) -> str:
    return f"The camera {name} is gone. Waiting for it."
