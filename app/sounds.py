"""Plays the short sounds of the guided setup, by what each system brings along.

The part of PySide6 that plays sounds is in its add-ons, 200 MB more; a player program is on nearly
every desktop. A sound that cannot be heard is no reason to stop: nothing here fails.
"""

import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from app.resources import asset

#: Player programs with their options, the best first; the file's path comes last.
PLAYERS: dict[str, tuple[tuple[str, ...], ...]] = {
    "darwin": (("afplay",),),
    "linux": (("pw-play",), ("paplay",), ("aplay", "-q")),
}
#: A player that has hung this often is left alone.
MOST_RUNNING = 4


class Speaker:
    """Plays one sound after the other without waiting for any."""

    def __init__(
        self, beep: Callable[[], None], system: str = sys.platform,
        find: Callable[[str], str | None] = shutil.which,
        start: Callable[[Sequence[str]], "subprocess.Popen[bytes]"] | None = None,
    ) -> None:  # fmt: skip
        """Look for a player.

        Args:
            beep: What to do where there is none.
            system: As sys.platform has it.
            find: Returns where a program is.
            start: Starts a program.
        """
        self.muted = False
        self._beep, self._system, self._start = beep, system, start or _started
        known = PLAYERS.get(system, ())
        self._player = next((line for line in known if find(line[0])), ())
        self._running: list[subprocess.Popen[bytes]] = []

    def play(self, name: str) -> None:
        """Play a sound of assets/sounds, if it is to be heard at all."""
        if self.muted:
            return
        path = asset("sounds") / f"{name}.wav"
        if self._system == "win32":
            _play_on_windows(path)
        elif self._player:
            self._play(path)
        else:
            self._beep()

    def close(self) -> None:
        """End what is still being played."""
        for process in self._running:
            with suppress(OSError):
                process.kill()
                process.wait()
        self._running.clear()

    def _play(self, path: Path) -> None:
        self._running = [process for process in self._running if process.poll() is None]
        if len(self._running) >= MOST_RUNNING:
            return
        try:
            self._running.append(self._start([*self._player, str(path)]))
        except OSError:
            self._player = ()
            self._beep()


def _started(line: Sequence[str]) -> "subprocess.Popen[bytes]":
    silent = subprocess.DEVNULL
    return subprocess.Popen(line, stdin=silent, stdout=silent, stderr=silent)


def _play_on_windows(path: Path) -> None:
    # Type checkers know the module on that system only.
    if sys.platform == "win32":
        import winsound

        with suppress(RuntimeError):
            flags = winsound.SND_FILENAME | winsound.SND_ASYNC | winsound.SND_NODEFAULT
            winsound.PlaySound(str(path), flags)
