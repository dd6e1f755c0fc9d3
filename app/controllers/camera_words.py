"""What is wrong with a camera, in the words of the setup's pages."""

from app.errors import AppError, CameraBusyError, CameraLostError, NoCameraError
from core.errors import CoreError

GONE = "Unplugged: plug it in again"
AGAIN = "It goes on by itself."


def trouble_text(error: CoreError | AppError, again: bool) -> str:
    """Return what is wrong and what to do.

    Args:
        error: What the source told.
        again: Whether the source is tried again by itself.
    """
    if isinstance(error, CameraLostError) and again:
        return f"The camera {error.name} is gone: plug it in again. {AGAIN}"
    if isinstance(error, NoCameraError) and again:
        return f"The camera is gone: plug it in again. {AGAIN}"
    if isinstance(error, CameraBusyError) and again:
        return (
            f"The camera {error.name} gives no picture: {error.reason}. Close the other program, "
            f"or choose another camera. {AGAIN}"
        )
    hint = AGAIN if again else "Choose it again to go on."
    return f"{_sentence(error)}. {hint}"


def trouble_in_short(error: CoreError | AppError) -> str:
    """Return what is wrong in some words."""
    if isinstance(error, CameraBusyError):
        return f"Gives no picture: {error.reason}"
    if isinstance(error, NoCameraError | CameraLostError):
        return GONE
    return _sentence(error)


def _sentence(error: CoreError | AppError) -> str:
    text = str(error)
    return text[:1].upper() + text[1:]
