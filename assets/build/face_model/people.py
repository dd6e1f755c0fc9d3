"""Generated people: macro targets for age, gender and ethnicity, plus small local targets."""

from dataclasses import dataclass

import numpy as np

from assets.build.face_model.head import Head
from assets.build.face_model.source import Wheel

RACES = ("african", "asian", "caucasian")
FOLDERS = ("head", "forehead", "eyes", "eyebrows", "nose", "mouth", "cheek", "chin", "ears", "neck")
#: Standard deviation of the local knobs of a folder; larger ones make angry or odd faces.
SIGMA = {
    "head": 0.15, "forehead": 0.14, "eyes": 0.22, "eyebrows": 0.2, "nose": 0.18, "mouth": 0.2,
    "cheek": 0.3, "chin": 0.25, "ears": 0.25, "neck": 0.2, "asym": 0.12,
}  # fmt: skip
#: Knobs that move or scale whole heads and necks, or belong to other species.
UNUSED = ("head-trans", "neck-trans", "head-age", "head-angle", "ear-shape", "measure-neck-height")
#: Knobs that only the people of people.npz use: the model has never seen them.
HELD_OUT = (
    "chin-cleft", "chin-triangle", "nose-greek", "nose-septumangle", "mouth-laugh-lines",
    "mouth-cupidsbow-width", "eye-bag-height", "eye-eyefold-concave", "eye-eyefold-convex",
    "head-diamond", "forehead-nubian", "cheek-inner", "ear-flap",
)  # fmt: skip
#: Knobs that add up to cone-shaped skulls, and the share of their folder's deviation they get.
TAMED, TAMED_SHARE = ("head-scale-vert", "forehead-scale-vert", "forehead-temple"), 0.4
#: Middle of some knobs: the source's average nose and chin are smaller and its eyes higher than
#: those of the mean face that face trackers use.
CENTER = {
    "nose-scale-depth-incr": 0.3, "nose-trans-forward": 0.2, "nose-curve-convex": 0.15,
    "chin-prominent-incr": 0.2, "chin-prognathism-incr": 0.1, "l-eye-trans-up": -0.15,
}  # fmt: skip
ENDS = (
    ("decr", "incr"), ("down", "up"), ("in", "out"), ("backward", "forward"),
    ("compress", "uncompress"), ("concave", "convex"), ("lower", "higher"),
)  # fmt: skip


@dataclass(frozen=True)
class Knob:
    """One local change: (side prefix or none) targets for negative and positive values."""

    name: str
    folder: str
    low: tuple[str, ...]
    high: tuple[str, ...]

    def at(self, value: float) -> dict[str, float]:
        """Return the weight of each target when the knob is turned to a value."""
        return dict.fromkeys(self.high if value > 0 else self.low, abs(value))

    @property
    def held_out(self) -> bool:
        """Return whether only the people outside the model use it."""
        return any(part in self.name for part in HELD_OUT)


def local_knobs(wheel: Wheel) -> list[Knob]:
    """Return all symmetric knobs; l- and r- targets are turned together."""
    knobs = []
    for folder in FOLDERS:
        names = set(wheel.target_names(folder))
        for name in sorted(names):
            if name.startswith("r-") or any(part in name for part in UNUSED):
                continue
            knob = knob_of(name, folder, names)
            if knob:
                knobs.append(knob)
    return knobs


def knob_of(name: str, folder: str, names: set[str]) -> Knob | None:
    """Return the knob whose positive end is this target, None if it is a negative end."""
    stem, _, end = name.rpartition("-")
    if any(end == low and f"{stem}-{high}" in names for low, high in ENDS):
        return None
    low = next((f"{stem}-{low}" for low, high in ENDS if end == high), None)

    def paths(target: str | None) -> tuple[str, ...]:
        if target is None or target not in names:
            return ()
        both = (target, "r-" + target[2:]) if target.startswith("l-") else (target,)
        return tuple(f"{folder}/{t}" for t in both)

    return Knob(name, folder, paths(low), paths(name))


