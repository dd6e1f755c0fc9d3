"""The offline story: pictures and their landmarks in, a user's face model and regressor out.

pictures -> landmarks -> camera -> model fit -> blendshapes -> 3D shapes -> regressor
"""

from collections.abc import Collection, Generator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np

from core.blendshapes import user_blendshapes
from core.blind_pictures import Pictures, Placed, Sorting, sort_pictures, with_guesses
from core.calibration import Before, CalibrationSettings, FocalEstimate, estimate_focal
from core.camera import camera_for
from core.errors import CoreError
from core.evaluation import TABLE_WIDTH_PX
from core.expression_sight import sight_of
from core.eye_reader import EyeReader
from core.eye_trainer import EyePictures, train_eyes
from core.face_model import FaceModel, eye_centers_mm
from core.held_out import held_out_report
from core.held_out_pairs import HeldOutSettings, Measured, StageCurves, all_watched
from core.model_fit import FitSettings, fit_model
from core.records import (
    U8,
    Camera,
    Landmarks2D,
    ModelFit,
    Progress,
    SetupImages,
    SetupShapes,
    UserBlendshapes,
)
from core.regressor import FernRegressor
from core.regressor_trainer import TrainSettings, train
from core.shape_recovery import RecoverySettings, recover_shapes
from core.tracker import BLINKS
from core.training_set import TrainingSetSettings, make_training_set
from core.weak_expressions import Shown, weak_expressions

T = TypeVar("T")

#: With fewer usable pictures a regressor cannot be trained or tested.
LEAST_PICTURES = 10

#: What share of the whole work each stage takes, measured on 60 pictures.
SHARES = {"calibrate": 0.17, "fit": 0.03, "recover": 0.01, "held_out": 0.33, "train": 0.46}
STEPS = 1000


class FewPicturesError(CoreError):
    """Too few setup pictures show a face well enough."""

    def __init__(self, usable: int, given: int) -> None:
        self.usable, self.given = usable, given
        super().__init__(
            f"{usable} of {given} setup pictures show a face well enough, at least "
            f"{LEAST_PICTURES} are needed: add pictures with better light, or a longer video"
        )


@dataclass(frozen=True, slots=True)
class BuildSettings:
    """The settings of every stage.

    Attributes:
        before: What an earlier training of this person found, to begin with; None: nothing.
    """

    fit: FitSettings = field(default_factory=FitSettings)
    calibration: CalibrationSettings = field(default_factory=CalibrationSettings)
    recovery: RecoverySettings = field(default_factory=RecoverySettings)
    training_set: TrainingSetSettings = field(default_factory=TrainingSetSettings)
    train: TrainSettings = field(default_factory=TrainSettings)
    held_out: HeldOutSettings = field(default_factory=HeldOutSettings)
    before: Before | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Built:
    """Everything that a profile keeps.

    Attributes:
        camera: Of the setup pictures.
        images: The pictures used, and those whose landmarks are guessed.
        landmarks: Their landmarks.
        fit: The bilinear model fitted to them; rows of guessed ones are what is expected.
        user: The user's blendshapes.
        shapes: The 3D shape of every picture.
        regressor: Trained on all that are not guessed.
        eyes: What reads the gaze, None if too few eyes are seen.
        report: Figures for people, JSON-ready.
    """

    camera: Camera
    images: SetupImages
    landmarks: tuple[Landmarks2D, ...]
    fit: ModelFit
    user: UserBlendshapes
    shapes: SetupShapes
    regressor: FernRegressor
    eyes: EyeReader | None
    report: dict[str, object]


def gray_from_rgb(rgb: U8) -> U8:
    """Return the grey levels (H, W) of a picture (H, W, 3): ITU-R BT.601 luma, in integers."""
    weights = np.array([77, 150, 29], np.uint32)
    return np.asarray((rgb @ weights + 128) >> 8, dtype=np.uint8)


