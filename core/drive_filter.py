"""The filter of the drive: each group of values follows as fast as its fastest one moves.

On top of the tracker's prior and pose filter, for what these let through when a face is still. A
first-order low-pass whose cutoff rises with the speed [Casiez, Roussel and Vogel 2012], with three
differences. Speed counts in units of each value's own noise and only above what noise alone makes,
so a still face stays in the steady state whatever the camera. The speed is measured from the
filtered value to the new one: a blink opens the filter in the very frame in which it starts. And
all values of a group pass by the same share: what belongs together in the lips stays together, and
a plosive's mouthClose still matches its jawOpen, while brows do not move on a blink. Turn and place
of the head are two groups: nobody sits without swaying by millimetres, and that must not let the
turn shake.
"""

from dataclasses import dataclass, field

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.drive_settings import Steadiness
from core.kernels.drive import follow_groups
from core.kernels.pose import rotate_by, rotation_between
from core.records import I32, FloatArray

#: Values that are filtered: coefficients, gaze of both eyes, head as rotation vector and place.
N_COEFFICIENTS = len(EXPRESSION_NAMES)
GAZE = slice(N_COEFFICIENTS, N_COEFFICIENTS + 4)
TURN = slice(N_COEFFICIENTS + 4, N_COEFFICIENTS + 7)
PLACE = slice(N_COEFFICIENTS + 7, N_COEFFICIENTS + 10)


@dataclass(frozen=True, slots=True)
class GroupCutoff:
    """How a group is filtered at taste 0.5.

    Attributes:
        cutoff_hz: While nothing moves more than noise does.
        cutoff_per_speed: Added per unit of speed above `quiet_speed`, Hz / (noise / s).
        quiet_speed: Speed that noise alone makes, noise / s.
        speed_cutoff_hz: Low-pass cutoff of the speed itself.
    """

    cutoff_hz: float
    cutoff_per_speed: float
    quiet_speed: float
    speed_cutoff_hz: float


#: The groups, and whose taste they follow.
TASTES = {"turn": "head", "place": "head", "brows": "brows", "eyes": "eyes", "mouth": "mouth"}
#: Standard deviation from frame to frame of the coefficients of a still face, by how their names
#: start; measured on the virtual performers and rounded up.
NOISE: dict[str, float] = {
    "eyeWide": 0.04, "eyeBlink": 0.008, "eyeSquint": 0.006, "brow": 0.012, "cheekPuff": 0.02,
    "mouthPucker": 0.018, "mouthFunnel": 0.01, "jaw": 0.01,
}  # fmt: skip
OTHER_NOISE = 0.007


@dataclass(frozen=True, slots=True)
class FilterSettings:
    """How everything is filtered.

    Attributes:
        turn: The head's rotation.
        place: Its place.
        brows: Brows.
        eyes: Lids and gaze.
        mouth: Everything else.
        gaze_noise_rad: Standard deviation of a still gaze.
        turn_noise_rad: The same of the head's rotation.
        place_noise_mm: Of its place across the view; along it noise is `depth_factor` larger.
        depth_factor: See above.
        taste_factor: Cutoffs grow by this factor from taste 0.5 to almost 1, and fall by it to 0.
        longest_step_s: After a longer gap the filter starts anew.
    """

    turn: GroupCutoff = field(default_factory=lambda: GroupCutoff(0.4, 0.1, 60.0, 2.0))
    place: GroupCutoff = field(default_factory=lambda: GroupCutoff(0.4, 0.1, 50.0, 2.0))
    brows: GroupCutoff = field(default_factory=lambda: GroupCutoff(0.4, 0.1, 50.0, 2.0))
    eyes: GroupCutoff = field(default_factory=lambda: GroupCutoff(0.5, 0.1, 50.0, 2.0))
    mouth: GroupCutoff = field(default_factory=lambda: GroupCutoff(0.5, 0.1, 50.0, 2.0))
    gaze_noise_rad: float = 0.006
    turn_noise_rad: float = 0.003
    place_noise_mm: float = 0.1
    depth_factor: float = 6.0
    taste_factor: float = 3.0
    longest_step_s: float = 0.3


