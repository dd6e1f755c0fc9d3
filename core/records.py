"""The records that stages hand to each other: checked once, then nobody can change them.

Letters in shapes: N images or frames, L landmarks (75), Q shape points (77: the landmarks and
both pupils), V vertices, I identity modes, B blendshapes (46), S samples, T stages, K ferns per
stage, F tests per fern, P appearance points. Units: mm, px, rad, s. Camera frame: x right,
y down, z forward; image origin at the centre of the top-left pixel.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import ArrayShapeError

FloatArray = NDArray[np.float64]
F32 = NDArray[np.float32]
I8 = NDArray[np.int8]
I16 = NDArray[np.int16]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
U32 = NDArray[np.uint32]
BoolArray = NDArray[np.bool_]


def freeze(record: Any, **specs: tuple[Any, tuple[str | int, ...]]) -> None:
    """Copy, check and lock the named array fields of a record under construction.

    Args:
        record: The frozen dataclass instance, called from its `__post_init__`.
        **specs: field name -> (dtype, shape). A shape entry is a number, or a letter; equal
            letters must have equal lengths.

    Raises:
        ArrayShapeError: An array does not have the promised shape.
    """
    lengths: dict[str, int] = {}
    for name, (dtype, shape) in specs.items():
        array = np.array(getattr(record, name), dtype=dtype, order="C")
        promised = [
            lengths.setdefault(entry, found) if isinstance(entry, str) else entry
            for entry, found in zip(shape, array.shape, strict=False)
        ]
        if array.ndim != len(shape) or list(array.shape) != promised:
            owner = type(record).__name__
            raise ArrayShapeError(f"{owner}.{name}", f"shape {array.shape}", f"shape {shape}")
        array.setflags(write=False)
        object.__setattr__(record, name, array)


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One picture from a source.

    Attributes:
        rgb: (H, W, 3) uint8.
        gray: (H, W) uint8.
        time_s: Capture time on the source's own clock.
        index: Running number in the source.
    """

    rgb: U8
    gray: U8
    time_s: float
    index: int

    def __post_init__(self) -> None:
        for array in (self.rgb, self.gray):
            array.setflags(write=False)


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """A pinhole camera with square pixels [Cao13, camera calibration, eq. 9].

    Attributes:
        focal_px: Focal length.
        center_px: (2,) principal point.
        size_px: (width, height).
    """

    focal_px: float
    center_px: FloatArray
    size_px: tuple[int, int]

    def __post_init__(self) -> None:
        freeze(self, center_px=(np.float64, (2,)))


@dataclass(frozen=True, slots=True, eq=False)
class Landmarks2D:
    """Landmark positions in one image.

    Attributes:
        points_px: (L, 2) float64.
        edited: (L,) True where the user placed the point.
        confidence: (L,) in [0, 1]; 0 means not seen, the point is a guess.
        pupils_px: (2, 2) iris centres, the subject's right eye first.
        pupil_confidence: (2,) in [0, 1]; 0 where the eye is closed or unseen.
    """

    points_px: FloatArray
    edited: BoolArray
    confidence: FloatArray
    pupils_px: FloatArray
    pupil_confidence: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            points_px=(np.float64, ("L", 2)),
            edited=(np.bool_, ("L",)),
            confidence=(np.float64, ("L",)),
            pupils_px=(np.float64, (2, 2)),
            pupil_confidence=(np.float64, (2,)),
        )

    def moved(self, index: int, x_px: float, y_px: float) -> "Landmarks2D":
        """Return these landmarks with one point placed by the user."""
        points, edited = self.points_px.copy(), self.edited.copy()
        confidence = self.confidence.copy()
        points[index], edited[index], confidence[index] = (x_px, y_px), True, 1.0
        return Landmarks2D(points, edited, confidence, self.pupils_px, self.pupil_confidence)


@dataclass(frozen=True, slots=True, eq=False)
class SetupImages:
    """The pictures that a profile is made from.

    Attributes:
        images: N pictures (H, W, 3) uint8 RGB, all of one size.
        names: N file stems: the shot's name, or the frame number of a video.
        standard: (N, B) standard coefficients a* of each shot [Cao13, eq. 7], NaN rows where
            the picture is not one of the prompted poses.
    """

    images: tuple[U8, ...]
    names: tuple[str, ...]
    standard: FloatArray

    def __post_init__(self) -> None:
        freeze(self, standard=(np.float64, ("N", "B")))
        for image in self.images:
            image.setflags(write=False)


@dataclass(frozen=True, slots=True, eq=False)
class ModelFit:
    """The bilinear model fitted to all setup images [Cao13, 4.1].

    Attributes:
        identity: (I,) identity weights, one for all images.
        expressions: (N, B) expression coefficients in [0, 1].
        rotations_wxyz: (N, 4) model to camera.
        translations_mm: (N, 3).
        landmark_vertices: (N, L) vertex of each landmark, contour updated per image.
        rms_px: (N,) landmark distance after the fit; NaN where the pose is only a guess.
        offsets_mm: (60, 3) displacement of the internal landmarks from the model's surface, in
            the model frame: what the identity weights cannot express.
    """

    identity: FloatArray
    expressions: FloatArray
    rotations_wxyz: FloatArray
    translations_mm: FloatArray
    landmark_vertices: I32
    rms_px: FloatArray
    offsets_mm: FloatArray = field(default_factory=lambda: np.zeros((60, 3)))

    def __post_init__(self) -> None:
        freeze(
            self,
            identity=(np.float64, ("I",)),
            expressions=(np.float64, ("N", "B")),
            rotations_wxyz=(np.float64, ("N", 4)),
            translations_mm=(np.float64, ("N", 3)),
            landmark_vertices=(np.int32, ("N", "L")),
            rms_px=(np.float64, ("N",)),
            offsets_mm=(np.float64, (60, 3)),
        )


