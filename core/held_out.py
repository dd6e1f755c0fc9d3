"""The report that a setup writes: errors on setup pictures that training did not see."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass

import numpy as np

from core.camera import project
from core.evaluation import TABLE_LIMITS_PX, TABLE_WIDTH_PX, share_under
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
    register_rigid,
)
from core.landmarks import N_LANDMARKS, SHAPE_NAMES
from core.records import U8, Camera, FloatArray, Progress, SetupShapes
from core.regressor import Regression
from core.regressor_trainer import TrainSettings, train
from core.training_set import TrainingSetSettings, make_training_set, similar_shapes

#: Yaw bins of the report, in degrees.
YAW_BINS = ((0.0, 15.0), (15.0, 40.0), (40.0, 95.0))
EYE_CORNERS = (SHAPE_NAMES.index("R_eye_outer"), SHAPE_NAMES.index("L_eye_outer"))


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


def held_out_report(
    images_gray: Sequence[U8], camera: Camera, shapes: SetupShapes, rng: np.random.Generator,
    training: tuple[TrainingSetSettings, TrainSettings], settings: HeldOutSettings,
) -> Generator[Progress, None, dict[str, object]]:  # fmt: skip
    """Train on most pictures, measure on the rest.

    A held-out picture starts from the shape of the most similar training picture, moved to the
    held-out face and disturbed, as the previous frame's shape would be in a video.

    Args:
        images_gray: N pictures.
        camera: Their camera.
        shapes: Their 3D shapes; what the errors are measured against.
        rng: Source of all random choices.
        training: Settings of the training set and of training.
        settings: Settings of the test.

    Yields:
        Progress of the training.

    Returns:
        The figures; distances for pictures 640 px wide.
    """
    n_images = len(images_gray)
    held = np.arange(n_images) % settings.every == settings.every // 2
    kept = np.flatnonzero(~held).tolist()
    training_set = make_training_set(
        [images_gray[n] for n in kept], camera, shapes.points_mm[kept], rng, training[0]
    )
    regressor = yield from train(training_set, rng, training[1])
    regression = Regression(regressor, camera)
    rows: list[tuple[int, FloatArray, FloatArray]] = []
    for n in np.flatnonzero(held).tolist():
        truth = shapes.points_mm[n]
        for start in _starts(shapes.points_mm[kept], truth, rng, settings):
            found = regression.run(images_gray[n], start).points_mm
            rows.append(
                (int(n), _landmark_errors_px(camera, found, truth), _turn_deg(found, truth))
            )
    return _report(camera, shapes, rows)


def _starts(
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


def _landmark_errors_px(camera: Camera, found_mm: FloatArray, truth_mm: FloatArray) -> FloatArray:
    """Return the distance of every landmark (L,) in px of pictures 640 px wide."""
    scale = TABLE_WIDTH_PX / camera.size_px[0]
    both = project(camera, np.stack([found_mm, truth_mm])[:, :N_LANDMARKS])
    return np.asarray(scale * np.linalg.norm(both[0] - both[1], axis=1))


def _turn_deg(found_mm: FloatArray, truth_mm: FloatArray) -> FloatArray:
    """Return the rotation (3,) left between two shapes as head angles in degrees."""
    rotation, _ = register_rigid(truth_mm, found_mm)
    return np.rad2deg(head_angles_from_matrix(rotation))


def _report(
    camera: Camera, shapes: SetupShapes, rows: list[tuple[int, FloatArray, FloatArray]]
) -> dict[str, object]:
    picture = np.array([row[0] for row in rows])
    rmse = np.sqrt(np.mean(np.square([row[1] for row in rows]), axis=1))
    turn = np.abs([row[2] for row in rows])
    scale = TABLE_WIDTH_PX / camera.size_px[0]
    eyes = scale * project(camera, shapes.points_mm[:, EYE_CORNERS])
    # The eyes of a turned head are near each other in the picture; the widest view counts.
    eye_px = float(np.linalg.norm(eyes[:, 0] - eyes[:, 1], axis=1).max())
    matrices = matrix_from_quaternion(shapes.rotations_wxyz)
    yaw = np.abs(np.rad2deg([head_angles_from_matrix(matrix)[0] for matrix in matrices]))[picture]
    by_yaw = {}
    for low, high in YAW_BINS:
        mask = (yaw >= low) & (yaw < high)
        if mask.any():
            by_yaw[f"{low:g}-{high:g} deg"] = {
                "tries": int(mask.sum()),
                "median_rmse_px": float(np.median(rmse[mask])),
                "share_under_px": share_under(rmse[mask], TABLE_LIMITS_PX),
            }
    return {
        "pictures": len(set(picture.tolist())),
        "tries": len(rows),
        "mean_rmse_px": float(rmse.mean()),
        "median_rmse_px": float(np.median(rmse)),
        "mean_percent_of_eye_distance": float(100 * rmse.mean() / eye_px),
        "share_under_px": share_under(rmse, TABLE_LIMITS_PX),
        "mean_turn_deg": dict(
            zip(("yaw", "pitch", "roll"), turn.mean(axis=0).tolist(), strict=True)
        ),
        "by_yaw": by_yaw,
        "worst_pictures": _worst(picture, rmse),
    }


def _worst(picture: FloatArray, rmse: FloatArray, count: int = 5) -> list[dict[str, float]]:
    """Return the held-out pictures with the largest mean error."""
    pictures = np.unique(picture)
    means = np.array([rmse[picture == n].mean() for n in pictures])
    order = np.argsort(-means)[:count]
    return [{"picture": int(pictures[n]), "mean_rmse_px": float(means[n])} for n in order]
