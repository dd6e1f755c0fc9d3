"""The names of pictures as people read them, and the picture on the other side."""

import re

from core.setup_plan import SET_MARK

ANGLES = ("yaw", "pitch", "roll")
SIGNS = str.maketrans("+-", "-+")
OTHER_SIDE = {"left": "right", "right": "left"}


def title_of(name: str) -> str:
    """Return a picture's name as people read it.

    "smile_yaw-30" is "smile -30°", "glasses~pose_yaw+0" is "glasses: yaw +0°".
    """
    kind, mark, shot = name.rpartition(SET_MARK)
    first = f"{kind.replace(SET_MARK, ', ').replace('-', ' ')}: " if mark else ""
    for angle in ANGLES:
        what, found, degrees = shot.rpartition(f"_{angle}")
        if found:
            return f"{first}{angle if what == 'pose' else what.replace('_', ' ')} {degrees}°"
    return first + shot.replace("_", " ")


def opposite(name: str) -> str:
    """Return the name of the shot with head and face the other way, "" if there is none."""
    for angle in ("yaw", "roll"):
        what, found, degrees = name.rpartition(f"_{angle}")
        if found:
            turned = degrees if float(degrees) == 0 else degrees.translate(SIGNS)
            other = re.sub("left|right", lambda side: OTHER_SIDE[side.group()], what)
            return "" if (other, turned) == (what, degrees) else f"{other}_{angle}{turned}"
    return ""
