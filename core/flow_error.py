"""How far landmarks carried by flow are expected to be off.

Learned on two real clips and four takes of the virtual performer by letting flow run for
3 and 12 frames and comparing with the network: the logarithms of expected and true error
correlate with 0.92. tests/benchmarks/bench_landmark_flow.py measures it again.
"""

from dataclasses import dataclass

import numpy as np

from core.records import FloatArray

#: Error in parts of the face's size per sign: strayed, eyes, mouth, turned, turned when already
#: in profile, and what is always there.
_FACE = (0.0026, 0.0064, 0.0026, 0.0194, 0.0838, 0.0009)
_EYES = (0.0004, 0.0225, 0.0, 0.0, 0.076, 0.0003)
_LIPS = (0.0023, 0.0, 0.0084, 0.0019, 0.1094, 0.0011)
#: The lids are a small part of the face but a blink that is missed shows.
_EYES_COUNT = 1.5
#: More than this is lost in any case.
_LOST = 50.0
#: Error of a point that is as likely as not followed, against one that is half as good as seen.
_POINT = 0.0125 / 0.02


@dataclass(frozen=True, slots=True)
class Signs:
    """What has happened since the network looked.

    Attributes:
        strayed: Odds 1/trust - 1 against the points that flow followed badly, see `Motion`.
        eyes: Difference of the picture of the eye that changed more, see `difference`.
        mouth: Of the picture of the mouth.
        turned: Sine of the angle by which the head turned out of the picture plane.
        profile: Sine of the angle to the side at which the network saw it.
    """

    strayed: float
    eyes: float
    mouth: float
    turned: float
    profile: float


def expected_error(signs: Signs) -> float:
    """Return the expected RMS error in parts of the face's size; that of lids or lips if larger."""
    terms = np.array(
        [np.cbrt(min(signs.strayed, _LOST)), np.sqrt(signs.eyes), np.sqrt(signs.mouth),
         signs.turned, signs.turned * signs.profile, 1.0]
    )  # fmt: skip
    face, eyes, lips = np.array([_FACE, _EYES, _LIPS]) @ terms
    return float(max(face, _EYES_COUNT * eyes, lips))


def confidences_of(trust: FloatArray) -> FloatArray:
    """Return the confidence in points that flow has followed with some trust, all in [0, 1].

    The error of a point grows with the third root of the odds against it, like the face's, but
    not without end: where flow lost it the other points carry it.
    """
    odds = np.minimum(1 / np.maximum(trust, 1e-6) - 1, _LOST)
    return np.asarray(1 / (1 + (_POINT * np.cbrt(odds)) ** 2))
