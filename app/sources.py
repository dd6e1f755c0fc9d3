"""Every source by the text that names it: cameras, files, and the virtual performer."""

from app.capture.choose import open_source as open_camera_or_file
from app.capture.source import FrameSource
from app.errors import AppError
from app.performer.opening import TAKE_NAMES, Scenario, open_performer

PERFORMER = "performer"


class NoTakeError(AppError):
    """The virtual performer knows no take of this name."""

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(
            f"the virtual performer has no take {name!r}, expected one of "
            f"{', '.join(TAKE_NAMES)}: for example {PERFORMER}:{TAKE_NAMES[0]}"
        )


def open_source(
    text: str, camera_size_px: tuple[int, int] = (640, 480), live: bool = False
) -> FrameSource:
    """Open a camera, an image folder, a video file, or the performer ("performer:talking").

    Args:
        text: What the user wrote or chose.
        camera_size_px: Size to ask of a camera; other sources have their own.
        live: The performer plays by the clock and without end.

    Raises:
        AppError: There is nothing of this name, or it cannot be read.
    """
    name, _, take = text.partition(":")
    if name != PERFORMER:
        return open_camera_or_file(text, camera_size_px)
    scenario = Scenario(take=take) if take else Scenario()
    if scenario.take not in TAKE_NAMES:
        raise NoTakeError(scenario.take)
    return open_performer(scenario, live=live, loop=live)