def usable_pictures(
    images: SetupImages, landmarks: Sequence[Landmarks2D]
) -> tuple[SetupImages, tuple[Landmarks2D, ...], Sorting]:
    """Return the pictures whose landmarks can be fitted, and what becomes of the others.

    Raises:
        FewPicturesError: Too few are left.
    """
    sorting = sort_pictures(images.names, landmarks)
    if len(sorting.fitted) < LEAST_PICTURES:
        raise FewPicturesError(len(sorting.fitted), len(landmarks))
    return (*_chosen(images, landmarks, sorting.fitted), sorting)


def _chosen(
    images: SetupImages, landmarks: Sequence[Landmarks2D], rows: Sequence[int]
) -> tuple[SetupImages, tuple[Landmarks2D, ...]]:
    """Return some of the pictures and their landmarks."""
    chosen = SetupImages(
        tuple(images.images[n] for n in rows),
        tuple(images.names[n] for n in rows),
        images.standard[list(rows)],
    )
    return chosen, tuple(landmarks[n] for n in rows)


def build(
    model: FaceModel, images: SetupImages, landmarks: Sequence[Landmarks2D],
    focal_px: float | None, rng: np.random.Generator, settings: BuildSettings | None = None,
) -> Generator[Progress, None, Built]:  # fmt: skip
    """Make a user's model and regressor from pictures with landmarks.

    Args:
        model: The bilinear face model.
        images: The setup pictures.
        landmarks: Their landmarks. Pictures with too few trusted ones are not trained on; if
            they are prompted they are kept, their landmarks guessed.
        focal_px: Focal length if it is known, else it is found.
        rng: Source of all random choices.
        settings: Settings of every stage.

    Yields:
        Progress of the whole work, `total` steps in all.

    Returns:
        All that a profile keeps.

    Raises:
        FewPicturesError: Too few pictures show a face.
        FocalNotBracketedError: No focal length explains the pictures.
    """
    settings = settings or BuildSettings()
    given, found = images, tuple(landmarks)
    images, landmarks, sorting = usable_pictures(given, found)
    height, width = images.images[0].shape[:2]
    stages = _Stages(set() if focal_px is None else {"calibrate"})
    standard = images.standard
    if focal_px is None:
        search = estimate_focal(
            model, (width, height), landmarks, standard, settings.calibration, settings.before
        )
        focal = yield from stages.run("calibrate", search)
    else:
        focal = known_focal((width, height), focal_px)
    camera = focal.camera
    fit = yield from stages.run("fit", fit_model(model, camera, landmarks, settings.fit, standard))
    user = user_blendshapes(model, fit)
    shapes = yield from stages.run(
        "recover",
        recover_shapes(model, user, camera, landmarks, fit, standard, settings.recovery),
    )
    gray = tuple(gray_from_rgb(image) for image in images.images)
    training = (settings.training_set, settings.train)
    tested = Measured(images.names, gray, camera, shapes)
    held_out = yield from stages.run(
        "held_out", held_out_report(tested, rng, training, settings.held_out)
    )
    samples = make_training_set(gray, camera, shapes.points_mm, rng, settings.training_set)
    curves = StageCurves(tested.px_at_640)
    steps = train(samples, rng, settings.train, all_watched(tested, rng, settings.held_out))
    regressor = yield from stages.run("train", curves.follow(steps))
    report = _report(focal, images, fit, shapes) | {"held_out": held_out, "stages": curves.told}
    report |= _unfitted(given, sorting)
    report["weak_expressions"] = _weak(model, user, tested, report)
    kept, before = _chosen(given, found, sorting.kept)
    pictures = Pictures(kept.names, tuple(gray_from_rgb(one) for one in kept.images), before)
    placed = with_guesses(model, user, camera, pictures, Placed(landmarks, fit, shapes))
    eyes = train_eyes(eye_pictures(model, user, camera, gray, landmarks, shapes), rng)
    return Built(
        camera, kept, placed.landmarks, placed.fit, user, placed.shapes, regressor, eyes, report
    )


