"""The generic aligner: face detector and 478-point network, for anybody's face.

The networks and the way they are chained are those of MediaPipe's face landmarker; OpenCV runs
them. It needs no setup and remembers nothing: what it knows of the frame before is an argument.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from core.aligner_bias import AlignerBias
from core.arkit import ARKIT_NAMES
from core.face_regions import (
    DETECTOR_SIZE_PX,
    REGION_SCALE,
    FaceBox,
    Region,
    boxes_of,
    region_of_box,
    region_of_points,
)
from core.landmark_confidence import confidences, inside, visibility
from core.landmarks import MESH478, N_INTERNAL, N_LANDMARKS, PUPILS478
from core.mean_face import N_SURFACE, MeanFace, head_pose, load_mean_face
from core.outline import outline, outline_lines
from core.records import F32, U8, FloatArray, Landmarks2D, freeze

LANDMARK_SIZE_PX = 256
N_MESH = 478
#: Below this the network says that there is no face in the region.
MIN_PRESENCE = 0.5
#: After a loss a face is the same one if it is not further away than this many face widths.
SAME_FACE_REACH = 1.0
#: A region smaller than this shows nothing, one this many pictures large has run away.
_MIN_REGION_PX = 8.0
_MAX_REGION_PICTURES = 8.0
_OUTER_EYE_CORNERS = (33, 263)

#: The points that the weights network reads.
_WEIGHT_POINTS = (
    0, 1, 4, 5, 6, 7, 8, 10, 13, 14, 17, 21, 33, 37, 39, 40, 46, 52, 53, 54, 55, 58, 61, 63, 65,
    66, 67, 70, 78, 80, 81, 82, 84, 87, 88, 91, 93, 95, 103, 105, 107, 109, 127, 132, 133, 136,
    144, 145, 146, 148, 149, 150, 152, 153, 154, 155, 157, 158, 159, 160, 161, 162, 163, 168, 172,
    173, 176, 178, 181, 185, 191, 195, 197, 234, 246, 249, 251, 263, 267, 269, 270, 276, 282, 283,
    284, 285, 288, 291, 293, 295, 296, 297, 300, 308, 310, 311, 312, 314, 317, 318, 321, 323, 324,
    332, 334, 336, 338, 356, 361, 362, 365, 373, 374, 375, 377, 378, 379, 380, 381, 382, 384, 385,
    386, 387, 388, 389, 390, 397, 398, 400, 402, 405, 409, 415, 454, 466, *range(468, 478),
)  # fmt: skip
#: Where its 52 answers, a neutral one and ARKit's names by the alphabet, stand in ARKit's order.
_WEIGHT_ORDER = [ARKIT_NAMES.index(name) for name in sorted({*ARKIT_NAMES} - {"tongueOut"})]


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """A face in one picture.

    Attributes:
        landmarks: The 75 landmarks and both pupils.
        mesh_px: (478, 2) all points of the network.
        mesh_depth_px: (478,) away from the camera, 0 near the middle of the head.
        rotation: (3, 3) model to camera under weak perspective; on rendered heads yaw and roll are
            within about 5 degrees, pitch comes out about 8 degrees low.
        presence: How sure the network is that this is a face, in [0, 1].
        region: What it looked at.
        px_per_mm: Scale of a mean face in the picture.
    """

    landmarks: Landmarks2D
    mesh_px: FloatArray
    mesh_depth_px: FloatArray
    rotation: FloatArray
    presence: float
    region: Region
    px_per_mm: float = 1.0

    def __post_init__(self) -> None:
        freeze(
            self,
            mesh_px=(np.float64, (N_MESH, 2)),
            mesh_depth_px=(np.float64, (N_MESH,)),
            rotation=(np.float64, (3, 3)),
        )


class FaceAligner:
    """Holds the networks, which are costly to load. One thread at a time may use it."""

    def __init__(self, folder: Path, bias: AlignerBias | None = None) -> None:
        """Load the networks.

        Args:
            folder: Where assets/build/aligner.py put them.
            bias: Taken off the landmarks; None leaves them as the network gives them.
        """
        self._bias = bias
        self._detector = cv2.dnn.readNetFromTFLite(str(folder / "face_detector.tflite"))
        self._mesh = cv2.dnn.readNetFromTFLite(str(folder / "face_landmarks_detector.tflite"))
        self._weights = cv2.dnn.readNetFromTFLite(str(folder / "face_blendshapes.tflite"))
        self._mean = load_mean_face(folder / "mean_face.npz")
        self._lines = outline_lines(self._mean)
        self._visibility = visibility(self._mean, self._lines)

    @property
    def mean(self) -> MeanFace:
        """The mean face of the landmark network."""
        return self._mean

    def detect(self, rgb: U8) -> list[FaceBox]:
        """Return the faces in a picture (H, W, 3), the largest first."""
        height, width = rgb.shape[:2]
        side = max(height, width)
        whole = Region(np.array([width - 1, height - 1]) / 2, side, 0.0)
        self._detector.setInput(_network_input(rgb, whole, DETECTOR_SIZE_PX, (-1.0, 1.0)))
        scores, offsets = self._detector.forward(("classificators", "regressors"))
        return boxes_of(scores.ravel(), offsets[0], whole.to_picture(DETECTOR_SIZE_PX))

    def align(self, rgb: U8, region: Region) -> Alignment | None:
        """Return the face in a region of a picture (H, W, 3), None if there is none."""
        if not _MIN_REGION_PX < region.size_px < _MAX_REGION_PICTURES * max(rgb.shape):
            return None
        self._mesh.setInput(_network_input(rgb, region, LANDMARK_SIZE_PX, (0.0, 1.0)))
        points, logit = self._mesh.forward(("Identity", "Identity_1"))
        presence = float(1 / (1 + np.exp(-logit.ravel()[0])))
        if presence < MIN_PRESENCE:
            return None
        height, width = rgb.shape[:2]
        return self._alignment(points.reshape(N_MESH, 3), presence, region, (width, height))

    def first(self, rgb: U8) -> Alignment | None:
        """Return the largest face in a picture (H, W, 3), None without a face."""
        for box in self.detect(rgb):
            found = self._settled(rgb, box)
            if found is not None:
                return found
        return None

    def faces(self, rgb: U8, near_px: FloatArray) -> Iterator[Alignment]:
        """Yield the faces in a picture (H, W, 3), the nearest to a place (2,) first."""
        boxes = self.detect(rgb)
        for box in sorted(boxes, key=lambda box: float(np.linalg.norm(box.center_px - near_px))):
            found = self._settled(rgb, box)
            if found is not None:
                yield found

    def follow(self, rgb: U8, previous: Alignment | None) -> Alignment | None:
        """Return the face of the previous frame in this one; after None the largest face.

        The region comes from the previous points. Only where no face is seen there the detector
        looks for one that can be the same, by its distance.
        """
        if previous is None:
            return self.first(rgb)
        found = self.align(rgb, _region(previous.mesh_px))
        if found is not None:
            return found
        box = _same_face(self.detect(rgb), previous.region)
        return None if box is None else self._settled(rgb, box)

    def check(self, rgb: U8, landmarks_px: FloatArray) -> Alignment | None:
        """Return what the network sees where the internal landmarks of a tracker are.

        Args:
            rgb: (H, W, 3).
            landmarks_px: (L, 2), the internal landmarks first.
        """
        internal = landmarks_px[:N_INTERNAL]
        if not np.isfinite(internal).all():
            return None
        return self.align(rgb, _region(self._whole_face(internal)))

    def arkit_weights(self, alignment: Alignment) -> FloatArray:
        """Return the network's own guess of the 52 ARKit coefficients, tongueOut always 0."""
        points = alignment.mesh_px[list(_WEIGHT_POINTS)].astype(np.float32)
        self._weights.setInput(points[None])
        weights = np.zeros(len(ARKIT_NAMES))
        weights[_WEIGHT_ORDER] = self._weights.forward().ravel()[1:]
        return weights

    def _settled(self, rgb: U8, box: FaceBox) -> Alignment | None:
        """Return the face in a box; a second look has the region that following will have."""
        rough = self.align(rgb, region_of_box(box))
        return None if rough is None else self.align(rgb, _region(rough.mesh_px))

    def _whole_face(self, internal_px: FloatArray) -> FloatArray:
        """Return the surface points (468, 2) by the affine map from the mean face."""
        vertices = np.column_stack([self._mean.vertices_mm, np.ones(N_SURFACE)])
        internal = vertices[MESH478[:N_INTERNAL]]
        return np.asarray(vertices @ np.linalg.lstsq(internal, internal_px, rcond=None)[0])

    def _alignment(
        self, points: F32, presence: float, region: Region, size_px: tuple[int, int]
    ) -> Alignment:
        to_picture = region.to_picture(LANDMARK_SIZE_PX)
        mesh = points[:, :2] @ to_picture[:, :2].T + to_picture[:, 2]
        depth = points[:, 2].astype(np.float64) * region.size_px / LANDMARK_SIZE_PX
        scale, rotation = head_pose(self._mean, mesh, depth)
        edge = outline(self._lines, mesh, rotation)
        points_px = np.concatenate([mesh[MESH478[:N_INTERNAL]], edge, mesh[PUPILS478]])
        if self._bias is not None:
            points_px[:N_INTERNAL] -= self._bias.error_px(mesh, depth, rotation, scale)
        confidence = confidences(self._visibility, mesh, depth, rotation)
        confidence = confidence * inside(points_px, size_px)
        n = N_LANDMARKS
        landmarks = Landmarks2D(
            points_px[:n], np.zeros(n, bool), confidence[:n], points_px[n:], confidence[n:]
        )
        return Alignment(landmarks, mesh, depth, rotation, presence, region, scale)


def _region(mesh_px: FloatArray) -> Region:
    right, left = _OUTER_EYE_CORNERS
    return region_of_points(mesh_px[:N_SURFACE], mesh_px[right], mesh_px[left])


def _same_face(boxes: list[FaceBox], before: Region) -> FaceBox | None:
    """Return the box nearest to where the face was, None if the face cannot have got there."""
    distances = [float(np.linalg.norm(box.center_px - before.center_px)) for box in boxes]
    if not boxes or min(distances) > SAME_FACE_REACH * before.size_px / REGION_SCALE:
        return None
    return boxes[distances.index(min(distances))]


def _network_input(rgb: U8, region: Region, size_px: int, span: tuple[float, float]) -> F32:
    """Return a region of a picture as (1, 3, size, size), black 0 and white 255 made the span."""
    warp = region.to_picture(size_px)
    warp[:, 2] += warp[:, :2] @ [0.5, 0.5]
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    crop = cv2.warpAffine(
        rgb, warp, (size_px, size_px), flags=flags, borderMode=cv2.BORDER_REPLICATE
    )
    low, high = span
    shift = (-low * 255 / (high - low),) * 3
    return np.asarray(cv2.dnn.blobFromImage(crop, (high - low) / 255, mean=shift))
