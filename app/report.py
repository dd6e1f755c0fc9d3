"""The report of a training for people, as HTML."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from app.picture_names import title_of
from app.report_change import change_rows
from app.report_words import face_words, verdict_words, weak_words

#: [Cao13, table 1]: share of frames with RMSE under 3, 4.5 and 6 px.
PAPER = {"3": 0.733, "4.5": 0.808, "6": 1.0}

STYLE = (
    "<style>:root{color-scheme:light dark}body{font-family:sans-serif;margin:2em auto;"
    "padding:0 1em;max-width:52em;line-height:1.45}table{border-collapse:collapse}"
    "td,th{padding:3px 14px 3px 0;text-align:left;vertical-align:top}"
    "tr+tr td{border-top:1px solid #8884}figure{display:inline-block;margin:0 1em 1em 0}"
    "img{max-width:100%}.note{opacity:.75}</style>"
)
COMPARED = (
    "These figures are no race. All three are measured on the same pictures, which the training "
    "did not see, against the face that was fitted to their points. The training-free mode gets "
    "the points found in the very picture, and the fit follows the same points, so its distance "
    "is small by the way it is measured; the training finds the points by itself, in pictures it "
    "never saw. What a training brings beside these figures is speed, steadiness, and a hold on "
    "covered and turned faces."
)


def report_html(name: str, report: Mapping[str, Any], links: bool = True) -> str:
    """Return what stands in the body of a report.

    Args:
        name: Of the profile.
        report: As core.pipeline makes it.
        links: Whether names of pictures are links that open them.
    """
    held: Mapping[str, Any] = report.get("held_out") or {}
    parts = [f"<h2>{escape(name)}</h2>"]
    if held:
        parts.append(f"<p><b>{escape(verdict_words(held, bool(report.get('free'))))}</b></p>")
    parts += [_summary(report, held), _change(report)]
    if held:
        free = report.get("free") or {}
        parts += [_modes(held, free), _weak(report), _worst(report, held, links)]
        parts += [_by_yaw(held, free), _by_expression(held, free)]
    return "".join(parts)


def report_page(name: str, body: str) -> str:
    """Return a report as a file of its own."""
    title = escape(f"facepuppet: {name}")
    return (
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{title}</title>"
        f"{STYLE}</head><body>{body}</body></html>"
    )


def _summary(report: Mapping[str, Any], held: Mapping[str, Any]) -> str:
    lines = [f"{report.get('pictures', 0)} pictures"]
    for key, text in (("guessed", "not trained on, their points are guesses"),
                      ("left_out", "left out, no face was found")):  # fmt: skip
        if report.get(key):
            lines.append(f"{text}: " + escape(", ".join(title_of(one) for one in report[key])))
    if report.get("focal_px"):
        lines.append(f"focal length {report['focal_px']:.0f} px ({report['focal_source']})")
    if held:
        lines.append(
            f"tested on {held.get('pictures', 0)} pictures that a training did not see: points "
            f"{held['mean_rmse_px']:.2f} px off on average "
            f"({held['mean_percent_of_eye_distance']:.1f} % of the eye distance), head "
            f"{_angles(held)}"
        )
    return "<ul>" + "".join(f"<li>{line}</li>" for line in lines) + "</ul>"


def _change(report: Mapping[str, Any]) -> str:
    rows = [tuple(escape(cell) for cell in row) for row in change_rows(report)]
    if not rows:
        return ""
    table = _table(("", "before", "now", "change"), rows)
    return f"<h3>What this training changed</h3>{table}"


def _modes(held: Mapping[str, Any], free: Mapping[str, Any]) -> str:
    """Return the test beside the training-free mode and the paper."""
    first, later = (free.get(key) or {} for key in ("at_first", "later"))
    columns = [held, later, first] if later else [held]
    head = ["test pictures", "trained"]
    head += ["without, after some seconds", "without, at first"] if later else []
    rows = [
        (f"under {limit} px", *(_share(one, limit) for one in columns), _percent(PAPER.get(limit)))
        for limit in held["share_under_px"]
    ]
    rows.append(("average error", *(_number(one, "mean_rmse_px", " px") for one in columns), ""))
    of_eyes = "mean_percent_of_eye_distance"
    rows.append(("of the eye distance", *(_number(one, of_eyes, " %") for one in columns), ""))
    rows.append(("head off by", *(_angles(one) for one in columns), ""))
    table = _table((*head, "[Cao13, table 1]"), rows)
    note = f"<p class='note'><small>{COMPARED}</small></p>" if later else ""
    return f"<h3>How exact it is</h3>{table}{note}"


def _by_yaw(held: Mapping[str, Any], free: Mapping[str, Any]) -> str:
    turns = {turn: turn.replace(" deg", "°") for turn in held.get("by_yaw", {})}
    return _parts("head turned by", "by_yaw", turns, held, free)


def _by_expression(held: Mapping[str, Any], free: Mapping[str, Any]) -> str:
    faces = held.get("by_expression", {})
    order = sorted(faces, key=lambda face: -float(faces[face]["median_rmse_px"]))
    words = {face: face_words(face) for face in order}
    return _parts("expression", "by_expression", words, held, free)


def _parts(
    what: str, key: str, words: Mapping[str, str], held: Mapping[str, Any], free: Mapping[str, Any]
) -> str:
    """Return a table of the test's parts beside those of the training-free mode."""
    if not words:
        return ""
    others = (free.get("later") or {}).get(key, {})
    rows = []
    for part, text in words.items():
        facts, other = held[key][part], others.get(part, {})
        median, turn = _number(facts, "median_rmse_px", " px"), _number(facts, "mean_turn_deg", "°")
        without = _number(other, "median_rmse_px", " px")
        rows.append((escape(text), median, turn, without, f"{facts['tries']}"))
    head = (what, "median error", "head off by", "without training", "tries")
    return f"<h3>By {'head turn' if key == 'by_yaw' else 'expression'}</h3>{_table(head, rows)}"


