"""When the landmark network has to look again, and when it may rest.

Each frame adds what one frame may cost to an account, network and flow take their cost off it.
The fuller the account, the smaller a sign is enough to look.
"""

from dataclasses import dataclass
from typing import Literal

#: "every" frame, every n-th frame for a number, or as the signs and the account ask for.
Detection = Literal["every", "adaptive"] | int


@dataclass(frozen=True, slots=True)
class PolicySettings:
    """How signs and costs are weighed when detection is adaptive.

    Attributes:
        network_ms: Cost of the network before it was measured, or without a clock.
        flow_ms: Cost of flow, the same.
        longest_s: The network looks at least so often, as the source's own clock tells.
        least_sign: A smaller sign than this is none, however full the account.
        savings: Looks that can be saved up for a blink, and that can be owed.
    """

    network_ms: float = 16.0
    flow_ms: float = 1.5
    longest_s: float = 0.6
    least_sign: float = 0.35
    savings: float = 6.0


@dataclass(frozen=True, slots=True)
class Signs:
    """What speaks for a look; 1 is what calls for one when the account is even.

    Attributes:
        flow: Error of the way there and back.
        change: Of the pictures of eyes and mouth since the last look.
        age_s: Time since the last look.
    """

    flow: float
    change: float
    age_s: float


#: A sign this large is heard whatever the look costs: flow has lost the face.
ALARM = 6.0
#: Share of a new measurement in the mean cost.
_LEARNING = 0.1


class DetectionPolicy:
    """Decides frame by frame; the same signs and costs give the same decisions."""

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
        self._account_ms = 0.0
        self._frames = 0

    def wants_look(self, signs: Signs) -> bool:
        """Return whether the network should look at this frame."""
        settings = self._settings
        if self._detection == "every":
            return True
        if isinstance(self._detection, int):
            return self._frames + 1 >= self._detection
        if signs.age_s < 0 or max(signs.flow, signs.change) >= ALARM:
            return True
        sign = max(signs.flow, signs.change, signs.age_s / settings.longest_s)
        return sign >= self._asked()

    def spent(self, flow_ms: float | None, network_ms: float | None, looked: bool) -> None:
        """Book one frame.

        Args:
            flow_ms: Measured cost of flow, None where it did not run or no clock tells.
            network_ms: The same of the network.
            looked: Whether the network ran.
        """
        settings = self._settings
        if flow_ms is not None:
            self._flow_ms += _LEARNING * (flow_ms - self._flow_ms)
        if network_ms is not None:
            self._network_ms += _LEARNING * (network_ms - self._network_ms)
        self._frames = 0 if looked else self._frames + 1
        self._account_ms += self._budget_ms - self._flow_ms - looked * self._network_ms
        limit = settings.savings * self._network_ms
        self._account_ms = min(max(self._account_ms, -limit), limit)

    def _asked(self) -> float:
        """Return the sign that is enough: small with savings, large with debts."""
        settings = self._settings
        full = settings.savings * self._network_ms
        part = self._account_ms / full
        return max(settings.least_sign, 1 - part) if part > 0 else 1 - 4 * part
