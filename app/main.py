"""The command line, and what of the rest is started by it."""

import argparse
import os
import re
import sys
from collections.abc import Sequence

from app.errors import AppError
from core.errors import CoreError

#: Exit code for input that cannot be used, as argparse has it for the command line itself.
BAD_INPUT = 2
INTERRUPTED = 130

DEBIAN_LINE = (
    "sudo apt-get install libglib2.0-0 libgl1 libegl1 libdbus-1-3 libfontconfig1 libxkbcommon0 "
    "libxkbcommon-x11-0 libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-shape0 "
    "libwayland-cursor0 libwayland-egl1"
)


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line.

    Raises:
        ImportError: This machine lacks a system library that a command needs.
    """
    from app.commands import bench, demo, edit, evaluate, setup, study, track, window

    parser = argparse.ArgumentParser(
        prog="facepuppet",
        description="Puppeteer a 3D avatar with your own face. Without a command the window opens.",
    )
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    for command in (setup, edit, track, demo, evaluate, study, bench):
        command.add_parser(commands)
    parser.set_defaults(run=window.run)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run facepuppet; return the exit code."""
    given = sys.argv[1:] if arguments is None else arguments
    try:
        if not given:
            return _open_window()
        args = build_parser().parse_args(given)
        return int(args.run(args))
    except (CoreError, AppError) as error:
        sys.stderr.write(f"facepuppet: {error}\n")
        return BAD_INPUT
    except ImportError as error:
        library = missing_library(error)
        if library is None:
            raise
        sys.stderr.write(
            f"facepuppet: this machine lacks the system library {library}; on Debian and Ubuntu "
            f"run\n  {DEBIAN_LINE}\n"
        )
        return BAD_INPUT
    except KeyboardInterrupt:
        sys.stderr.write("facepuppet: stopped\n")
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of our output has gone, as `head` does; nobody is left to be told.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        sys.stderr.write(f"facepuppet: {where}{error.strerror or error}\n")
        return BAD_INPUT


def _open_window() -> int:
    """Open the window without loading all other commands first; return the exit code."""
    from app.commands import window

    return window.run(argparse.Namespace())


def missing_library(error: ImportError) -> str | None:
    """Return the system library whose absence an import error reports, None if it is another."""
    match = re.match(r"(lib[\w.+-]+\.so[\w.]*): cannot open shared object file", str(error))
    return match[1] if match else None


if __name__ == "__main__":
    sys.exit(main())
