"""How far landmarks carried by flow are expected to be off.

Learned on two real clips and four takes of the virtual performer by letting flow run for 12
frames and comparing with the network: the logarithms of expected and true error correlate with
0.91. tests/benchmarks/bench_landmark_flow.py measures it again.
"""

from dataclasses import dataclass

import numpy as np

from core.records import FloatArray

#: Error in parts of the face's size per sign, in the order of `Signs`, then what is always there.
_FACE = (0.0054, 0.0092, 0.0034, 0.0394, 0.0006)
_EYES = (0.0003, 0.0223, 0.0, 0.0088, 0.0001)
_LIPS = (0.0037, 0.0, 0.0091, 0.0202, 0.0012)
#: The lids are a small part of the face but a blink that is missed shows.
_EYES_COUNT = 1.5
#: More than this is lost in any case.
_LOST = 50.0


@dataclass(frozen=True, slots=True)
class Signs:
    """What has happened since the network looked.

    Attributes:
        strayed: Odds 1/trust - 1 against the points that flow followed badly, see `Motion`.
        eyes: Difference of the picture of the eye that changed more, see `difference`.
        mouth: Of the picture of the mouth.
        turned: Sine of the angle by which the head turned away from the picture plane.
    """

    strayed: float
    eyes: float
    mouth: float
    turned: float


def expected_error(signs: Signs) -> float:
    """Return the expected RMS error in parts of the face's size; that of lids or lips if larger."""
    terms = np.array(
        [np.cbrt(min(signs.strayed, _LOST)), np.sqrt(signs.eyes), np.sqrt(signs.mouth),
         signs.turned, 1.0]
    )  # fmt: skip
    face, eyes, lips = np.array([_FACE, _EYES, _LIPS]) @ terms
    return float(max(face, _EYES_COUNT * eyes, lips))


def confidences_of(trust: FloatArray) -> FloatArray:
    """Return the confidence in points that flow has followed with some trust, all in [0, 1].

    The error of a point grows with the third root of the odds against it, like the face's.
    """
    odds = 1 / np.maximum(trust, 1e-6) - 1
    return np.asarray(1 / (1 + np.cbrt(odds) ** 2))
