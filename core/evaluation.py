"""How far a track is from a reference: the figures of the papers, as plain numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.camera import project
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_quaternion,
    rotation_angle_rad,
)
from core.records import BoolArray, Camera, FaceState, FloatArray

#: The limits of [Cao13, table 1], in px of a 640x480 picture.
TABLE_LIMITS_PX = (3.0, 4.5, 6.0)
TABLE_WIDTH_PX = 640


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What is known of a synthetic frame.

    Attributes:
        points_mm: (Q, 3) shape points in the camera frame.
        rotation_wxyz: (4,) model to camera.
        translation_mm: (3,).
        expression: (B,).
        gaze_rad: (2, 2).
    """

    points_mm: FloatArray
    rotation_wxyz: FloatArray
    translation_mm: FloatArray
    expression: FloatArray
    gaze_rad: FloatArray


def frame_rmse_px(points_px: FloatArray, reference_px: FloatArray) -> FloatArray:
    """Return the root mean square landmark distance of every frame, (N,) px.

    Args:
        points_px: (N, L, 2).
        reference_px: (N, L, 2); a frame with a NaN gives NaN.
    """
    squares = np.sum((np.asarray(points_px) - reference_px) ** 2, axis=-1)
    return np.asarray(np.sqrt(np.mean(squares, axis=-1)))


def share_under(errors: FloatArray, limits: Sequence[float]) -> dict[str, float]:
    """Return for every limit the share of the finite errors that lie under it."""
    known = errors[np.isfinite(errors)]
    if known.size == 0:
        return {f"{limit:g}": float("nan") for limit in limits}
    return {f"{limit:g}": float(np.mean(known < limit)) for limit in limits}


def still_frames(reference_px: FloatArray, half_window: int = 4, limit: float = 0.004) -> BoolArray:
    """Return which frames lie in a stretch where the reference face hardly moves, (N,).

    Args:
        reference_px: (N, L, 2) independent landmarks.
        half_window: Frames looked at on both sides.
        limit: Largest travel of the mean landmark position in the window and largest change of
            the face's size, in parts of the face's size.
    """
    center = reference_px.mean(axis=1)
    size = np.sqrt(np.mean(np.sum((reference_px - center[:, None]) ** 2, axis=-1), axis=1))
    still = np.zeros(len(reference_px), bool)
    for n in range(half_window, len(still) - half_window):
        window = slice(n - half_window, n + half_window + 1)
        travel = np.ptp(center[window], axis=0).max()
        still[n] = max(travel, np.ptp(size[window])) < limit * size[n] * (2 * half_window)
    return still


def jitter(values: FloatArray, still: BoolArray) -> float:
    """Return the standard deviation of the noise of a track on still frames.

    The second difference of white noise has six times its variance; slow movement cancels in it.

    Args:
        values: (N, ...) any quantity over time.
        still: (N,) frames to look at; a frame counts if both neighbours are still too.
    """
    inner = still[1:-1] & still[:-2] & still[2:]
    if not inner.any():
        return float("nan")
    second = values[2:] - 2 * values[1:-1] + values[:-2]
    return float(np.sqrt(np.mean(second[inner] ** 2) / 6))


def against_reference(
    states: Sequence[FaceState], reference_px: FloatArray, rows: Sequence[int], width_px: int
) -> dict[str, object]:
    """Return the table of a track against independent 2D landmarks [Cao13, table 1].

    Args:
        states: N solved frames.
        reference_px: (N, len(rows), 2) of the independent aligner, NaN where it found no face.
        rows: Landmarks of the states to compare.
        width_px: Width of the pictures; distances are given for a width of 640 px.
    """
    scale = TABLE_WIDTH_PX / width_px
    points = scale * np.array([state.landmarks_px[list(rows)] for state in states])
    reference_px = scale * reference_px
    lost = np.array([state.lost for state in states])
    rmse = frame_rmse_px(points, reference_px)
    rmse[lost] = np.inf
    seen = np.asarray(np.isfinite(reference_px).all(axis=(1, 2)))
    finite = rmse[np.isfinite(rmse)]
    still = still_frames(np.where(seen[:, None, None], reference_px, 0.0)) & seen & ~lost
    angles = np.rad2deg(
        [head_angles_from_matrix(matrix_from_quaternion(s.rotation_wxyz)) for s in states]
    )
    return {
        "frames": len(states),
        "compared": int(seen.sum()),
        "lost": int(lost.sum()),
        "share_under_px": _share_of_all(rmse, seen),
        "median_rmse_px": float(np.median(finite)) if finite.size else float("nan"),
        "worst_rmse_px": float(finite.max()) if finite.size else float("nan"),
        "still_frames": int(still.sum()),
        "jitter_px": jitter(points, still),
        "jitter_reference_px": jitter(reference_px, still),
        "jitter_rotation_deg": jitter(angles, still),
        "jitter_expression": jitter(np.array([s.expression for s in states]), still),
    }


