"""Which setup pictures are kept for testing: the same ones in every training of a profile.

Chosen by name, so that pictures added later do not change which others are tested on: two reports
of one profile can then be compared picture by picture. Of every prompted expression one of its
views is kept, so that each is tested while its other views are trained on.
"""

from collections.abc import Sequence

from core.setup_plan import SHOTS, Shot, shot_of

_EXPRESSIONS = tuple(dict.fromkeys(shot.expression_name for shot in SHOTS))
_POSES = [shot.name for shot in SHOTS if shot.expression_name == "neutral"]


def held_out_rows(names: Sequence[str], every: int) -> list[int]:
    """Return which of the pictures are held out.

    Args:
        names: N file stems.
        every: One of so many is held out of head turns, and of pictures that are no prompts.
            Without a picture chosen by name it is every so many-th.
    """
    held, others = [], 0
    for row, name in enumerate(names):
        shot = shot_of(name)
        if shot is not None and shot.name == name:
            if _is_test_shot(shot, every):
                held.append(row)
            continue
        if others % every == every // 2:
            held.append(row)
        others += 1
    if 0 < len(held) < len(names):
        return held
    return [row for row in range(len(names)) if row % every == every // 2]


def _is_test_shot(shot: Shot, every: int) -> bool:
    """Return whether a prompt is for testing: its view goes round from expression to expression."""
    if shot.expression_name == "neutral":
        return _POSES.index(shot.name) % every == every // 2
    views = [one.name for one in SHOTS if one.expression_name == shot.expression_name]
    place = _EXPRESSIONS.index(shot.expression_name)
    return views[place % len(views)] == shot.name
