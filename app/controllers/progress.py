"""Progress of work in several parts, and how long it will still take."""

from collections.abc import Generator
from dataclasses import replace
from typing import TypeVar

from core.records import Progress

T = TypeVar("T")

#: Steps of the whole work.
STEPS = 1000
#: Before so much time and work has passed an estimate is noise.
LEAST_S, LEAST_SHARE = 3.0, 0.03


def between(
    first: float, last: float, steps: Generator[Progress, None, T]
) -> Generator[Progress, None, T]:
    """Run a part of some work, with its progress as that of the whole, which never goes back.

    Args:
        first: Share of the whole that is done before, in [0, 1].
        last: And after.
        steps: The part.
    """
    reached = first
    while True:
        try:
            inner = next(steps)
        except StopIteration as end:
            return end.value  # type: ignore[no-any-return]
        reached = max(reached, first + (last - first) * inner.done / max(inner.total, 1))
        yield replace(inner, done=round(STEPS * min(reached, last)), total=STEPS)


def remaining_text(share: float, elapsed_s: float) -> str:
    """Return how long work will still take, for people; empty while that cannot be told."""
    if elapsed_s < LEAST_S or share < LEAST_SHARE:
        return ""
    left_s = elapsed_s * (1 - share) / share
    if left_s < 10:
        return "a few seconds left"
    if left_s < 90:
        return f"about {10 * round(left_s / 10)} s left"
    return f"about {round(left_s / 60)} min left"
