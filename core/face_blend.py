"""From one guess of a person's face and focal length to a better one, over a few frames."""

from dataclasses import dataclass

import numpy as np

from core.camera import camera_for
from core.fit_space import Face
from core.records import Camera, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class KnownHead:
    """What tracking takes for granted while it solves a frame.

    Attributes:
        face: The person's face at the points of a fit.
        camera: The camera.
        eye_centers_mm: (2, 3) eyeball centres in the model frame, the right eye first.
    """

    face: Face
    camera: Camera
    eye_centers_mm: FloatArray


class FaceBlend:
    """Moves from the head in use to a better one; a better one may come before it arrived."""

    def __init__(self, head: KnownHead, duration_s: float = 0.5) -> None:
        """Begin with a head.

        Args:
            head: The first one.
            duration_s: Time in which a better one replaces it.
        """
        self._from, self._to, self._head = head, head, head
        self._duration_s, self._began_s, self._arrived = duration_s, 0.0, True

    @property
    def head(self) -> KnownHead:
        """The head to use now."""
        return self._head

    @property
    def arrived(self) -> bool:
        """Whether the last head that was asked for is the one in use."""
        return self._arrived

    def begin(self, head: KnownHead, time_s: float) -> None:
        """Start to move to a better head."""
        self._from, self._to = self._head, head
        self._began_s, self._arrived = time_s, False

    def step(self, time_s: float) -> KnownHead:
        """Return the head to use from this time on; time that ran backwards ends the move."""
        progress = (time_s - self._began_s) / self._duration_s
        if not 0 <= progress < 1:
            progress = 1.0
        self._arrived = progress == 1.0
        self._head = self._to if self._arrived else between(self._from, self._to, progress)
        return self._head


def between(first: KnownHead, second: KnownHead, share: float) -> KnownHead:
    """Return the head that lies a share of the way from the first to the second.

    The focal length moves by equal factors: the distance of a face follows it in proportion.
    """

    def mixed(a: FloatArray, b: FloatArray) -> FloatArray:
        return np.asarray((1 - share) * a + share * b)

    old, new = first.face, second.face
    face = Face(
        mixed(old.neutral_mm, new.neutral_mm), mixed(old.deltas_mm, new.deltas_mm),
        new.strips, new.replacements,
    )  # fmt: skip
    log_focal = (1 - share) * np.log(first.camera.focal_px)
    log_focal += share * np.log(second.camera.focal_px)
    camera = camera_for(second.camera.size_px, float(np.exp(log_focal)))
    return KnownHead(face, camera, mixed(first.eye_centers_mm, second.eye_centers_mm))