def _share_of_all(rmse: FloatArray, seen: BoolArray) -> dict[str, float]:
    """Return the shares over all frames that the reference saw; lost frames count as misses."""
    if not seen.any():
        return {f"{limit:g}": float("nan") for limit in TABLE_LIMITS_PX}
    return {f"{limit:g}": float(np.mean(rmse[seen] < limit)) for limit in TABLE_LIMITS_PX}


def against_truth(
    states: Sequence[FaceState], truths: Sequence[Truth], camera: Camera
) -> dict[str, object]:
    """Return the distances of a track from a known truth.

    Depth is compared landmark by landmark. The scale of a face cannot be seen by one camera (a
    larger head further away gives the same picture), so a second figure compares depth after the
    whole track is multiplied by the one factor that fits best.

    Args:
        states: N solved frames.
        truths: N truths.
        camera: The camera that made the pictures.
    """
    kept = [n for n, state in enumerate(states) if not state.lost]
    result: dict[str, object] = {"frames": len(states), "lost": len(states) - len(kept)}
    if not kept:
        return result
    solved = [states[n] for n in kept]
    true = [truths[n] for n in kept]
    n_landmarks = solved[0].landmarks_px.shape[0]
    true_mm = np.array([t.points_mm[:n_landmarks] for t in true])
    rmse = frame_rmse_px(np.array([s.landmarks_px for s in solved]), project(camera, true_mm))
    yaw = _yaw_deg(true)
    turned = {"|yaw|<15": yaw < 15, "15-40": (yaw >= 15) & (yaw < 40), ">=40": yaw >= 40}
    shapes_mm = np.array([s.shape_mm for s in solved])
    depth = depth_errors_mm(shapes_mm, true_mm)
    absolute = np.abs(shapes_mm[..., 2] - true_mm[..., 2]).mean(axis=1)
    rotation = np.rad2deg(
        rotation_angle_rad(
            np.array([s.rotation_wxyz for s in solved]), np.array([t.rotation_wxyz for t in true])
        )
    )
    coefficients = np.abs(
        np.array([s.expression for s in solved]) - np.array([t.expression for t in true])
    )
    gaze = np.rad2deg(np.abs([s.gaze_rad - t.gaze_rad for s, t in zip(solved, true, strict=True)]))
    result |= {
        "rmse_px": _summary(rmse),
        "share_under_px": _share_of_all(rmse, np.ones(len(kept), bool)),
        "depth_mm": _summary(depth[yaw < 40]),
        "depth_without_scale_mm": _summary(absolute[yaw < 40]),
        "rotation_deg": _summary(rotation),
        "coefficients_mean_abs": float(coefficients.mean()),
        "coefficients_active_mean_abs": _active_error(coefficients, true),
        "gaze_deg": _summary(gaze),
        "by_yaw": {
            name: {
                "frames": int(mask.sum()),
                "rmse_px": _summary(rmse[mask]),
                "depth_mm": _summary(depth[mask]),
                "rotation_deg": _summary(rotation[mask]),
            }
            for name, mask in turned.items()
            if mask.any()
        },
    }
    return result


def depth_errors_mm(shapes_mm: FloatArray, true_mm: FloatArray) -> FloatArray:
    """Return the mean depth error of every frame up to the one factor of the face's size, (N,).

    Args:
        shapes_mm: (N, L, 3).
        true_mm: (N, L, 3).
    """
    factor = np.sum(shapes_mm * true_mm) / np.sum(shapes_mm**2)
    return np.asarray(np.abs(factor * shapes_mm[..., 2] - true_mm[..., 2]).mean(axis=1))


def _active_error(coefficients: FloatArray, true: Sequence[Truth]) -> float:
    """Return the mean error of the coefficients that are clearly on in the truth."""
    active = np.array([t.expression for t in true]) > 0.3
    return float(coefficients[active].mean()) if active.any() else float("nan")


def _yaw_deg(true: Sequence[Truth]) -> FloatArray:
    matrices = [matrix_from_quaternion(t.rotation_wxyz) for t in true]
    return np.abs(np.rad2deg([head_angles_from_matrix(m)[0] for m in matrices]))


def _summary(values: FloatArray) -> dict[str, float]:
    """Return mean, median and the 95 % level."""
    if values.size == 0:
        return {"mean": float("nan"), "median": float("nan"), "p95": float("nan")}
    return {
        "mean": float(values.mean()),
        "median": float(np.median(values)),
        "p95": float(np.quantile(values, 0.95)),
    }
