"""How strongly each coefficient is passed on, and what full means for this user."""

from dataclasses import replace

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.drive_settings import DriveSettings, Response
from core.records import FloatArray

#: A coefficient takes part in "this is 100 %" from here on above what counts as 0.
SHOWN = 0.15
#: Least range: below it noise would be shown as an expression.
LEAST_RANGE = 0.1
#: What parts the lips: up to REST it is a mouth at rest, from MEANT on what was tracked, where
#: steadiness is 0.5 or less; the zone vanishes towards "as tracked".
PARTING = np.array(
    [
        name.startswith(("jawOpen", "mouthPucker", "mouthFunnel", "mouthUpperUp", "mouthLowerDown"))
        for name in EXPRESSION_NAMES
    ]
)
REST, MEANT = 0.045, 0.2


def lips_rested(expression: FloatArray, steadiness: float = 0.5) -> FloatArray:
    """Return the expression (B,) without what little parts lips that rest on each other.

    Trackers see closed lips a little open. The cubic Hermite curve from (rest, 0) with slope 0 to
    (meant, meant) with slope 1 joins the two; it rises throughout.

    Args:
        expression: As tracked.
        steadiness: Of the mouth: 1 leaves everything as tracked.
    """
    size = min(2 * (1 - steadiness), 1.0)
    if size <= 0:
        return expression
    rest, meant = size * REST, size * MEANT
    share = np.clip((expression - rest) / (meant - rest), 0.0, 1.0)
    eased = share**2 * ((share - 1) * (meant - rest) + (3 - 2 * share) * meant)
    return np.where(PARTING & (expression < meant), eased, expression)


class ResponseTable:
    """The responses of all coefficients as arrays."""

    def __init__(self, responses: tuple[Response, ...], steadiness: float = 1.0) -> None:
        """Prepare the responses; by the mouth's steadiness, small openings of lips are none."""
        self._steadiness = steadiness
        gain = np.array([one.gain for one in responses])
        low = np.array([one.low for one in responses])
        high = np.array([one.high for one in responses])
        self._factor = gain / np.maximum(high - low, LEAST_RANGE)
        self._shift = np.array([one.offset for one in responses]) - self._factor * low
        self._low, self._offset = low, np.array([one.offset for one in responses])

    def applied(self, expression: FloatArray) -> FloatArray:
        """Return the expression (B,) as it is passed on, in [0, 1]."""
        # Below `low` counts as 0, not as less, so that an offset raises it from 0.
        shown = self._factor * lips_rested(expression, self._steadiness) + self._shift
        shown = np.maximum(shown, self._offset)
        return np.asarray(np.minimum(np.maximum(shown, 0.0), 1.0))


def learn_full(
    settings: DriveSettings, expression: FloatArray, only: int | None = None
) -> DriveSettings:
    """Return settings for which this face is the full one: "make the face you want as 100 %".

    Of every coefficient that the face clearly shows, its value becomes the upper end of the range;
    the gain is 1 again.

    Args:
        settings: To change.
        expression: (B,) as `Drive.now` gives it, before the responses.
        only: Index of the one coefficient to change, None for all that are shown.
    """
    responses = list(settings.responses)
    for index in range(len(EXPRESSION_NAMES)) if only is None else (only,):
        old, value = responses[index], float(expression[index])
        if value < old.low + SHOWN:
            continue
        high = min(max(value, old.low + LEAST_RANGE, 0.05), 1.0)
        responses[index] = replace(old, gain=1.0, high=round(high, 3))
    return replace(settings, responses=tuple(responses))


class Seen:
    """The least and greatest value of every coefficient that was tracked."""

    def __init__(self) -> None:
        self._range = np.empty((len(EXPRESSION_NAMES), 2))
        self.forget()

    def forget(self) -> None:
        """Begin anew: nothing was seen."""
        self._range[:, 0], self._range[:, 1] = np.inf, -np.inf

    def add(self, expression: FloatArray) -> None:
        """Take an expression (B,) into account."""
        np.minimum(self._range[:, 0], expression, out=self._range[:, 0])
        np.maximum(self._range[:, 1], expression, out=self._range[:, 1])

    def range(self) -> FloatArray:
        """Return (B, 2) least and greatest value, 0 where nothing was seen."""
        seen = self._range.copy()
        return np.where(np.isfinite(seen), seen, 0.0)
