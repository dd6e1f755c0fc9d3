"""Where the eyes look, read from the picture: a small regression of each eye's patch.

The pupils among the regressed shape points follow the gaze badly: people look at the screen in
almost every setup picture, so there is nothing to learn from. `core.eye_trainer` therefore turns
the eyes in these pictures to all sides. A patch lies in a plane before the eye, fixed to the head,
so that the head's pose is taken off, and kernel ridge regression maps its grey levels to yaw and
pitch: two patches of 112 pixels and 300 examples cost a twentieth of a regressed shape.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.kernels.eyes import eye_direction, level_patch, read_eye
from core.records import F32, U8, Camera, FloatArray, freeze

#: Where a patch is read, from the eye's middle: x towards the subject's left, y down.
XS_MM: FloatArray = np.linspace(-13.0, 13.0, 14)
YS_MM: FloatArray = np.linspace(-6.5, 6.5, 8)
#: Readings that are averaged for a pixel lie so far apart: the noise of one picture is less then.
APART_MM = 1.0
PATCH_PIXELS = len(XS_MM) * len(YS_MM)
#: The patch's plane is this part of the eyeball's radius before the eyeball's centre.
PLANE = 0.95
#: Contrast of pure noise, grey levels.
LEAST_SPREAD = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class EyeReader:
    """What reads the gaze of one person; the subject's right eye comes first.

    Attributes:
        examples: (2, C, P) levelled patches.
        weights: (2, C + P + 1, 2) of the examples, the patch's own pixels and 1.
        narrowness: How fast an example's weight falls with the square of the distance.
    """

    examples: F32
    weights: F32
    narrowness: float

    def __post_init__(self) -> None:
        freeze(self, examples=(np.float32, (2, "C", PATCH_PIXELS)))
        # The kernel reads that many without asking.
        n_weights = self.examples.shape[1] + PATCH_PIXELS + 1
        freeze(self, weights=(np.float32, (2, n_weights, 2)))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return everything as named arrays."""
        return {entry.name: np.asarray(getattr(self, entry.name)) for entry in fields(self)}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> "EyeReader":
        """Return the reader whose `arrays` these are."""
        return cls(arrays["examples"], arrays["weights"], float(arrays["narrowness"]))


class EyeReading:
    """Applies a reader frame by frame, in memory of its own."""

    def __init__(
        self, reader: EyeReader, camera: Camera, centers_mm: FloatArray, radii_mm: FloatArray
    ) -> None:
        """Prepare to read.

        Args:
            reader: Of the person.
            camera: Of the frames.
            centers_mm: (2, 3) eyeball centres in the head frame, the right one first.
            radii_mm: (2,).
        """
        self._reader = reader
        self._camera = camera_numbers(camera)
        self._middles = patch_middles(centers_mm, radii_mm)
        self._patch = np.empty(PATCH_PIXELS, np.float32)

    def directions(self, gray: U8, pose: FloatArray) -> FloatArray:
        """Return yaw and pitch (2, 2) in rad of each eye in the head frame.

        Args:
            gray: (H, W).
            pose: (4, 3) head-to-camera rotation matrix, then the translation in mm.
        """
        out, reader = np.empty((2, 2)), self._reader
        for eye in range(2):
            read_eye(
                gray, self._camera, pose, self._middles[eye], XS_MM, YS_MM, APART_MM, self._patch
            )
            level_patch(self._patch, LEAST_SPREAD)
            eye_direction(
                self._patch, reader.examples[eye], reader.narrowness, reader.weights[eye], out[eye]
            )
        return out


def camera_numbers(camera: Camera) -> FloatArray:
    """Return focal length and principal point (3,) in px."""
    return np.array([camera.focal_px, *camera.center_px])


def patch_middles(centers_mm: FloatArray, radii_mm: FloatArray) -> FloatArray:
    """Return the middles (2, 3) of both patches in the head frame."""
    return np.asarray(centers_mm - PLANE * np.outer(radii_mm, [0.0, 0.0, 1.0]))
