"""Which setup pictures are kept for testing: the same ones in every training of a profile.

Chosen by name, so that pictures added later do not change which others are tested on: two reports
of one profile can then be compared picture by picture. Of every prompted expression one of its
views is kept, so that each is tested while its other views are trained on. Never kept is the only
example of a head turn or of an expression: the test would measure what the user's profile, which is
trained on all pictures, never does.
"""

from collections.abc import Sequence

import numpy as np

from core.records import FloatArray
from core.setup_plan import SHOTS, Shot, shot_of

_EXPRESSIONS = tuple(dict.fromkeys(shot.expression_name for shot in SHOTS))
#: Heads turned by no more than this from each other are examples of the same turn.
_NEAR_RAD = np.deg2rad(16.0)
#: A coefficient asked for at least this much is an expression's own; so much of it is an example.
_OWN, _ENOUGH = 0.3, 0.5
#: Where the usual choice holds fewer prompts, others of which there are examples are added.
_LEAST = 4
_POSES = [shot.name for shot in SHOTS if shot.expression_name == "neutral"]


def held_out_rows(names: Sequence[str], every: int) -> list[int]:
    """Return which of the pictures are held out.

    Args:
        names: N file stems.
        every: One of so many is held out of head turns, and of pictures that are no prompts.
            Without a picture chosen by name it is every so many-th.
    """
    shots = [shot_of(name) for name in names]
    prompts = {row: s for row, s in enumerate(shots) if s is not None and s.name == names[row]}
    others = [row for row in range(len(names)) if row not in prompts]
    held = sorted(_held_prompts(prompts, every) + others[every // 2 :: every])
    if 0 < len(held) < len(names):
        return held
    return [row for row in range(len(names)) if row % every == every // 2]


def _held_prompts(prompts: dict[int, Shot], every: int) -> list[int]:
    """Return which prompts are held out; of each one similar pictures stay."""
    usual = [row for row, shot in prompts.items() if _is_test_shot(shot, every)]
    # A wink's only picture is the only one of its side.
    even = [row for row, shot in prompts.items() if row not in usual and _is_even(shot)]
    held: list[int] = []
    for row in usual + even:
        rest = [shot for other, shot in prompts.items() if other != row and other not in held]
        if (row in usual or len(held) < _LEAST) and _has_examples(prompts[row], rest):
            held.append(row)
    return held


def _has_examples(shot: Shot, rest: Sequence[Shot]) -> bool:
    """Return whether other pictures show what a prompt does: its head turn and its expression."""
    if not any(_same_turn(shot, other) for other in rest):
        return False
    if any(other.expression_name == shot.expression_name for other in rest):
        return True
    own = shot.standard > _OWN
    shown = np.max([other.standard for other in rest], axis=0)
    return bool(np.all(shown[own] >= _ENOUGH * shot.standard[own]))


def _same_turn(shot: Shot, other: Shot) -> bool:
    one, two = _turn(shot), _turn(other)
    return bool(np.all(np.abs(one - two) <= _NEAR_RAD) and np.all(np.sign(one) == np.sign(two)))


def _turn(shot: Shot) -> FloatArray:
    return np.array([shot.yaw, shot.pitch, shot.roll])


def _is_even(shot: Shot) -> bool:
    """Return whether a prompt asks the same of both sides of the face."""
    return not any(side in shot.expression_name for side in ("left", "right"))


def _is_test_shot(shot: Shot, every: int) -> bool:
    """Return whether a prompt is for testing: its view goes round from expression to expression."""
    if shot.expression_name == "neutral":
        return _POSES.index(shot.name) % every == every // 2
    views = [one.name for one in SHOTS if one.expression_name == shot.expression_name]
    place = _EXPRESSIONS.index(shot.expression_name)
    return views[place % len(views)] == shot.name
