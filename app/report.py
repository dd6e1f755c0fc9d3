"""The report of a training for people, as HTML."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

#: [Cao13, table 1]: share of frames with RMSE under 3, 4.5 and 6 px.
PAPER = {"3": 0.733, "4.5": 0.808, "6": 1.0}
WEAK = "cheeks, nose wrinkles, squints and pressed lips"

STYLE = (
    "<style>body{font-family:sans-serif;margin:2em;max-width:46em}"
    "table{border-collapse:collapse}td,th{padding:3px 12px;text-align:left}</style>"
)


def report_html(name: str, report: Mapping[str, Any], whole: bool = False) -> str:
    """Return a report; names of pictures are links.

    Args:
        name: Of the profile.
        report: As core.pipeline makes it.
        whole: Return a file of its own, not only what stands in its body.
    """
    held: Mapping[str, Any] = report.get("held_out") or {}
    parts = [f"<h2>{escape(name)}</h2>", _summary(report, held)]
    if held:
        parts += [_shares(held), _by_yaw(held), _worst(report, held)]
    parts.append(
        f"<p>Hardly seen by landmarks, and so kept small unless they are clear: {WEAK}.</p>"
    )
    body = "".join(parts)
    if not whole:
        return body
    title = escape(f"facepuppet: {name}")
    return (
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{title}</title>"
        f"{STYLE}</head><body>{body}</body></html>"
    )


def _summary(report: Mapping[str, Any], held: Mapping[str, Any]) -> str:
    lines = [f"{report.get('pictures', 0)} pictures"]
    if report.get("left_out"):
        lines.append("left out: " + escape(", ".join(report["left_out"])))
    if report.get("focal_px"):
        lines.append(f"focal length {report['focal_px']:.0f} px ({report['focal_source']})")
    if held:
        turn = held["mean_turn_deg"]
        lines.append(
            f"on pictures kept for testing: landmarks {held['mean_rmse_px']:.2f} px off on average "
            f"({held['mean_percent_of_eye_distance']:.1f} % of the eye distance), head "
            f"{turn['yaw']:.1f}° yaw, {turn['pitch']:.1f}° pitch, {turn['roll']:.1f}° roll"
        )
    return "<ul>" + "".join(f"<li>{line}</li>" for line in lines) + "</ul>"


def _shares(held: Mapping[str, Any]) -> str:
    rows = [
        (f"under {limit} px", f"{100 * share:.1f} %", _percent(PAPER.get(limit)))
        for limit, share in held["share_under_px"].items()
    ]
    return _table(("test pictures", "here", "[Cao13, table 1]"), rows)


def _by_yaw(held: Mapping[str, Any]) -> str:
    rows = [
        (escape(turn), f"{facts['median_rmse_px']:.2f} px", f"{facts['tries']}")
        for turn, facts in held.get("by_yaw", {}).items()
    ]
    return _table(("head turned by", "median error", "tries"), rows) if rows else ""


def _worst(report: Mapping[str, Any], held: Mapping[str, Any]) -> str:
    names = report.get("picture_names") or []
    worst = [
        (names[one["picture"]], one["mean_rmse_px"])
        for one in held.get("worst_pictures", [])
        if one["picture"] < len(names)
    ]
    if not worst:
        return ""
    links = "".join(
        f"<li><a href='{escape(name)}'>{escape(name)}</a>: {error:.2f} px</li>"
        for name, error in worst
    )
    return f"<p>The least well tracked; a click opens the landmarks:</p><ul>{links}</ul>"


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    top = "".join(f"<th align='left'>{cell}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table cellpadding='4'><tr>{top}</tr>{body}</table>"


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100 * share:.1f} %"
