"""The report that a setup writes: errors on setup pictures that training did not see."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.camera import project
from core.error_summary import by_expression, by_yaw, summary
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_quaternion,
    register_rigid,
)
from core.held_out_choice import held_out_rows
from core.held_out_pairs import (
    HeldOutSettings,
    Measured,
    StageCurves,
    nearest_of,
    starts_of,
    watched_pairs,
)
from core.landmarks import N_LANDMARKS, SHAPE_NAMES
from core.records import FloatArray, Progress
from core.regressor import Regression
from core.regressor_trainer import TrainSettings, train
from core.setup_plan import shot_of
from core.training_set import (
    TrainingSetSettings,
    make_training_set,
)

EYE_CORNERS = (SHAPE_NAMES.index("R_eye_outer"), SHAPE_NAMES.index("L_eye_outer"))


@dataclass(frozen=True, slots=True, eq=False)
class Try:
    """One start on one held-out picture.

    Attributes:
        picture: Number of the picture.
        errors_px: (L,) distance of every landmark, in px of pictures 640 px wide.
        turn_deg: (3,) rotation that is left, as head angles.
    """

    picture: int
    errors_px: FloatArray
    turn_deg: FloatArray


def held_out_report(
    pictures: Measured, rng: np.random.Generator,
    training: tuple[TrainingSetSettings, TrainSettings], settings: HeldOutSettings,
) -> Generator[Progress, None, dict[str, object]]:  # fmt: skip
    """Train on most pictures, measure on the rest.

    A held-out picture starts from the shape of the most similar training picture, moved to the
    held-out face and disturbed, as the previous frame's shape would be in a video.

    Args:
        pictures: All of them.
        rng: Source of all random choices.
        training: Settings of the training set and of training.
        settings: Settings of the test.

    Yields:
        Progress of the training, with the error in px of pictures 640 px wide after each stage on
        pictures that are trained on and on held-out ones, from starts that are drawn alike.

    Returns:
        The figures; distances for pictures 640 px wide.
    """
    held = held_out_rows(pictures.names, settings.every)
    kept = [n for n in range(len(pictures.names)) if n not in set(held)]
    shapes_mm = pictures.shapes.points_mm
    training_set = make_training_set(
        [pictures.grays[n] for n in kept], pictures.camera, shapes_mm[kept], rng, training[0]
    )
    # Of its own, so that the regressor is the same whether it is watched or not.
    own = rng.spawn(1)[0]
    alike = nearest_of(shapes_mm, held, kept)
    watched = {
        "training_px": watched_pairs(pictures, alike, kept, own, settings),
        "held_out_px": watched_pairs(pictures, held, kept, own, settings),
    }
    curves = StageCurves(pictures.px_at_640)
    regressor = yield from curves.follow(train(training_set, rng, training[1], watched))
    regression = Regression(regressor, pictures.camera)
    tries = []
    for n in held:
        for start in starts_of(shapes_mm[kept], shapes_mm[n], rng, settings):
            found = regression.run(pictures.grays[n], start).points_mm
            tries.append(_try(pictures, n, found))
    return _report(pictures, tries) | {"stages": curves.told}


def _try(pictures: Measured, n: int, found_mm: FloatArray) -> Try:
    truth_mm = pictures.shapes.points_mm[n]
    both = project(pictures.camera, np.stack([found_mm, truth_mm])[:, :N_LANDMARKS])
    errors_px = pictures.px_at_640 * np.linalg.norm(both[0] - both[1], axis=1)
    return Try(n, errors_px, _turn_deg(found_mm, truth_mm))


def _turn_deg(found_mm: FloatArray, truth_mm: FloatArray) -> FloatArray:
    """Return the rotation (3,) left between two shapes as head angles in degrees."""
    rotation, _ = register_rigid(truth_mm, found_mm)
    return np.rad2deg(head_angles_from_matrix(rotation))


def _report(pictures: Measured, tries: Sequence[Try]) -> dict[str, object]:
    picture = np.array([one.picture for one in tries])
    rmse = np.sqrt(np.mean(np.square([one.errors_px for one in tries]), axis=1))
    turn = np.abs([one.turn_deg for one in tries])
    eye_px = eye_distance_px(pictures)
    return summary(rmse, turn, eye_px) | {
        "pictures": len(set(picture.tolist())),
        "tries": len(tries),
        "eye_distance_px": eye_px,
        "by_yaw": by_yaw(yaws_deg(pictures)[picture], rmse, turn),
        "by_expression": by_expression(faces_of(pictures)[picture], rmse, turn),
        "by_picture": [
            {
                "name": pictures.names[n],
                "rmse_px": float(rmse[picture == n].mean()),
                "turn_deg": float(np.linalg.norm(turn[picture == n], axis=1).mean()),
            }
            for n in np.unique(picture)
        ],
        "worst_pictures": _worst(picture, rmse),
    }


def yaws_deg(pictures: Measured) -> FloatArray:
    """Return how far the head is turned sideways in every picture, (N,)."""
    matrices = matrix_from_quaternion(pictures.shapes.rotations_wxyz)
    return np.abs(np.rad2deg([head_angles_from_matrix(one)[0] for one in matrices]))


def faces_of(pictures: Measured) -> NDArray[np.str_]:
    """Return the name of the prompted expression of every picture (N,), "" without a prompt."""
    shots = [shot_of(name) for name in pictures.names]
    return np.array(["" if shot is None else shot.expression_name for shot in shots])


def eye_distance_px(pictures: Measured) -> float:
    """Return the distance of the outer eye corners in px of pictures 640 px wide.

    The eyes of a turned head are near each other in the picture; the widest view counts.
    """
    eyes = project(pictures.camera, pictures.shapes.points_mm[:, EYE_CORNERS])
    return float(pictures.px_at_640 * np.linalg.norm(eyes[:, 0] - eyes[:, 1], axis=1).max())


def _worst(picture: FloatArray, rmse: FloatArray, count: int = 5) -> list[dict[str, float]]:
    """Return the held-out pictures with the largest mean error."""
    pictures = np.unique(picture)
    means = np.array([rmse[picture == n].mean() for n in pictures])
    order = np.argsort(-means)[:count]
    return [{"picture": int(pictures[n]), "mean_rmse_px": float(means[n])} for n in order]