def macro_weights(age: float, gender: float, races: np.ndarray, build: tuple[float, float]) -> dict:
    """Return the weight of every macro target.

    Args:
        age: 0.19 (a child) to 1 (old), 0.5 young.
        gender: 0 female, 1 male.
        races: (3,) share of each of RACES.
        build: Muscle and weight in [0, 1], 0.5 average.
    """
    old = max(0.0, 2 * age - 1)
    child = max(0.0, (0.5 - age) / 0.3125)
    ages = {"child": child, "old": old, "young": 1 - child - old}
    genders = {"female": 1 - gender, "male": gender}
    muscles, weights = (
        ends(value, kind) for value, kind in zip(build, ("muscle", "weight"), strict=True)
    )
    out = {}
    for a, wa in ages.items():
        for g, wg in genders.items():
            for race, wr in zip(RACES, races, strict=True):
                out[f"macrodetails/{race}-{g}-{a}"] = wa * wg * wr
            for m, wm in muscles.items():
                for w, ww in weights.items():
                    out[f"macrodetails/universal-{g}-{a}-{m}-{w}"] = wa * wg * wm * ww
    return {name: value for name, value in out.items() if value > 0}


def ends(value: float, kind: str) -> dict[str, float]:
    """Return the weights of the min, average and max targets of muscle or weight."""
    low, high = max(0.0, 1 - 2 * value), max(0.0, 2 * value - 1)
    return {f"min{kind}": low, f"average{kind}": 1 - low - high, f"max{kind}": high}


def average_person(wheel: Wheel) -> dict[str, float]:
    """Return the weights of a young adult between all groups: the head we sculpt on."""
    out = macro_weights(0.52, 0.5, np.full(3, 1 / 3), (0.5, 0.5))
    for knob in local_knobs(wheel):
        out |= knob.at(CENTER.get(knob.name, 0.0))
    return out


def random_macro(rng: np.random.Generator) -> dict[str, float]:
    """Return the macro weights of a random adult or teenager."""
    age = float(np.clip(rng.beta(1.6, 2.2) * 0.58 + 0.40, 0.40, 0.98))
    gender = float(np.clip(rng.choice([0.12, 0.88]) + rng.normal(0, 0.12), 0, 1))
    races = rng.dirichlet([0.45, 0.45, 0.45])
    muscle = float(np.clip(rng.normal(0.5, 0.14), 0.15, 0.85))
    weight = float(np.clip(rng.normal(0.5, 0.16), 0.12, 0.9))
    return macro_weights(age, gender, races, (muscle, weight))


def random_locals(wheel: Wheel, rng: np.random.Generator, held_out: bool) -> dict[str, float]:
    """Return random weights of local targets and of slight asymmetries."""
    out: dict[str, float] = {}
    for knob in local_knobs(wheel):
        sigma = SIGMA[knob.folder] * (TAMED_SHARE if knob.name.startswith(TAMED) else 1.0)
        value = CENTER.get(knob.name, 0.0) + rng.normal(0, sigma)
        if held_out or not knob.held_out:
            out |= knob.at(float(np.clip(value, -0.6, 0.6)))
    for name in wheel.target_names("asym"):
        if not name.startswith("asymm"):
            out[f"asym/{name}"] = abs(float(np.clip(rng.normal(0, SIGMA["asym"]), -0.4, 0.4)))
    return out


def neutral_of(wheel: Wheel, head: Head, weights: dict[str, float]) -> np.ndarray:
    """Return the neutral face (V, 3) mm, origin between the eyes."""
    base = head.base_mm.copy()
    for name, weight in weights.items():
        base += weight * wheel.target_mm(name)
    points = head.take(base)
    return points - points[-2:].mean(axis=0)


def make_people(
    wheel: Wheel, head: Head, rng: np.random.Generator, count: int, held_out: bool = False
) -> np.ndarray:
    """Return the neutral faces of random people, (count, V, 3) mm."""
    return np.stack([
        neutral_of(wheel, head, random_macro(rng) | random_locals(wheel, rng, held_out))
        for _ in range(count)
    ])  # fmt: skip