def eye_pictures(
    model: FaceModel, user: UserBlendshapes, camera: Camera, gray: Sequence[U8],
    landmarks: Sequence[Landmarks2D], shapes: SetupShapes,
) -> EyePictures:  # fmt: skip
    """Return the setup pictures as the gaze is learned from them."""
    radii_mm = np.full(2, float(model.eyeball_radius_mm))
    centers_mm = eye_centers_mm(model, user.neutral_mm)
    blinks = shapes.coefficients[:, BLINKS]
    return EyePictures(gray, camera, landmarks, shapes, blinks, centers_mm, radii_mm)


def known_focal(size_px: tuple[int, int], focal_px: float) -> FocalEstimate:
    """Return the estimate of a focal length that need not be searched."""
    return FocalEstimate(camera_for(size_px, focal_px), 0.0, np.empty(0), np.empty(0))


LABELS = {
    "calibrate": "Finding the focal length",
    "fit": "Fitting the face model",
    "recover": "Recovering 3D shapes",
    "held_out": "Testing on held-out pictures",
    "train": "Training the regressor",
}


def stage_shares(focal_known: bool) -> dict[str, float]:
    """Return the label of each stage in its order, and its share of the whole work."""
    shares = {key: share for key, share in SHARES.items() if key != "calibrate" or not focal_known}
    return {LABELS[key]: share / sum(shares.values()) for key, share in shares.items()}


class _Stages:
    """Turns the progress of each stage into that of the whole."""

    def __init__(self, skipped: Collection[str]) -> None:
        """Share the whole work among the stages that are not skipped."""
        shares = {name: share for name, share in SHARES.items() if name not in skipped}
        self._shares = {name: share / sum(shares.values()) for name, share in shares.items()}
        self._before = 0.0

    def run(self, name: str, steps: Generator[Progress, None, T]) -> Generator[Progress, None, T]:
        """Run a stage to its end."""
        label, reached = LABELS[name], self._before
        yield Progress(round(STEPS * reached), STEPS, label)
        while True:
            try:
                inner = next(steps)
            except StopIteration as end:
                self._before += self._shares[name]
                return end.value  # type: ignore[no-any-return]
            # A search that begins anew does not go back.
            place = self._before + self._shares[name] * inner.done / max(inner.total, 1)
            reached = max(reached, place)
            yield replace(inner, done=round(STEPS * reached), total=STEPS, label=label)


def _weak(
    model: FaceModel, user: UserBlendshapes, pictures: Measured, report: Mapping[str, Any]
) -> list[dict[str, object]]:
    shapes = pictures.shapes
    distance_mm = float(np.median(shapes.translations_mm[:, 2]))
    unused = (*report["guessed"], *report["left_out"])
    return weak_expressions(
        sight_of(model, user, pictures.camera, distance_mm),
        Shown(pictures.names, shapes.coefficients, unused),
    )


def _unfitted(given: SetupImages, sorting: Sorting) -> dict[str, object]:
    return {
        "guessed": [given.names[n] for n in sorting.guessed],
        "left_out": [given.names[n] for n in sorting.left_out],
    }


def _report(
    focal: FocalEstimate, images: SetupImages, fit: ModelFit, shapes: SetupShapes
) -> dict[str, object]:  # fmt: skip
    camera = focal.camera
    scale = TABLE_WIDTH_PX / camera.size_px[0]
    return {
        "pictures": len(images.images),
        "size_px": list(camera.size_px),
        "focal_px": camera.focal_px,
        "focal_source": "found" if len(focal.focals_px) else "given",
        "focal_spread_percent": 100 * focal.spread,
        "focal_curve": [
            [float(px), float(error)]
            for px, error in zip(focal.focals_px, focal.errors, strict=True)
        ],
        "fit_rms_px_at_640": float(scale * np.sqrt(np.mean(fit.rms_px**2))),
        "shape_rms_px_at_640": float(scale * np.sqrt(np.mean(shapes.rms_px**2))),
        "picture_names": list(images.names),
        "picture_rms_px_at_640": (scale * shapes.rms_px).tolist(),
    }
