"""When the landmark network has to look again, and when it may rest.

Each frame adds what one frame may cost to an account, network and flow take their cost off it.
The fuller the account, the smaller an error of flow is worth a look.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

#: "every" frame, every n-th frame for a number, or as flow needs and the account allows.
Detection = Literal["every", "adaptive"] | int


@dataclass(frozen=True, slots=True)
class PolicySettings:
    """How errors and costs are weighed when detection is adaptive.

    Attributes:
        tolerance: Expected error of flow, in parts of the face's size, that is worth a look while
            the account is full.
        alarm: Expected error that calls for a look whatever it costs: flow has lost the face.
        longest_s: The network looks at least so often, as the source's own clock tells.
        savings: Looks that can be saved up for a blink, and that can be owed.
        network_ms: Cost of the network before it was measured, or without a clock.
        flow_ms: Cost of flow, the same.
    """

    tolerance: float = 0.005
    alarm: float = 0.08
    longest_s: float = 1.0
    savings: float = 6.0
    network_ms: float = 16.0
    flow_ms: float = 1.5


#: Share of a new measurement in the mean cost.
_LEARNING = 0.1
#: A measurement counts as at most so many means: the first call of a kernel loads it.
_AT_MOST = 3.0
#: How fast the tolerance grows once less than half of the savings is left.
_THRIFT = 3.0


class DetectionPolicy:
    """Decides frame by frame; the same errors and costs give the same decisions."""

    def __init__(
        self, detection: Detection, budget_ms: float, settings: PolicySettings | None = None
    ) -> None:
        """Prepare to decide.

        Args:
            detection: How often the network looks.
            budget_ms: What network and flow may cost per frame on average, adaptive only.
            settings: How that is brought about.

        Raises:
            ValueError: No such detection, or no budget.
        """
        if detection not in ("every", "adaptive") and (
            not isinstance(detection, int) or isinstance(detection, bool) or detection < 1
        ):
            raise ValueError(
                f"detection is {detection!r}; expected 'every', 'adaptive' or a number of "
                "frames of at least 1"
            )
        if not budget_ms > 0:
            raise ValueError(f"budget_ms is {budget_ms}; expected milliseconds above 0")
        self._detection, self._budget_ms = detection, budget_ms
        self._settings = settings or PolicySettings()
        self.reset()

    def reset(self) -> None:
        """Forget the account and what was measured."""
        self._network_ms = self._settings.network_ms
        self._flow_ms = self._settings.flow_ms
        self._account_ms = 0.5 * self._settings.savings * self._network_ms
        self._frames = 0

    def wants_look(self, error: float, age_s: float) -> bool:
        """Return whether the network should look at this frame.

        Args:
            error: Expected of flow, in parts of the face's size.
            age_s: Time since the last look.
        """
        if self._detection == "every":
            return True
        if isinstance(self._detection, int):
            return self._frames + 1 >= self._detection
        settings = self._settings
        if error >= settings.alarm or not 0 <= age_s < settings.longest_s:
            return True
        return error >= settings.tolerance * self._thrift()

    def spent(self, flow_ms: float | None, network_ms: float | None, looked: bool) -> None:
        """Book one frame.

        Args:
            flow_ms: Measured cost of flow, None where it did not run or no clock tells.
            network_ms: The same of the network.
            looked: Whether the network ran.
        """
        settings = self._settings
        self._flow_ms = _learned(self._flow_ms, flow_ms)
        self._network_ms = _learned(self._network_ms, network_ms)
        self._frames = 0 if looked else self._frames + 1
        self._account_ms += self._budget_ms - self._flow_ms - looked * self._network_ms
        limit = settings.savings * self._network_ms
        self._account_ms = min(max(self._account_ms, -limit), limit)

    def _thrift(self) -> float:
        """Return how much more than the tolerance is tolerated: 1 while there are savings."""
        part = self._account_ms / (self._settings.savings * self._network_ms)
        return max(1.0, float(np.exp(_THRIFT * (0.5 - part))))


def _learned(mean_ms: float, measured_ms: float | None) -> float:
    """Return the mean cost after one more measurement, None if there was none."""
    if measured_ms is None:
        return mean_ms
    return mean_ms + _LEARNING * (min(measured_ms, _AT_MOST * mean_ms) - mean_ms)
