"""Starts on pictures, and their errors stage by stage while a regressor is trained."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.augmentation import AugmentationSettings
from core.evaluation import TABLE_WIDTH_PX
from core.fern_regressor import FernRegressor
from core.geometry import matrix_from_head_angles
from core.records import U8, Camera, FloatArray, Progress, SetupShapes
from core.training_set import (
    TrainingSet,
    TrainingSetSettings,
    make_training_set,
    similar_shapes,
)
from core.turned_views import TurnSettings

#: Every picture once, as it is.
_PLAIN = TrainingSetSettings(
    n_translations=1, n_similar=1, n_guesses=1, turning=TurnSettings(further_deg=()),
    augmentation=AugmentationSettings(exposure=0.0, lamp_share=0.0, occluded_share=0.0),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class HeldOutSettings:
    """How the held-out test is made.

    Attributes:
        every: Each so many-th picture is held out.
        starts: Starting shapes tried on each held-out picture.
        shift_mm: Standard deviation of a start's displacement.
        turn_rad: Standard deviation of a start's rotation about each axis.
    """

    every: int = 5
    starts: int = 5
    shift_mm: float = 6.0
    turn_rad: float = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """Pictures that a regressor is trained and tested on.

    Attributes:
        names: N file stems.
        grays: (H, W) grey levels.
        camera: Their camera.
        shapes: Their 3D shapes; what the errors are measured against.
    """

    names: tuple[str, ...]
    grays: tuple[U8, ...]
    camera: Camera
    shapes: SetupShapes

    @property
    def px_at_640(self) -> float:
        """Return what makes px of these pictures px of pictures 640 px wide."""
        return TABLE_WIDTH_PX / self.camera.size_px[0]


def all_watched(
    pictures: Measured, rng: np.random.Generator, settings: HeldOutSettings
) -> dict[str, TrainingSet]:
    """Return what shows how a training on all pictures gets on: pairs on some of them.

    Args:
        pictures: All of them.
        rng: Goes on as if nothing had been drawn.
        settings: Of the test.
    """
    rows = range(0, len(pictures.names), max(settings.every // 2, 1))
    known = range(len(pictures.names))
    return {"all_px": watched_pairs(pictures, rows, known, rng.spawn(1)[0], settings)}


def nearest_of(shapes_mm: FloatArray, rows: Sequence[int], others: Sequence[int]) -> list[int]:
    """Return those of the others that are most like one of the rows, each once."""
    allowed, order = set(others), similar_shapes(shapes_mm, len(shapes_mm))
    nearest = [next(int(n) for n in order[row] if int(n) in allowed) for row in rows]
    return sorted(set(nearest))


def watched_pairs(
    pictures: Measured, rows: Sequence[int], known: Sequence[int], rng: np.random.Generator,
    settings: HeldOutSettings,
) -> TrainingSet:  # fmt: skip
    """Return pairs of start and truth on some pictures, in their own light.

    Args:
        pictures: All of them.
        rows: Those to start on.
        known: Those whose shapes serve as starts, though not on themselves.
        rng: Source of the disturbances.
        settings: Of the test.
    """
    shapes_mm, starts = pictures.shapes.points_mm, []
    for n in rows:
        others = [other for other in known if other != n]
        starts += starts_of(shapes_mm[others], shapes_mm[n], rng, settings)
    plain = make_training_set(
        [pictures.grays[n] for n in rows], pictures.camera, shapes_mm[list(rows)], rng, _PLAIN
    )
    image = np.repeat(np.arange(len(rows), dtype=np.int32), settings.starts)
    augmentation = plain.augmentation
    calm = {
        key: np.resize(
            getattr(augmentation, key), (len(image), getattr(augmentation, key).shape[1])
        )
        for key in ("exposure", "lamp", "occluder")
    }
    return replace(
        plain,
        image=image,
        shift_mm=np.zeros((len(image), 3), np.float32),
        truth_mm=shapes_mm[list(rows)][image].astype(np.float32),
        guess_mm=np.array(starts, np.float32),
        augmentation=replace(augmentation, **calm),
    )


class StageCurves:
    """Keeps the errors of watched pairs after each stage, scaled to pictures 640 px wide."""

    def __init__(self, px_at_640: float) -> None:
        self._scale = px_at_640
        self.told: dict[str, list[float]] = {}

    def follow(
        self, steps: Generator[Progress, None, FernRegressor]
    ) -> Generator[Progress, None, FernRegressor]:
        """Pass a training through."""
        while True:
            try:
                step = next(steps)
            except StopIteration as end:
                return end.value  # type: ignore[no-any-return]
            errors = {
                key: self._scale * value for key, value in step.plot.items() if key.endswith("_px")
            }
            for key, value in errors.items():
                self.told.setdefault(key, []).append(value)
            yield replace(step, plot=step.plot | errors)


def starts_of(
    known_mm: FloatArray, truth_mm: FloatArray, rng: np.random.Generator, settings: HeldOutSettings
) -> list[FloatArray]:
    """Return disturbed shapes of the most similar known picture at the held-out face."""
    shapes = np.concatenate([truth_mm[None], known_mm])
    # The picture itself comes first, the most similar other one second.
    nearest = shapes[similar_shapes(shapes, 2)[0, 1]]
    centred = nearest - nearest.mean(axis=0)
    starts = []
    for _ in range(settings.starts):
        turn = matrix_from_head_angles(*rng.normal(0, settings.turn_rad, 3))
        shift = rng.normal(0, settings.shift_mm, 3)
        starts.append(centred @ turn.T + truth_mm.mean(axis=0) + shift)
    return starts
