"""The points in the user's hand, and what the hand does to them."""

from collections.abc import Iterable, Mapping

import numpy as np

from core.landmark_edit import (
    N_POINTS,
    as_hidden,
    drag_weights,
    hidden,
    points_of,
    shifted,
    taken_from,
)
from core.records import Landmarks2D


class Hand:
    """Remembers which points are held, and where a drag has them."""

    def __init__(self) -> None:
        self.selected: frozenset[int] = frozenset()
        self.held: Landmarks2D | None = None

    def take(self, selected: frozenset[int]) -> None:
        """Hold these points and no others."""
        self.selected, self.held = selected, None

    def let_go(self) -> None:
        """Hold nothing."""
        self.take(frozenset())

    def with_point(self, index: int, adds: bool) -> frozenset[int]:
        """Return what is held after a click on a point."""
        return self.selected ^ {index} if adds else frozenset({index})

    def with_box(self, indices: Iterable[int], adds: bool) -> frozenset[int]:
        """Return what is held after a box was drawn."""
        return self.selected | frozenset(indices) if adds else frozenset(indices)

    def whole_features(self, groups: Mapping[str, tuple[int, ...]]) -> frozenset[int]:
        """Return the features of which a point is held."""
        touched = [set(group) for group in groups.values() if self.selected & set(group)]
        return self.selected.union(*touched)

    def next_point(self, by: int, n_points: int) -> int:
        """Return the point after or before the one held."""
        if not self.selected:
            return 0 if by > 0 else n_points - 1
        return (min(self.selected) + by) % n_points

    def drag(self, start: Landmarks2D, shift_px: tuple[float, float], soft: bool) -> None:
        """Move the held points.

        Args:
            start: Where the points were when they were taken.
            shift_px: Since then.
            soft: Whether neighbours follow.
        """
        if self.selected:
            weights = drag_weights(points_of(start), self.selected, soft)
            self.held = shifted(start, weights[:, None] * np.array(shift_px))

    def drop(self) -> Landmarks2D | None:
        """Return where the drag left the points, None if there was none."""
        held, self.held = self.held, None
        return held

    def hiding(self, landmarks: Landmarks2D) -> Landmarks2D:
        """Return the landmarks with the held points hidden, or seen again."""
        return as_hidden(landmarks, self.selected)

    def reset(self, landmarks: Landmarks2D, found: Landmarks2D) -> Landmarks2D:
        """Return the landmarks with the held points, or else all, as they were found."""
        return taken_from(landmarks, found, self.selected or range(N_POINTS))

    def told(self, landmarks: Landmarks2D, found: Landmarks2D, names: tuple[str, ...]) -> str:
        """Return what is held, for people.

        Args:
            landmarks: As they are now.
            found: As the program found them; pupils elsewhere are the user's.
            names: Of all points.
        """
        if not self.selected:
            return "Nothing. Click a point, or drag a box around some."
        if len(self.selected) > 1:
            return f"{len(self.selected)} points"
        (index,) = self.selected
        x, y = points_of(landmarks)[index]
        return f"<b>{names[index]}</b><br>at {x:.1f}, {y:.1f}<br>{_state(landmarks, found, index)}"


def _state(landmarks: Landmarks2D, found: Landmarks2D, index: int) -> str:
    if index >= len(landmarks.points_px):
        if not np.array_equal(points_of(landmarks)[index], points_of(found)[index]):
            return "placed by you"
        sure = landmarks.pupil_confidence[index - len(landmarks.points_px)]
        return f"found, {100 * sure:.0f} % sure"
    if hidden(landmarks)[index]:
        return "hidden"
    if landmarks.edited[index]:
        return "placed by you"
    return f"found, {100 * landmarks.confidence[index]:.0f} % sure"
