"""Whether there is a screen to show a window on."""

import os
import sys


def has_display() -> bool:
    """Return whether a window can be shown; without a display Qt would abort the program."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
