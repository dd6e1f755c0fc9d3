"""What the editor's canvas shows: one record, replaced as a whole."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QImage

from core.landmark_refit import FittedModel


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A picture with its points.

    Attributes:
        name: Of the picture; another name is another picture.
        image: The picture.
        points_px: (P, 2) landmarks, then pupils.
        placed: (P,) True where the user placed the point.
        hidden: (P,) True where the user called it hidden.
        confidence: (P,) in [0, 1].
        names: P names.
        curves: Sequences of indices to join by lines.
        selected: Indices in the hand.
        fitted: The face model to compare with, or None.
    """

    name: str
    image: QImage
    points_px: NDArray[np.float64]
    placed: NDArray[np.bool_]
    hidden: NDArray[np.bool_]
    confidence: NDArray[np.float64]
    names: tuple[str, ...]
    curves: tuple[tuple[int, ...], ...]
    selected: frozenset[int] = field(default_factory=frozenset)
    fitted: FittedModel | None = None
