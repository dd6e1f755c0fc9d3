"""The people who perform: none is in the face model, and none is quite in its span."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.avatars.looks import LOOKS, Color, Looks
from core.arkit import EXPRESSION_NAMES
from core.errors import CoreError
from core.face_model import FaceModel
from core.records import F32, FloatArray, freeze

#: Around an eye everything moves as one, or lids would cut into eyeballs.
_EYE_MM, _EYE_FADE_MM = 24.0, 26.0


@dataclass(frozen=True, slots=True)
class Role:
    """How one of the people in the file is dressed.

    Attributes:
        row: Number of the person in the file.
        looks: Colours of skin, eyes and brows, hair, shirt.
        cap: Colour of a knitted cap, None without one.
    """

    row: int
    looks: Looks
    cap: Color | None = None


#: Everybody who can perform, by name.
CAST: dict[str, Role] = {
    "mara": Role(0, LOOKS["light"].changed(shirt=(70, 92, 120), freckles=0.25)),
    "tomas": Role(1, LOOKS["olive"].changed(shirt=(112, 60, 52), beard=0.35, age=0.35)),
    "ayo": Role(
        2,
        LOOKS["brown"].changed(shirt=(150, 148, 138), hair_style="cropped"),
        cap=(152, 64, 50),
    ),
}


@dataclass(frozen=True, slots=True, eq=False)
class Person:
    """A face of the model's topology.

    Attributes:
        name: Key of CAST.
        neutral_mm: (V, 3) model frame, origin between the eyeball centres.
        deltas_mm: (B, V, 3) displacement of each expression.
    """

    name: str
    neutral_mm: FloatArray
    deltas_mm: F32

    def __post_init__(self) -> None:
        freeze(
            self,
            neutral_mm=(np.float64, ("V", 3)),
            deltas_mm=(np.float32, (len(EXPRESSION_NAMES), "V", 3)),
        )


class PeopleFileError(CoreError):
    """The file of the performers is not one that this program can use."""

    def __init__(self, path: Path, found: str) -> None:
        self.path, self.found = path, found
        super().__init__(
            f"{path}: found {found}, expected the people of this version; "
            "reinstall, or build them again with python -m assets.build.face_model"
        )


def load_person(path: Path, model: FaceModel, name: str = "mara") -> Person:
    """Return a performer, with small changes of shape that no model knows.

    Args:
        path: app.resources.asset("people.npz").
        model: The topology of the people.
        name: Key of CAST.

    Raises:
        PeopleFileError: The file is missing, broken or of another version.
        ValueError: Nobody has this name.
    """
    if name not in CAST:
        raise ValueError(f"nobody is called {name!r}; the performers are {', '.join(CAST)}")
    try:
        with np.load(path, allow_pickle=False) as data:
            names = tuple(str(known) for known in data["expression_names"])
            neutral = data["neutral_mm"][CAST[name].row].astype(np.float64)
            deltas = data["deltas_mm"][CAST[name].row].astype(np.float32)
    except (OSError, KeyError, ValueError, IndexError) as error:
        raise PeopleFileError(path, str(error)) from error
    if names != EXPRESSION_NAMES or len(neutral) != len(model.mean_mm):
        raise PeopleFileError(path, "other expression names or another topology")
    return unlike_the_model(Person(name, neutral, deltas), model, np.random.default_rng(len(name)))


def unlike_the_model(
    person: Person, model: FaceModel, rng: np.random.Generator, size_mm: float = 0.7
) -> Person:
    """Return the person with smooth changes of shape and of the way the expressions look.

    Args:
        person: To change.
        model: Gives the eyeballs, which stay round and in their lids.
        rng: Source of the changes.
        size_mm: Root mean square of the change of the neutral face.
    """
    places = _steady_around_eyes(person.neutral_mm, model)
    neutral = person.neutral_mm + size_mm * _smooth_field(places, rng, 3)
    stronger = 1 + 0.1 * _smooth_field(places, rng, len(person.deltas_mm))
    index = {name: b for b, name in enumerate(EXPRESSION_NAMES)}
    # Whoever shuts an eye shuts it all the way, and lips close what the jaw has opened.
    stronger[:, [index["eyeBlinkLeft"], index["eyeBlinkRight"]]] = 1.0
    stronger[:, index["mouthClose"]] = stronger[:, index["jawOpen"]]
    deltas = person.deltas_mm * stronger.T[:, :, None]
    origin = neutral[model.eye_center_vertices].mean(axis=0)
    return Person(person.name, neutral - origin, deltas.astype(np.float32))


def _steady_around_eyes(points: FloatArray, model: FaceModel) -> FloatArray:
    """Return (V, 3) places to look a field up: all of an eye's surroundings at its centre."""
    out = points.copy()
    for center in points[model.eye_center_vertices]:
        distance = np.linalg.norm(points - center, axis=1)
        share = np.clip((distance - _EYE_MM) / _EYE_FADE_MM, 0, 1)[:, None]
        share = share * share * (3 - 2 * share)
        out = np.where(share < 1, center + share * (out - center), out)
    return out


def _smooth_field(places: FloatArray, rng: np.random.Generator, n_values: int) -> FloatArray:
    """Return (V, n_values) of unit size that change over some 100 mm."""
    n_waves = 6
    direction = rng.normal(size=(n_values, n_waves, 3))
    direction /= np.linalg.norm(direction, axis=2, keepdims=True)
    waves = direction * (2 * np.pi / rng.uniform(90, 180, (n_values, n_waves, 1)))
    phase = rng.uniform(0, 2 * np.pi, (n_values, n_waves))
    angle = np.einsum("vc,nwc->nwv", places, waves) + phase[..., None]
    return np.asarray(np.sin(angle).sum(axis=1).T / np.sqrt(n_waves / 2))
