"""Which pictures are asked for, in which order, and how that is told."""

from collections.abc import Collection

from app.controllers.editing import title_of
from app.views.choice import Choice
from core.extra_shots import SETS, extra_set, extra_shots
from core.setup_plan import SHOTS, Shot, set_of, shot_of

ALL_KEY, QUICK_KEY = "all", "quick"


def _rank(shot: Shot) -> tuple[int, float]:
    if shot.expression_name != "neutral":
        return 5, 0.0
    if shot.yaw:
        return (1 if shot.yaw < 0 else 2), abs(shot.yaw)
    return (3 if shot.pitch else 4 if shot.roll else 0), 0.0


#: All prompts, head turns from the front outwards: a face that was seen once is found again.
ORDER: tuple[Shot, ...] = tuple(sorted(SHOTS, key=_rank))
#: The quick subset: small head turns, and each expression from the front.
QUICK: tuple[str, ...] = (
    "pose_yaw+0", "pose_yaw-30", "pose_yaw+30", "pose_pitch-15", "pose_pitch+15",
    *(shot.name for shot in SHOTS if shot.expression_name != "neutral" and shot.yaw == 0.0),
)  # fmt: skip
_BY_NAME = {shot.name: shot for shot in ORDER}
#: What can be asked for.
PLANS: tuple[Choice, ...] = (
    Choice(ALL_KEY, f"All {len(ORDER)} pictures"),
    Choice(QUICK_KEY, f"Quick: {len(QUICK)} pictures", "The rest can be taken later"),
    *(Choice(one.key, f"More: {one.title.lower()}", one.reason) for one in SETS),
)


class Prompts:
    """Remembers what is asked for and what was skipped; which pictures there are it is told."""

    def __init__(self) -> None:
        self.key = ALL_KEY
        self.shots: tuple[Shot, ...] = ORDER
        self._skipped: set[str] = set()

    @property
    def wanted(self) -> tuple[str, ...]:
        """The names of the pictures of this session."""
        return QUICK if self.key == QUICK_KEY else tuple(shot.name for shot in self.shots)

    @property
    def request(self) -> str:
        """What to do before the first of more pictures, "" for the first ones."""
        if self.key in (ALL_KEY, QUICK_KEY):
            return ""
        wanted = extra_set(self.key)
        return f"{wanted.title}: {wanted.request[:1].lower()}{wanted.request[1:]}"

    def choose(self, key: str, there: Collection[str]) -> None:
        """Ask for something else.

        Args:
            key: Of PLANS.
            there: Names of the pictures that there are.
        """
        self.key = key
        self._skipped.clear()
        if key == ALL_KEY:
            self.shots = ORDER
        elif key == QUICK_KEY:
            # What was taken beyond them can be looked at, and taken again, too.
            more = [shot for shot in ORDER if shot.name in there and shot.name not in QUICK]
            self.shots = (*(_BY_NAME[name] for name in QUICK), *more)
        else:
            self.shots = extra_shots(extra_set(key), there)

    def missing(self, there: Collection[str]) -> list[str]:
        """Return those without a picture."""
        return [name for name in self.wanted if name not in there]

    def next(self, there: Collection[str]) -> str | None:
        """Return the first one that is missing and was not skipped."""
        left = (name for name in self.missing(there) if name not in self._skipped)
        return next(left, None)

    def skip(self, name: str, skipped: bool = True) -> None:
        """Leave one out for now, or ask for it after all."""
        (self._skipped.add if skipped else self._skipped.discard)(name)

    def shot(self, name: str | None) -> Shot | None:
        """Return the prompt of a name."""
        return next((shot for shot in self.shots if shot.name == name), None)


def told(shot: Shot) -> tuple[str, str]:
    """Return what a prompt asks for, in short and in full."""
    face, _, turn = shot.instruction.rstrip(".").rpartition(", and ")
    if shot.expression_name == "neutral":
        return turn[:1].upper() + turn[1:], f"{face}."
    return face, f"Meanwhile, {turn}."


def title_of_prompt(name: str) -> str:
    """Return a picture's name as people read it, with its set: "glasses: smile (30° right)"."""
    shot = shot_of(name)
    if shot is None:
        return title_of(name)
    return f"{set_of(name).replace('~', ', ')}: {title_of(shot.name)}" if set_of(name) else (
        title_of(name)
    )  # fmt: skip