class GroupFilter:
    """Filters the faces of a video; remembers the last one."""

    def __init__(self, settings: FilterSettings | None = None) -> None:
        self._settings = settings or FilterSettings()
        self._order, self._starts = group_order()
        self._noise = noise_of(self._settings)
        size = len(self._noise)
        self._new, self._held, self._speed = np.zeros(size), np.zeros(size), np.zeros(size)
        self._rotation, self._turn = np.array([1.0, 0, 0, 0]), np.zeros(3)
        self._table = self.table(Steadiness())
        self._fresh = True

    def table(self, taste: Steadiness) -> FloatArray:
        """Return the kernel's settings (G, 4) for a taste."""
        rows = []
        for name, whose in TASTES.items():
            group: GroupCutoff = getattr(self._settings, name)
            # At 1 nothing is filtered at all: 1 kHz passes everything in one frame.
            liking = getattr(taste, whose)
            factor = self._settings.taste_factor ** (2 * liking - 1) if liking < 1 else 1e3
            quiet = group.quiet_speed * self._settings.taste_factor ** (0.5 - liking)
            rows.append([
                group.cutoff_hz * factor, group.cutoff_per_speed * factor, quiet,
                group.speed_cutoff_hz,
            ])  # fmt: skip
        return np.array(rows)

    def use(self, table: FloatArray) -> None:
        """Filter by another table from now on."""
        self._table = table

    def reset(self) -> None:
        """Forget the last face: the next one passes unchanged."""
        self._fresh = True

    def step(
        self, rotation_wxyz: FloatArray, place_mm: FloatArray, expression: FloatArray,
        gaze_rad: FloatArray, step_s: float,
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:  # fmt: skip
        """Return the filtered rotation (4,), place (3,), expression (B,) and gaze (2, 2).

        Args:
            rotation_wxyz: (4,).
            place_mm: (3,).
            expression: (B,).
            gaze_rad: (2, 2).
            step_s: Time since the last face; not above 0 starts anew.
        """
        new, held = self._new, self._held
        new[:N_COEFFICIENTS], new[GAZE], new[PLACE] = expression, gaze_rad.ravel(), place_mm
        if self._fresh or not 0 < step_s <= self._settings.longest_step_s:
            self._fresh = False
            held[:], self._speed[:], self._rotation[:] = new, 0, rotation_wxyz
        else:
            # The turn counts from the filtered rotation, which is where it is held at 0.
            rotation_between(self._rotation, rotation_wxyz, self._turn)
            new[TURN], held[TURN] = self._turn, 0
            follow_groups(
                new, self._order, self._starts, self._noise, self._table, step_s, self._speed, held
            )
            rotate_by(self._rotation, held[TURN])
        return (
            self._rotation.copy(), held[PLACE].copy(), held[:N_COEFFICIENTS].copy(),
            held[GAZE].reshape(2, 2).copy(),
        )  # fmt: skip


def group_of(name: str) -> str:
    """Return the filter group of a coefficient."""
    if name.startswith("brow"):
        return "brows"
    return "eyes" if name.startswith("eye") else "mouth"


def group_order() -> tuple[I32, I32]:
    """Return the values (D,) sorted by group, and the first of each group (G+1,) in them."""
    members: dict[str, list[int]] = {name: [] for name in TASTES}
    for index, name in enumerate(EXPRESSION_NAMES):
        members[group_of(name)].append(index)
    members["eyes"] += range(GAZE.start, GAZE.stop)
    members["turn"] += range(TURN.start, TURN.stop)
    members["place"] += range(PLACE.start, PLACE.stop)
    sizes = [len(one) for one in members.values()]
    order = np.concatenate(list(members.values())).astype(np.int32)
    return order, np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32)


def noise_of(settings: FilterSettings) -> FloatArray:
    """Return the size of the noise (D,) of every value."""
    noise = np.full(PLACE.stop, OTHER_NOISE)
    for index, name in enumerate(EXPRESSION_NAMES):
        starts = (size for start, size in NOISE.items() if name.startswith(start))
        noise[index] = next(starts, OTHER_NOISE)
    noise[GAZE], noise[TURN] = settings.gaze_noise_rad, settings.turn_noise_rad
    noise[PLACE] = settings.place_noise_mm
    noise[PLACE.stop - 1] *= settings.depth_factor
    return noise
