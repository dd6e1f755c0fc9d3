"""Every source by the text that names it: cameras, files, and the virtual performer."""

from collections.abc import Sequence

from app.capture.choose import open_source as open_camera_or_file
from app.capture.source import FrameSource
from app.errors import AppError
from app.performer.opening import (
    CONDITION_NAMES,
    PEOPLE,
    TAKE_NAMES,
    Scenario,
    open_performer,
)

PERFORMER = "performer"
#: What the command line says of a source.
SOURCE_HELP = (
    "video file, folder of images, 'camera', 'camera:1', or the virtual performer: "
    f"'{PERFORMER}:TAKE+CONDITION+...@PERSON', all parts optional; takes: "
    f"{', '.join(TAKE_NAMES)}; conditions: {', '.join(CONDITION_NAMES)}; people: "
    f"{', '.join(PEOPLE)}"
)


class NotPerformedError(AppError):
    """The virtual performer knows no take, condition or person of this name."""

    def __init__(self, kind: str, name: str, known: Sequence[str]) -> None:
        self.kind, self.name = kind, name
        super().__init__(
            f"the virtual performer has no {kind} {name!r}, expected one of "
            f"{', '.join(known)}: for example {PERFORMER}:talking+glasses+dim@tomas"
        )


def scenario_of(text: str) -> Scenario:
    """Return what "performer:TAKE+CONDITION+...@PERSON" asks for; every part may be missing.

    Raises:
        NotPerformedError: A name is not known, or a condition is given twice.
    """
    _, _, wish = text.partition(":")
    wish, at, person = wish.partition("@")
    take, *conditions = wish.split("+")
    usual = Scenario()
    found = Scenario(
        take=take or usual.take,
        person=person if at else usual.person,
        conditions=tuple(conditions),
    )
    _check("take", [found.take], TAKE_NAMES)
    _check("condition", conditions, CONDITION_NAMES)
    _check("person", [found.person], PEOPLE)
    return found


def open_source(
    text: str, camera_size_px: tuple[int, int] = (640, 480), live: bool = False
) -> FrameSource:
    """Open a camera, an image folder, a video file, or the performer ("performer:talking").

    Args:
        text: What the user wrote or chose; SOURCE_HELP tells what it may be.
        camera_size_px: Size to ask of a camera; other sources have their own.
        live: The performer plays by the clock and without end; a lost camera is waited for.

    Raises:
        AppError: There is nothing of this name, or it cannot be read.
    """
    if text.partition(":")[0] != PERFORMER:
        return open_camera_or_file(text, camera_size_px, patient=live)
    return open_performer(scenario_of(text), live=live, loop=live)


def _check(kind: str, names: Sequence[str], known: Sequence[str]) -> None:
    for name in names:
        if name not in known:
            raise NotPerformedError(kind, name, known)
        if names.count(name) > 1:
            raise NotPerformedError(kind, f"{name} twice", known)