@dataclass(frozen=True, slots=True, eq=False)
class UserBlendshapes:
    """The user's own neutral face and 46 blendshapes [Cao13, eq. 5].

    Attributes:
        identity: (I,) identity weights that they were made from.
        neutral_mm: (V, 3).
        deltas_mm: (B, V, 3) difference of each full expression from the neutral face.
        landmark_offsets_mm: (60, 3) the user's internal landmarks from their vertices.
        rest_wxyz: (4,) the head's usual rotation in the setup pictures, against one that faces
            the camera: how the user looks at the screen.
    """

    identity: FloatArray
    neutral_mm: FloatArray
    deltas_mm: F32
    landmark_offsets_mm: FloatArray = field(default_factory=lambda: np.zeros((60, 3)))
    rest_wxyz: FloatArray = field(default_factory=lambda: np.array([1.0, 0.0, 0.0, 0.0]))

    def __post_init__(self) -> None:
        freeze(
            self,
            identity=(np.float64, ("I",)),
            neutral_mm=(np.float64, ("V", 3)),
            deltas_mm=(np.float32, ("B", "V", 3)),
            landmark_offsets_mm=(np.float64, (60, 3)),
            rest_wxyz=(np.float64, (4,)),
        )


@dataclass(frozen=True, slots=True, eq=False)
class SetupShapes:
    """The 3D shape of every setup image [Cao13, 4.2].

    Attributes:
        points_mm: (N, Q, 3) camera frame: 60 internal landmarks, 15 replacements, 2 pupils.
        rotations_wxyz: (N, 4) model to camera.
        translations_mm: (N, 3).
        coefficients: (N, B) in [0, 1].
        rms_px: (N,) landmark distance after the fit; NaN where the shape is only a guess.
    """

    points_mm: FloatArray
    rotations_wxyz: FloatArray
    translations_mm: FloatArray
    coefficients: FloatArray
    rms_px: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            points_mm=(np.float64, ("N", "Q", 3)),
            rotations_wxyz=(np.float64, ("N", 4)),
            translations_mm=(np.float64, ("N", 3)),
            coefficients=(np.float64, ("N", "B")),
            rms_px=(np.float64, ("N",)),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Shape3D:
    """What the regressor found in one frame.

    Attributes:
        points_mm: (Q, 3) camera frame.
        spread_mm: Disagreement of the L runs.
        residual: Distance of the appearance at the result from that of the training pictures,
            1 = the level that 99 % of good frames stay below.
        unlike: (R,) the same for each of landmarks.REGION_NAMES by itself.
    """

    points_mm: FloatArray
    spread_mm: float
    residual: float
    unlike: FloatArray = field(default_factory=lambda: np.zeros(6))

    def __post_init__(self) -> None:
        freeze(self, points_mm=(np.float64, ("Q", 3)), unlike=(np.float64, (6,)))


@dataclass(frozen=True, slots=True, eq=False)
class FaceState:
    """The solved face of one frame; all that avatars, recordings and streams need.

    Attributes:
        time_s: Capture time of the frame.
        rotation_wxyz: (4,) model to camera.
        translation_mm: (3,) model to camera.
        expression: (B,) coefficients in [0, 1], in the order of arkit.EXPRESSION_NAMES.
        gaze_rad: (2, 2) yaw and pitch of each eye in the head frame, the subject's right eye
            first; yaw positive to the subject's left, pitch positive up.
        shape_mm: (L, 3) landmarks in the camera frame.
        landmarks_px: (L, 2) their projections.
        confidence: In [0, 1].
        mode: "trained" or "free".
        lost: True while no face is tracked; the rest is then the last good state.
        regions: (R,) confidence in each of landmarks.REGION_NAMES, in [0, 1]: what is covered
            has little, and its coefficients are then held or at rest.
    """

    time_s: float
    rotation_wxyz: FloatArray
    translation_mm: FloatArray
    expression: FloatArray
    gaze_rad: FloatArray
    shape_mm: FloatArray
    landmarks_px: FloatArray
    confidence: float
    mode: str
    lost: bool
    regions: FloatArray = field(default_factory=lambda: np.ones(6))

    def __post_init__(self) -> None:
        freeze(
            self,
            rotation_wxyz=(np.float64, (4,)),
            translation_mm=(np.float64, (3,)),
            expression=(np.float64, ("B",)),
            gaze_rad=(np.float64, (2, 2)),
            shape_mm=(np.float64, ("L", 3)),
            landmarks_px=(np.float64, ("L", 2)),
            regions=(np.float64, (6,)),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Progress:
    """How far a long stage has come.

    Attributes:
        done: Steps finished.
        total: Steps in all.
        label: What is being done, for people.
        plot: Named numbers worth plotting, e.g. {"focal_px": 610.0, "error_px": 1.9}.
    """

    done: int
    total: int
    label: str
    plot: dict[str, float] = field(default_factory=dict)
