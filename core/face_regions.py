"""Where a face is: the detector's boxes, and the turned square that a landmark network looks at.

The geometry is that of MediaPipe's face landmarker, which the networks were trained for.
"""

from dataclasses import dataclass

import numpy as np

from core.records import F32, FloatArray, freeze

DETECTOR_SIZE_PX = 128
#: A region is this much larger than the box around the face.
REGION_SCALE = 1.5
_MIN_SCORE = 0.5
#: Boxes that overlap more than this are one face.
_SAME_FACE_OVERLAP = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class FaceBox:
    """A face that the detector found.

    Attributes:
        corner_px: (2,) left top.
        size_px: (2,) width and height.
        score: In [0, 1].
        keypoints_px: (6, 2) right eye, left eye, nose tip, mouth, right ear, left ear.
    """

    corner_px: FloatArray
    size_px: FloatArray
    score: float
    keypoints_px: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            corner_px=(np.float64, (2,)),
            size_px=(np.float64, (2,)),
            keypoints_px=(np.float64, (6, 2)),
        )

    @property
    def center_px(self) -> FloatArray:
        """Return the middle of the box (2,)."""
        return self.corner_px + 0.5 * self.size_px

    @property
    def area_px(self) -> float:
        """Return the area of the box in square px."""
        return float(np.prod(self.size_px))


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """A square of the picture, turned with the head.

    Attributes:
        center_px: (2,).
        size_px: Side length.
        angle_rad: How far it is turned clockwise in the picture.
    """

    center_px: FloatArray
    size_px: float
    angle_rad: float

    def __post_init__(self) -> None:
        freeze(self, center_px=(np.float64, (2,)))

    def to_picture(self, network_px: int) -> FloatArray:
        """Return the affine map (2, 3) from positions in the network's input to the picture.

        The network counts from the edge of its first pixel, the picture from the middle of its
        own, and so does the network's input as an image: half a pixel apart.

        Args:
            network_px: Side length of the network's input.
        """
        scale = self.size_px / network_px
        cosine, sine = np.cos(self.angle_rad) * scale, np.sin(self.angle_rad) * scale
        turn = np.array([[cosine, -sine], [sine, cosine]])
        offset = self.center_px - turn @ np.full(2, 0.5 * network_px)
        return np.column_stack([turn, offset])


def region_of_box(box: FaceBox) -> Region:
    """Return the region of a detected face, upright along the line of the eyes."""
    angle = _angle_rad(box.keypoints_px[0], box.keypoints_px[1])
    return Region(box.center_px, REGION_SCALE * float(box.size_px.max()), angle)


def region_of_points(points_px: FloatArray, right_px: FloatArray, left_px: FloatArray) -> Region:
    """Return the region around the points of a face.

    Args:
        points_px: (P, 2) points that reach from forehead to chin and from side to side.
        right_px: (2,) outer corner of the right eye.
        left_px: (2,) outer corner of the left eye.
    """
    low, high = points_px.min(axis=0), points_px.max(axis=0)
    size = REGION_SCALE * float((high - low).max())
    return Region(0.5 * (low + high), size, _angle_rad(right_px, left_px))


def anchors() -> F32:
    """Return the centres (896, 2) of the detector's candidate boxes, in parts of its input.

    Two per cell of a 16 x 16 grid, then six per cell of an 8 x 8 grid.
    """
    grids = []
    for cells, repeats in ((16, 2), (8, 6)):
        middles = (np.arange(cells) + 0.5) / cells
        x, y = np.meshgrid(middles, middles)
        grids.append(np.repeat(np.stack([x.ravel(), y.ravel()], axis=1), repeats, axis=0))
    return np.concatenate(grids).astype(np.float32)


def boxes_of(scores: F32, offsets: F32, to_picture: FloatArray) -> list[FaceBox]:
    """Return the faces in the detector's answer, the largest first.

    Args:
        scores: (896,) logits.
        offsets: (896, 16) centre and size of the box and six points, in px of the input, all but
            the size from the candidate's centre.
        to_picture: (2, 3) affine map from the input to the picture, without a turn.
    """
    score = 1 / (1 + np.exp(-np.clip(scores.astype(np.float64), -50, 50)))
    kept = np.flatnonzero(score > _MIN_SCORE)
    centers = anchors()[kept] * DETECTOR_SIZE_PX
    points = np.array(offsets[kept], np.float64).reshape(-1, 8, 2)
    points[:, 0] += centers
    points[:, 2:] += centers[:, None]
    merged = _merge(score[kept], points)
    boxes = [_box(value, entry, to_picture) for value, entry in merged]
    return sorted(boxes, key=lambda box: -box.area_px)


def _box(score: float, points: FloatArray, to_picture: FloatArray) -> FaceBox:
    """Return the box of (8, 2) centre, size and six points in px of the input."""
    scale = to_picture[0, 0]
    placed = points * scale + to_picture[:, 2]
    size = points[1] * scale
    return FaceBox(placed[0] - 0.5 * size, size, score, placed[2:])


def _merge(scores: FloatArray, points: FloatArray) -> list[tuple[float, FloatArray]]:
    """Return the best score and the mean (8, 2), weighted by score, of each overlapping group."""
    low, high = points[:, 0] - 0.5 * points[:, 1], points[:, 0] + 0.5 * points[:, 1]
    left = np.argsort(-scores, kind="stable")
    merged = []
    while len(left):
        best = left[0]
        same = _overlap(low[best], high[best], low[left], high[left]) > _SAME_FACE_OVERLAP
        same[0] = True
        group = left[same]
        merged.append((float(scores[best]), np.average(points[group], 0, scores[group])))
        left = left[~same]
    return merged


def _overlap(low: FloatArray, high: FloatArray, lows: FloatArray, highs: FloatArray) -> FloatArray:
    """Return the intersection over union of a box with others."""
    sides = np.clip(np.minimum(high, highs) - np.maximum(low, lows), 0, None)
    shared = np.prod(sides, axis=1)
    return np.asarray(shared / (np.prod(high - low) + np.prod(highs - lows, axis=1) - shared))


def _angle_rad(right_px: FloatArray, left_px: FloatArray) -> float:
    across = np.asarray(left_px) - np.asarray(right_px)
    return float(np.arctan2(across[1], across[0]))
