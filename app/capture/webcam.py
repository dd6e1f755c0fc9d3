"""A webcam as a source of frames."""

import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from cv2_enumerate_cameras import enumerate_cameras

from app.capture.holding import Held, hold, hold_again, release
from app.capture.source import ClosedOnExit, frame_from_bgr
from app.errors import CameraBusyError, CameraLostError, NoCameraError
from core.records import U8, Frame

#: Reads that may fail in a row before a camera counts as gone; a few fail after a mode change.
PATIENCE = 10
#: Frames until a picture shows what the camera was told.
SETTLING = 4
#: OpenCV's way to the cameras of each system; its own choice may try slow ones first.
BACKENDS = {"linux": cv2.CAP_V4L2, "win32": cv2.CAP_DSHOW, "darwin": cv2.CAP_AVFOUNDATION}


@dataclass(frozen=True, slots=True)
class CameraEntry:
    """A camera that may be opened.

    Attributes:
        index: OpenCV's number.
        name: For people.
        path: The device file on Linux, else empty.
    """

    index: int
    name: str
    path: str


def list_cameras() -> tuple[CameraEntry, ...]:
    """Return the cameras of this machine, in the order of their numbers."""
    backend = BACKENDS.get(sys.platform, cv2.CAP_ANY)
    entries = {
        found.index: CameraEntry(found.index, found.name, found.path or "")
        for found in enumerate_cameras(backend)
    }
    return tuple(entries[index] for index in sorted(entries))


class WebcamSource(ClosedOnExit):
    """Reads a camera at its own pace; a frame's time is when it arrived."""

    live = True

    def __init__(
        self,
        index: int = 0,
        size_px: tuple[int, int] = (640, 480),
        cameras: Sequence[CameraEntry] | None = None,
        open_device: Callable[[int, int], Any] = cv2.VideoCapture,
        held: Sequence[Held] = (),
    ) -> None:
        """Open a camera and wait for its first picture.

        Args:
            index: The camera's number.
            size_px: Asked size; the camera may choose another.
            cameras: The cameras there are; looked up if not given.
            open_device: Opens (index, backend) like cv2.VideoCapture.
            held: What `hold` returned before, to hold the camera so from the first picture on.

        Raises:
            NoCameraError: There is no camera of this number.
            CameraBusyError: It gives no picture.
        """
        known = list_cameras() if cameras is None else cameras
        entry = next((camera for camera in known if camera.index == index), None)
        if entry is None:
            found = [f"camera:{camera.index} {camera.name}" for camera in known]
            raise NoCameraError(index, found)
        self.name, self._index = entry.name, 0
        self._device = open_device(index, BACKENDS.get(sys.platform, cv2.CAP_ANY))
        self._held: tuple[Held, ...] = tuple(held)
        _ask_for(self._device, size_px)
        hold_again(self._device, self._held)
        first = self._decode()
        if first is None:
            self.close()
            raise CameraBusyError(entry.name, _reason(entry))
        self.size_px: tuple[int, int] = (first.shape[1], first.shape[0])
        fps = self._device.get(cv2.CAP_PROP_FPS)
        self.fps = float(fps) if 1 <= fps <= 1000 else 30.0

    def read(self) -> Frame | None:
        """Return the next frame, waiting for it.

        Raises:
            CameraLostError: The camera gives no more pictures.
        """
        picture = self._decode()
        if picture is None:
            raise CameraLostError(self.name, self._index)
        frame = frame_from_bgr(picture, self.size_px, time.perf_counter(), self._index)
        self._index += 1
        return frame

    def hold(self) -> tuple[Held, ...]:
        """Hold exposure, focus and white balance until the camera is closed, as far as it goes.

        Takes some dozen frames; to be called by who reads.
        """
        self.let_go()
        self._held = hold(self._device, self._level, sys.platform)
        return self._held

    def let_go(self) -> None:
        """Let the camera choose by itself again."""
        release(self._device, self._held)
        self._held = ()

    def close(self) -> None:
        """Give the camera back, as it was."""
        self.let_go()
        self._device.release()

    def _level(self) -> float:
        """Return how bright pictures are some frames from now."""
        pictures = [self._decode() for _ in range(SETTLING)]
        return 0.0 if pictures[-1] is None else float(np.median(pictures[-1]))

    def _decode(self) -> U8 | None:
        for _ in range(PATIENCE):
            found, picture = self._device.read()
            if found and picture is not None:
                return np.asarray(picture, np.uint8)
            if not self._device.isOpened():
                return None
        return None


def _ask_for(device: Any, size_px: tuple[int, int]) -> None:
    """Ask for compressed pictures of this size and no queue of old ones.

    Uncompressed video of most webcams fills the bus and halves the frame rate.
    """
    device.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
    device.set(cv2.CAP_PROP_FRAME_WIDTH, size_px[0])
    device.set(cv2.CAP_PROP_FRAME_HEIGHT, size_px[1])
    device.set(cv2.CAP_PROP_FPS, 30)
    device.set(cv2.CAP_PROP_BUFFERSIZE, 1)


def _reason(entry: CameraEntry) -> str:
    if entry.path.startswith("/dev/") and not os.access(entry.path, os.R_OK | os.W_OK):
        return (
            f"this user may not read {entry.path} (on Debian: sudo usermod -aG video $USER, then "
            "log in again)"
        )
    return "most likely another program is using it"
