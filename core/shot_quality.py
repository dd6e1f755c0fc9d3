"""Whether a frame is good enough for a setup picture, and what the user can do about it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.records import U8, FloatArray

#: Trouble -> what to tell the user, the most important first.
ADVICE: dict[str, str] = {
    "no_face": "No face is seen: sit before the camera",
    "several": "Several faces are seen: ask the others to step aside",
    "outside": "Your face is cut off: move towards the middle of the picture",
    "far": "Move closer to the camera",
    "near": "Move back a little",
    "dark": "It is too dark: put a lamp before you",
    "clipped": "It is too bright: move the lamp away or dim it",
    "backlit": "The light comes from behind you: turn around or close the curtain",
    "blurred": "The picture is blurred: hold still, or clean the lens",
    "off_center": "Move to the middle of the picture, or turn the camera to you",
    "slow_dark": "It is so dim that the camera gives few pictures a second: put a lamp before you",
    "slow": "Few pictures come a second: close programs that are busy or use the camera",
}
#: Troubles that do not make a picture worse.
HARMLESS = frozenset({"off_center", "slow_dark", "slow"})
#: The other troubles as the reason why a picture is weak.
WHY_WEAK: dict[str, str] = {
    "no_face": "no face was seen", "several": "several faces", "outside": "the face is cut off",
    "far": "too far away", "near": "too near", "dark": "too dark", "clipped": "too bright",
    "backlit": "light from behind", "blurred": "blurred",
}  # fmt: skip
#: Below this deviation of its grey levels a picture shows nothing.
BLANK = 4.0


@dataclass(frozen=True, slots=True)
class QualitySettings:
    """What a setup picture needs.

    Attributes:
        least_width: Face's width over the picture's, at least.
        most_width: And at most.
        margin: Free space between face and edge, in parts of the picture's width.
        dark: Median grey level of the skin, at least.
        clipped_level: Grey level that counts as white.
        clipped_share: Share of the face that may be white.
        backlit_ratio: The surround may be so many times as bright as the face.
        sharp: Sharpness at least, as core.frame_selection measures it: 0.25 to 0.4 on a usual
            webcam, 0.1 where it is blurred by 2 px.
        least_fps: Frames per second at least.
        dim: With a face darker than this, few frames a second come from the lack of light.
        aside: Middle of the face from the middle of the picture, in parts of its width.
    """

    least_width: float = 0.14
    most_width: float = 0.6
    margin: float = 0.01
    dark: float = 45.0
    clipped_level: float = 250.0
    clipped_share: float = 0.1
    backlit_ratio: float = 2.2
    sharp: float = 0.16
    least_fps: float = 12.0
    dim: float = 75.0
    aside: float = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class Looked:
    """What is known of a frame.

    Attributes:
        gray: (H, W) grey levels.
        points_px: (L, 2) landmarks of the face, None without one.
        rivals: Other faces that are about as large.
        sharpness: As core.frame_selection measures it.
        fps: Frames per second of the camera, NaN while unknown.
    """

    gray: U8
    points_px: FloatArray | None
    rivals: int = 0
    sharpness: float = float("nan")
    fps: float = float("nan")


def troubles(looked: Looked, settings: QualitySettings | None = None) -> list[str]:
    """Return what is wrong with a frame, keys of ADVICE, the most important first."""
    settings = settings or QualitySettings()
    found = set()
    if looked.points_px is None:
        found.add("no_face")
        if float(np.median(looked.gray)) < settings.dark / 2:
            found.add("dark")
    else:
        found |= _placed(looked.gray, looked.points_px, settings)
        found |= _lit(looked.gray, looked.points_px, settings)
    if looked.rivals:
        found.add("several")
    if looked.sharpness < settings.sharp:
        found.add("blurred")
    if looked.fps < settings.least_fps:
        found.add("slow_dark" if _is_dim(looked, settings) else "slow")
    return [name for name in ADVICE if name in found]


def is_blank(gray: U8) -> bool:
    """Return whether a picture shows nothing, as behind a closed lid or of one colour."""
    return float(gray[::8, ::8].std()) < BLANK


def _is_dim(looked: Looked, settings: QualitySettings) -> bool:
    if looked.points_px is None:
        return float(np.median(looked.gray)) < settings.dim
    face, _ = face_and_surround(looked.gray, looked.points_px)
    return face.size > 0 and float(np.median(face)) < settings.dim


def _placed(gray: U8, points_px: FloatArray, settings: QualitySettings) -> set[str]:
    """Return what is wrong with where the face is."""
    height, width = gray.shape
    low, high = points_px.min(axis=0), points_px.max(axis=0)
    # Landmarks end at the brows; with the forehead a face is about a third taller.
    low = low - [0.0, 0.33 * (high[1] - low[1])]
    edge = settings.margin * width
    found = set()
    if (low < edge).any() or (high > np.array([width, height]) - 1 - edge).any():
        found.add("outside")
    off = np.abs(0.5 * (low + high) - [width / 2, height / 2])
    if (off > settings.aside * width).any():
        found.add("off_center")
    # A turned face is narrow but as tall as before.
    share = max(high[0] - low[0], 0.75 * (high[1] - low[1])) / width
    if share < settings.least_width:
        found.add("far")
    if share > settings.most_width:
        found.add("near")
    return found


def _lit(gray: U8, points_px: FloatArray, settings: QualitySettings) -> set[str]:
    """Return what is wrong with the light."""
    face, around = face_and_surround(gray, points_px)
    if face.size == 0:
        return set()
    found = set()
    level = float(np.median(face))
    if level < settings.dark:
        found.add("dark")
    if float(np.mean(face >= settings.clipped_level)) > settings.clipped_share:
        found.add("clipped")
    if around.size and float(np.median(around)) > settings.backlit_ratio * max(level, 1.0):
        found.add("backlit")
    return found


def face_and_surround(gray: U8, points_px: FloatArray) -> tuple[U8, U8]:
    """Return the grey levels of the face's box, and those of the picture beside and above it."""
    height, width = gray.shape
    limits = np.array([width, height])
    low = np.clip(np.floor(points_px.min(axis=0)), 0, limits).astype(int)
    high = np.clip(np.ceil(points_px.max(axis=0)), 0, limits).astype(int)
    face = gray[low[1] : high[1], low[0] : high[0]]
    beside = np.ones(gray.shape, bool)
    beside[:, max(low[0] - (high[0] - low[0]) // 3, 0) : high[0] + (high[0] - low[0]) // 3] = False
    beside[high[1] :] = False
    return face.ravel(), gray[beside]


class Advisor:
    """Tells one trouble at a time, and only one that lasts."""

    def __init__(self, patience_s: float = 1.5, leave_s: float = 0.7) -> None:
        """Begin without any advice.

        Args:
            patience_s: A trouble must last so long before it is told.
            leave_s: And be gone so long before it is no longer.
        """
        self._patience_s, self._leave_s = patience_s, leave_s
        self._since: dict[str, float] = {}
        self._seen: dict[str, float] = {}
        self._told = ""

    def step(self, present: Sequence[str], time_s: float) -> str:
        """Return the trouble to tell now, "" if there is none.

        Args:
            present: Troubles of this frame, the most important first.
            time_s: Time of the frame.
        """
        for name in present:
            if time_s - self._seen.get(name, -np.inf) > self._leave_s:
                self._since[name] = time_s
            self._seen[name] = time_s
        lasting = [name for name in ADVICE if self._lasts(name, time_s)]
        if self._told not in lasting:
            self._told = lasting[0] if lasting else ""
        return self._told

    def _lasts(self, name: str, time_s: float) -> bool:
        if time_s - self._seen.get(name, -np.inf) > self._leave_s:
            return False
        return name == self._told or time_s - self._since[name] >= self._patience_s
