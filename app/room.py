"""Whether pictures can be kept in a folder: asked before the first one is taken."""

from contextlib import suppress
from pathlib import Path

from core.generations import ProfileUnwritableError, reason_of, write_through

TRIAL_NAME = ".room-trial"
#: About what two pictures of 1280x720 take.
TRIAL_BYTES = 2_000_000


def check_room(folder: Path) -> None:
    """Write a file as large as some pictures to a profile's folder, and delete it.

    Args:
        folder: It need not be there; one that was made for the trial goes again.

    Raises:
        ProfileUnwritableError: There is no room, or nothing may be written.
    """
    made = [one for one in (folder, *folder.parents) if not one.exists()]
    trial = folder / TRIAL_NAME
    try:
        write_through(trial, bytes(TRIAL_BYTES))
    except OSError as error:
        raise ProfileUnwritableError(folder, reason_of(error)) from None
    finally:
        with suppress(OSError):
            trial.unlink(missing_ok=True)
        for one in made:
            with suppress(OSError):
                one.rmdir()
