"""Vertices of the 75 landmarks, their replacements and the contour strips in the head crop."""

from core.landmarks import (
    CONTOUR_HEAD_STRIPS,
    INTERNAL_HEAD_VERTICES,
    REPLACEMENT_HEAD_VERTICES,
)

#: The 60 internal landmarks in the order of core.landmarks.NAMES.
INTERNAL = tuple(int(vertex) for vertex in INTERNAL_HEAD_VERTICES)
#: Points inside the face that stand for the 15 contour landmarks [Cao13, sec. 3].
REPLACEMENTS = tuple(int(vertex) for vertex in REPLACEMENT_HEAD_VERTICES)
#: For each contour landmark the vertices, from the front to the back, that it may slide along.
STRIPS = CONTOUR_HEAD_STRIPS
