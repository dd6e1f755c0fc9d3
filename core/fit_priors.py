"""What is known about expressions before the landmarks are seen.

A coefficient costs (a - mean)^2 / spread^2 + 2 slope a. The slope is the cost of using a shape at
all: with it a neutral face gets zeros, and an open mouth is explained by jawOpen alone instead
of a little of ten shapes. Shapes that every face shows often are cheap, odd ones are dear.
"""

from dataclasses import dataclass

import numpy as np

from core.records import FloatArray
from core.setup_plan import coefficients

#: How far coefficients usually go; all that are not named go to USUAL_SPREAD.
SPREADS: dict[str, float] = {
    "jawOpen": 1.0, "eyeBlink": 1.0, "mouthSmile": 0.7, "browInnerUp": 0.6, "browOuterUp": 0.6,
    "browDown": 0.5, "mouthPucker": 0.5, "mouthFunnel": 0.4, "mouthClose": 0.3,
    "mouthUpperUp": 0.4, "mouthLowerDown": 0.35, "jawLeft": 0.5, "jawRight": 0.5,
    "eyeSquint": 0.3, "cheekSquint": 0.2, "cheekSuck": 0.15, "cheekPuff": 0.3,
    "jawForward": 0.2, "noseSneer": 0.35, "mouthDimple": 0.25, "mouthShrugUpper": 0.25,
    "mouthShrugLower": 0.35, "mouthRollUpper": 0.35, "mouthRollLower": 0.35,
}  # fmt: skip
USUAL_SPREAD = 0.4


@dataclass(frozen=True, slots=True)
class PriorSettings:
    """How much is known about expressions.

    Attributes:
        spread_scale: Multiplies the usual spreads.
        slope: Cost of using a shape of the usual spread that is not asked for.
        standard_spread: How far people are from a* when they follow a prompt.
        others_share: Share of the usual spread for shapes that a prompt does not ask for.
        neutral_share: The same where the prompt is a neutral face. Small: that the face is rigid
            in these pictures is what tells its depth and the focal length.
    """

    spread_scale: float = 1.0
    slope: float = 5.0
    standard_spread: float = 0.35
    others_share: float = 0.4
    neutral_share: float = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class ExpressionPrior:
    """Means, precisions and slopes of the coefficients in each picture, all (N, B)."""

    mean: FloatArray
    precision: FloatArray
    slope: FloatArray

    def energy(self, expressions: FloatArray) -> FloatArray:
        """Return the cost (N,) of expressions (N, B)."""
        distance = expressions - self.mean
        cost = distance**2 * self.precision + 2 * self.slope * expressions
        return np.asarray(cost.sum(axis=1))

    def half_gradient(self, expressions: FloatArray) -> FloatArray:
        """Return half the gradient (N, B) of the cost at expressions (N, B)."""
        return np.asarray((expressions - self.mean) * self.precision + self.slope)


def expression_spreads() -> FloatArray:
    """Return how far each coefficient usually goes, (B,)."""
    unnamed = coefficients(SPREADS) == 0
    return np.where(unnamed, USUAL_SPREAD, coefficients(SPREADS))


def expression_prior(standard: FloatArray, settings: PriorSettings) -> ExpressionPrior:
    """Return the prior of pictures, some of them of prompted expressions.

    Args:
        standard: (N, B) coefficients a*, NaN rows where nothing is known.
        settings: How much is known.
    """
    known = ~np.isnan(standard).any(axis=1, keepdims=True)
    mean = np.where(known, standard, 0.0)
    asked = mean > 0
    neutral = known & ~asked.any(axis=1, keepdims=True)
    # People who are asked for one thing rarely do another, but nobody hits a* exactly.
    share = np.where(neutral, settings.neutral_share, settings.others_share)
    share = np.where(known, share, 1.0)
    usual = settings.spread_scale * share * expression_spreads()
    spread = np.where(asked, settings.standard_spread, usual)
    slope = settings.slope * USUAL_SPREAD / (share * expression_spreads())
    return ExpressionPrior(mean, spread**-2.0, np.where(asked, 0.0, slope))