def _worst(report: Mapping[str, Any], held: Mapping[str, Any], links: bool) -> str:
    names = report.get("picture_names") or []
    worst = [
        (names[one["picture"]], one["mean_rmse_px"])
        for one in held.get("worst_pictures", [])
        if one["picture"] < len(names)
    ]
    if not worst:
        return ""
    told = "".join(f"<li>{_link(name, links)}: {error:.2f} px</li>" for name, error in worst)
    more = "; a click opens their points" if links else ""
    return f"<h3>The least well tracked test pictures{more}</h3><ul>{told}</ul>"


def _link(name: str, links: bool) -> str:
    title = escape(title_of(name))
    return f"<a href='{escape(name)}'>{title}</a>" if links else title


def _weak(report: Mapping[str, Any]) -> str:
    told = [weak_words(one) for one in report.get("weak_expressions") or []]
    if not told:
        return ""
    items = "".join(f"<li><b>{escape(what)}</b>: {escape(why)}.</li>" for what, why in told)
    return f"<h3>What will be weak on your avatar, and why</h3><ul>{items}</ul>"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    top = "".join(f"<th align='left'>{cell}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table cellpadding='2'><thead><tr>{top}</tr></thead>{body}</table>"


def _angles(facts: Mapping[str, Any]) -> str:
    turn = facts.get("mean_turn_deg") or {}
    return ", ".join(f"{turn[angle]:.1f}° {angle}" for angle in turn)


def _number(facts: Mapping[str, Any], key: str, unit: str) -> str:
    value = facts.get(key)
    return "" if value is None else f"{value:.2f}{unit}"


def _share(facts: Mapping[str, Any], limit: str) -> str:
    return _percent((facts.get("share_under_px") or {}).get(limit))


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100 * share:.1f} %"
