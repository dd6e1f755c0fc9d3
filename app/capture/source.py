"""What every source of frames promises, and the few steps that all of them share."""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import Protocol, Self

import cv2
import numpy as np

from core.records import U8, Frame


class FrameSource(Protocol):
    """Gives frames one after the other, all of one size.

    Attributes:
        size_px: (width, height) of every frame.
        fps: Frames per second that are promised.
        name: For people: the camera's or the file's name.
        live: True if frames come at their own pace and unread ones are lost.
    """

    size_px: tuple[int, int]
    fps: float
    name: str
    live: bool

    def read(self) -> Frame | None:
        """Return the next frame, waiting for it if need be; None after the last one."""
        ...

    def close(self) -> None:
        """Give the device or file back. May be called twice."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...


def expected_frames(source: FrameSource) -> int:
    """Return how many frames a source will give, as far as it knows; else 0."""
    return 0 if source.live else int(getattr(source, "n_frames", 0))


class ClosedOnExit(ABC):
    """Makes a source a context manager that closes itself."""

    @abstractmethod
    def close(self) -> None:
        """Give the device or file back."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def frame_from_bgr(bgr: U8, size_px: tuple[int, int], time_s: float, index: int) -> Frame:
    """Return the frame of a picture as OpenCV decodes it, brought to the source's size."""
    fitted = fit_to(bgr, size_px)
    rgb = np.asarray(cv2.cvtColor(fitted, cv2.COLOR_BGR2RGB), np.uint8)
    gray = np.asarray(cv2.cvtColor(fitted, cv2.COLOR_BGR2GRAY), np.uint8)
    return Frame(rgb, gray, time_s, index)


def fit_to(picture: U8, size_px: tuple[int, int]) -> U8:
    """Return the picture at this size: scaled to cover it, then cut equally on both sides.

    Some cameras and files change their size on the way; everything after the source is made
    for one size, and a face must not be stretched.

    Args:
        picture: (H, W, 3).
        size_px: (width, height).
    """
    width, height = size_px
    if picture.shape[1::-1] == size_px:
        return picture
    factor = max(width / picture.shape[1], height / picture.shape[0])
    scaled_size = (
        max(width, round(picture.shape[1] * factor)),
        max(height, round(picture.shape[0] * factor)),
    )
    how = cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR
    scaled = cv2.resize(picture, scaled_size, interpolation=how)
    left, top = (scaled_size[0] - width) // 2, (scaled_size[1] - height) // 2
    return np.ascontiguousarray(scaled[top : top + height, left : left + width])
