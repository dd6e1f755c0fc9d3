"""No command: the live window, or the demo where no window can be shown."""

import argparse
import signal
import sys

from app.commands.display import has_display

NO_DISPLAY = (
    "no display found (neither DISPLAY nor WAYLAND_DISPLAY is set): playing the demo instead; "
    "see also: facepuppet --help\n"
)


def run(args: argparse.Namespace) -> int:
    """Open the window and return its exit code."""
    if not has_display():
        sys.stderr.write(NO_DISPLAY)
        from app.commands.demo import DemoOptions, play

        return play(DemoOptions())
    return open_window(sys.argv[:1])


def open_window(qt_arguments: list[str]) -> int:
    """Show the live window until it is closed; return the exit code."""
    # Qt needs more system libraries than the other commands, which must do without them.
    from PySide6.QtWidgets import QApplication

    from app.controllers.starting import Starting
    from app.views.live_window import LiveWindow

    application = QApplication(qt_arguments)
    application.setApplicationName("facepuppet")
    window = LiveWindow()
    window.show()
    Starting(window)
    # Qt would not notice Ctrl-C; the window's timer lets Python run its handler soon enough.
    before = signal.signal(signal.SIGINT, lambda *_: window.close())
    try:
        return int(application.exec())
    finally:
        signal.signal(signal.SIGINT, before)
