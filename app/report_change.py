"""What a training changed against the one before, as rows of a table."""

from collections.abc import Mapping
from statistics import fmean
from typing import Any

Row = tuple[str, str, str, str]


def change_rows(report: Mapping[str, Any]) -> list[Row]:
    """Return rows of what, before, now, and the difference; none without a training before.

    Args:
        report: Of the new training, with that of the last one under "previous".
    """
    before: Mapping[str, Any] = report.get("previous") or {}
    old, new = before.get("held_out") or {}, report.get("held_out") or {}
    if not before:
        return []
    rows = [
        _row("pictures", before.get("pictures"), report.get("pictures"), ".0f"),
        _row("focal length", before.get("focal_px"), report.get("focal_px"), ".0f", " px"),
        _row("points against the fitted face", _fit(before), _fit(report), ".2f", " px"),
        _row("average error", old.get("mean_rmse_px"), new.get("mean_rmse_px"), ".2f", " px"),
        *_same_pictures(old, new),
        *_shares(old, new),
        *_yaws(old, new),
    ]
    return [row for row in rows if row is not None]


def _fit(report: Mapping[str, Any]) -> float | None:
    return report.get("shape_rms_px_at_640")


def _same_pictures(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[Row | None]:
    """Return the error on those test pictures that both trainings were tested on."""
    errors = [
        {one["name"]: one["rmse_px"] for one in held.get("by_picture", [])} for held in (old, new)
    ]
    both = errors[0].keys() & errors[1].keys()
    if not both:
        return []
    means = [fmean(one[name] for name in both) for one in errors]
    what = f"the same on the {len(both)} test pictures of both"
    return [_row(what, means[0], means[1], ".2f", " px")]


def _shares(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[Row | None]:
    was = old.get("share_under_px", {})
    return [
        _row(f"under {limit} px", _hundredfold(was.get(limit)), 100 * share, ".1f", " %")
        for limit, share in new.get("share_under_px", {}).items()
    ]


def _yaws(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[Row | None]:
    was = old.get("by_yaw", {})
    return [
        _row(
            f"median error, head turned {turn.replace(' deg', '°')}",
            was.get(turn, {}).get("median_rmse_px"), facts["median_rmse_px"], ".2f", " px",
        )
        for turn, facts in new.get("by_yaw", {}).items()
    ]  # fmt: skip


def _hundredfold(share: float | None) -> float | None:
    return None if share is None else 100 * share


def _row(
    what: str, before: float | None, now: float | None, form: str, unit: str = ""
) -> Row | None:
    """Return a row; what is not known on one side is a dash, on both there is no row."""
    if before is None and now is None:
        return None
    old, new = ("–" if one is None else f"{one:{form}}{unit}" for one in (before, now))
    if before is None or now is None:
        return what, old, new, ""
    change = f"{now - before:+{form}}"
    return what, old, new, "the same" if not change.strip("+-0.") else f"{change}{unit}"
