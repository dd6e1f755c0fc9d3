"""Errors of many tries as the few figures of a report: in all, by head turn, by expression."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.evaluation import TABLE_LIMITS_PX, share_under
from core.records import FloatArray

#: Bins of the head's yaw in degrees.
YAW_BINS = ((0.0, 15.0), (15.0, 40.0), (40.0, 95.0))
ANGLES = ("yaw", "pitch", "roll")


def summary(rmse_px: FloatArray, turn_deg: FloatArray, eye_px: float) -> dict[str, object]:
    """Return the figures of all tries.

    Args:
        rmse_px: (T,) RMS landmark distance of every try.
        turn_deg: (T, 3) size of the rotation that is left, as head angles.
        eye_px: Distance of the outer eye corners in the same px.
    """
    return {
        "mean_rmse_px": float(rmse_px.mean()),
        "median_rmse_px": float(np.median(rmse_px)),
        "mean_percent_of_eye_distance": float(100 * rmse_px.mean() / eye_px),
        "share_under_px": share_under(rmse_px, TABLE_LIMITS_PX),
        "mean_turn_deg": dict(zip(ANGLES, turn_deg.mean(axis=0).tolist(), strict=True)),
    }


def by_yaw(yaw_deg: FloatArray, rmse_px: FloatArray, turn_deg: FloatArray) -> dict[str, object]:
    """Return the figures of each bin of the head's yaw in which there are tries.

    Args:
        yaw_deg: (T,) size of the yaw of the picture of every try.
        rmse_px: (T,).
        turn_deg: (T, 3).
    """
    return {
        f"{low:g}-{high:g} deg": _part(rmse_px, turn_deg, mask)
        for low, high in YAW_BINS
        if (mask := (yaw_deg >= low) & (yaw_deg < high)).any()
    }


def by_expression(
    faces: Sequence[str] | NDArray[np.str_], rmse_px: FloatArray, turn_deg: FloatArray
) -> dict[str, object]:
    """Return the figures of each prompted expression, in the order in which they come.

    Args:
        faces: T names of expressions, "" where nothing was prompted.
        rmse_px: (T,).
        turn_deg: (T, 3).
    """
    known = np.asarray(faces)
    return {
        face: _part(rmse_px, turn_deg, known == face)
        for face in dict.fromkeys(known.tolist())
        if face
    }


def _part(rmse_px: FloatArray, turn_deg: FloatArray, mask: NDArray[np.bool_]) -> dict[str, object]:
    return {
        "tries": int(mask.sum()),
        "median_rmse_px": float(np.median(rmse_px[mask])),
        "share_under_px": share_under(rmse_px[mask], TABLE_LIMITS_PX),
        "mean_turn_deg": float(np.linalg.norm(turn_deg[mask], axis=1).mean()),
    }
