"""What app says when a device, a file or a choice of the user cannot be used."""

from collections.abc import Sequence
from pathlib import Path


class AppError(Exception):
    """Something outside the program cannot be used. The text is meant for the user."""


class NoDisplayError(AppError):
    """A window was asked for where none can be shown."""

    def __init__(self, what: str) -> None:
        self.what = what
        super().__init__(
            f"found no display (neither DISPLAY nor WAYLAND_DISPLAY is set), expected one for "
            f"{what}: run this on a desktop"
        )


class SourceMissingError(AppError):
    """There is no file or folder of this name."""

    def __init__(self, path: Path) -> None:
        self.path = path
        super().__init__(
            f"found no file or folder {path}; it may have been moved or renamed: check the "
            "spelling, or choose a video, a folder of images or a camera"
        )


class SourceUnreadableError(AppError):
    """A video or image file holds no picture that can be decoded."""

    def __init__(self, path: Path, found: str, expected: str) -> None:
        self.path, self.found, self.expected = path, found, expected
        super().__init__(
            f"cannot read {path}: found {found}, expected {expected}; the file may be cut short "
            "or damaged: copy or record it again, or convert it"
        )


class NoImagesError(AppError):
    """A folder holds no image files."""

    def __init__(self, path: Path, suffixes: Sequence[str]) -> None:
        self.path = path
        super().__init__(
            f"found no images in the folder {path}; expected files ending in "
            f"{', '.join(suffixes)}: choose the folder that holds the pictures themselves"
        )


class ImageSizesError(AppError):
    """The setup images are not all of one size."""

    def __init__(self, first: str, size: tuple[int, int], other: str, found: tuple[int, int]):
        self.size, self.found = size, found
        super().__init__(
            f"the setup images differ in size: {first} is {size[0]}x{size[1]}, {other} is "
            f"{found[0]}x{found[1]}; expected one camera at one size: leave the others out"
        )


class NoCameraError(AppError):
    """The asked camera is not there."""

    def __init__(self, asked: int, found: Sequence[str]) -> None:
        self.asked, self.found = asked, tuple(found)
        listed = ", ".join(found) if found else "none"
        super().__init__(
            f"found no camera number {asked} (cameras found: {listed}); plug one in, choose "
            "another number (camera:0, camera:1, ...), or give a video file"
        )


class CameraBusyError(AppError):
    """The camera is there but gives no picture."""

    def __init__(self, name: str, reason: str) -> None:
        self.name, self.reason = name, reason
        super().__init__(
            f"the camera {name} gives no picture: {reason}; close other programs that use it, "
            "or choose another camera"
        )


class CameraLostError(AppError):
    """The camera stopped giving pictures."""

    def __init__(self, name: str, n_frames: int) -> None:
        self.name, self.n_frames = name, n_frames
        super().__init__(
            f"the camera {name} stopped after {n_frames} frames; expected it to stay connected: "
            "plug it in again and start it anew"
        )


class OutputError(AppError):
    """A result cannot be written."""

    def __init__(self, path: Path, reason: str) -> None:
        self.path, self.reason = path, reason
        super().__init__(
            f"cannot write {path}: {reason}; nothing was changed there: choose another place"
        )


class SeveralFacesError(AppError):
    """Setup pictures show more than one person."""

    def __init__(self, where: str, n_faces: int) -> None:
        self.where, self.n_faces = where, n_faces
        super().__init__(
            f"found {n_faces} faces of similar size in {where}, expected one: a profile is made "
            "from one person; leave these pictures out, or crop the others away"
        )


class TooFewPicturesError(AppError):
    """Not enough pictures for a profile."""

    def __init__(self, where: str, found: int, needed: int) -> None:
        self.where, self.found, self.needed = where, found, needed
        super().__init__(
            f"found {found} usable pictures in {where}, expected at least {needed} (60 are best), "
            "each sharp and with the face seen: record a longer video, or add pictures"
        )


class PicturesDeletedError(AppError):
    """A profile has no pictures any more, so no landmarks can be looked at."""

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(
            f"the profile {name} has no pictures: they were deleted and only the trained model was "
            "kept; expected pictures to put landmarks right in. The face is still followed live "
            f"with it; to improve it, take new pictures: facepuppet setup {name}"
        )
