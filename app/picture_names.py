"""The names of pictures as people read them, and the picture on the other side."""

import re

from core.setup_plan import SET_MARK

SIGNS = str.maketrans("+-", "-+")
OTHER_SIDE = {"left": "right", "right": "left"}


#: Angle -> what the head does, and where to with less and with more of it; sides are the user's.
TURNS = {
    "yaw": ("turn", "right", "left"), "pitch": ("tilt", "down", "up"),
    "roll": ("lean", "right", "left"),
}  # fmt: skip


def title_of(name: str) -> str:
    """Return a picture's name as people read it.

    "smile_yaw-30" is "smile (30° right)", "glasses~pose_yaw+0" is "glasses: straight ahead".
    """
    kind, mark, shot = name.rpartition(SET_MARK)
    first = f"{kind.replace(SET_MARK, ', ').replace('-', ' ')}: " if mark else ""
    for angle, (what, *ways) in TURNS.items():
        face, found, degrees = shot.rpartition(f"_{angle}")
        if found and degrees[1:].isdigit():
            turned = "" if int(degrees) == 0 else f"{degrees[1:]}° {ways[degrees[0] == '+']}"
            face = face.replace("_", " ")
            if face == "pose":
                return first + (f"{what} {turned}" if turned else "straight ahead")
            return first + (f"{face} ({turned})" if turned else face)
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
