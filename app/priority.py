"""Lets work in the background step back behind what a user sees moving."""

import os
import sys
import threading
from collections.abc import Generator
from typing import TypeVar

from core.records import Progress

T = TypeVar("T")

#: Held by the one who trains: numba's usual threading layer ends the process where two threads of
#: ours enter parallel code at once.
_TURN = threading.Lock()
_ASK_EVERY_S = 0.2

#: Steps of niceness; each gives about 10 % less of a busy processor.
STEPS_BACK = 10


def step_back(by: int = STEPS_BACK) -> bool:
    """Lower the priority of the calling thread and of those it starts; return whether it worked.

    Only Linux knows a niceness per thread. Elsewhere nothing is changed: Qt can lower the
    priority of its own threads there.
    """
    if not sys.platform.startswith("linux"):
        return False
    try:
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), by)
    except OSError:
        return False
    return True


def stepping_back(steps: Generator[Progress, None, T]) -> Generator[Progress, None, T]:
    """Run steps in a thread that steps back first."""
    step_back()
    return (yield from steps)


def taking_turns(steps: Generator[Progress, None, T]) -> Generator[Progress, None, T]:
    """Run the steps of a training when no other one runs; all that train must be wrapped so."""
    while not _TURN.acquire(timeout=_ASK_EVERY_S):
        yield Progress(0, 1, "Waiting for another training to end")
    try:
        return (yield from steps)
    finally:
        _TURN.release()
