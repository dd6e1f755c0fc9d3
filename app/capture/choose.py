"""The source that a text of the command line or of a chooser means."""

import re
from pathlib import Path

from app.capture.folder import FolderSource
from app.capture.patient import PatientCamera
from app.capture.source import FrameSource
from app.capture.video import VideoSource
from app.capture.webcam import WebcamSource


def camera_number(text: str) -> int | None:
    """Return the number of the camera that "camera", "camera:1" or "1" means, else None."""
    match = re.fullmatch(r"camera|camera:(\d+)|(\d+)", text)
    if match is None or Path(text).exists():
        return None
    return int(match[1] or match[2] or 0)


def open_source(
    text: str, camera_size_px: tuple[int, int] = (640, 480), patient: bool = False
) -> FrameSource:
    """Open a camera ("camera", "camera:1", "1"), an image folder or a video file.

    Args:
        text: What the user wrote or chose.
        camera_size_px: Size to ask of a camera; files have their own.
        patient: A camera that is lost later is waited for.

    Raises:
        AppError: There is nothing of this name, or it cannot be read.
    """
    number = camera_number(text)
    if number is not None:
        kind = PatientCamera if patient else WebcamSource
        return kind(number, camera_size_px)
    path = Path(text).expanduser()
    return FolderSource(path) if path.is_dir() else VideoSource(path)
