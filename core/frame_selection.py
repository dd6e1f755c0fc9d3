"""Which frames of a video to make a profile from: sharp ones that differ in pose and expression."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.alignment import Alignment
from core.face_cover import POINTS as SKIN_POINTS
from core.face_cover import covered, skin_levels
from core.geometry import head_angles_from_matrix
from core.landmarks import GROUPS, MESH478, N_INTERNAL, NAMES, PUPILS478
from core.records import U8, BoolArray, FloatArray, freeze

#: Pictures are halved until the face is at most this wide, so that sharpness does not depend on
#: the distance from the camera.
SHARPNESS_WIDTH_PX = 160
_MESH_PLACES = np.concatenate([MESH478[:N_INTERNAL], PUPILS478])
_EYES = [*GROUPS["eye_right"], *GROUPS["eye_left"]]
_BROWS = [*GROUPS["brow_right"], *GROUPS["brow_left"]]
_MOUTH = [
    [NAMES.index(name) for name in pair]
    for pair in (("lipin_up_mid", "lipin_lo_mid"), ("R_mouth_corner", "L_mouth_corner"))
]
#: A blink or a glance moves few points a little, and matters as much as an open mouth.
_SHARES = np.ones(N_INTERNAL + 2)
_SHARES[_EYES], _SHARES[N_INTERNAL:] = 2.0, 3.0


@dataclass(frozen=True, slots=True)
class SelectionSettings:
    """How frames are chosen.

    Attributes:
        angle_rad: Difference of a head angle that counts as one step of diversity.
        shape: RMS difference of the frontal landmarks, in parts of their size, that does.
        log_size: Difference of the logarithm of the face's size that does.
        sharp_share: Share of the usual sharpness of the frames around that a frame must reach.
        neighbours: How many frames before and after count as around.
        min_presence: The aligner's presence that a frame must reach.
        most_covered: How unlike the others a region of skin may look, see face_cover. On a real
            clip frames with a hand at the chin have 1.5 to 3.5, others 0.2 to 1.1.
        settling: Frames at the start of a video, in which camera and encoder find their ways.
        least_compared: Frames below which nothing is said about cover, and the start is kept.
    """

    angle_rad: float = 0.17
    shape: float = 0.03
    log_size: float = 0.1
    sharp_share: float = 0.85
    neighbours: int = 12
    min_presence: float = 0.9
    most_covered: float = 1.3
    settling: int = 15
    least_compared: int = 60


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """What is remembered of a frame that may be chosen.

    Attributes:
        index: The frame's number in its source.
        head_rad: (3,) yaw, pitch, roll.
        shape: (62, 2) internal landmarks and pupils turned to the front, around 0, of size 1.
        size_px: RMS distance of the landmarks from their middle.
        sharpness: Strength of the finest detail, relative to the contrast of the face.
        presence: Of the aligner.
        skin: (56,) grey levels of the skin.
        place: (2,) middle of the face in parts of the picture's size.
    """

    index: int
    head_rad: FloatArray
    shape: FloatArray
    size_px: float
    sharpness: float
    presence: float
    skin: FloatArray
    place: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            head_rad=(np.float64, (3,)),
            shape=(np.float64, (N_INTERNAL + 2, 2)),
            skin=(np.float64, (len(SKIN_POINTS),)),
            place=(np.float64, (2,)),
        )


def candidate(index: int, gray: U8, found: Alignment) -> Candidate:
    """Return what a frame (H, W) with a face offers."""
    points = found.mesh_px[_MESH_PLACES]
    solid = np.column_stack([points, found.mesh_depth_px[_MESH_PLACES]])
    middle = solid[:N_INTERNAL].mean(axis=0)
    # Rows times the rotation: from the camera back to the model frame.
    frontal = ((solid - middle) @ found.rotation)[:, :2]
    size_px = float(np.sqrt(np.mean(np.sum(frontal[:N_INTERNAL] ** 2, axis=1))))
    return Candidate(
        index, head_angles_from_matrix(found.rotation), frontal / size_px, size_px,
        sharpness(gray, points), found.presence, skin_levels(gray, found.mesh_px),
        middle[:2] / gray.shape[::-1],
    )  # fmt: skip


def choose(
    candidates: Sequence[Candidate], count: int, settings: SelectionSettings | None = None
) -> tuple[int, ...]:
    """Return the frame numbers of the best candidates, in order of time.

    The first is the most usual one; each next is the one that differs most from all before it
    (farthest-point sampling), so rare poses and expressions are not outvoted by the many frames
    of a resting face.

    Args:
        candidates: In order of time.
        count: How many to choose; fewer come back if there are fewer good ones.
        settings: What differs how much.
    """
    settings = settings or SelectionSettings()
    usable = good_frames(candidates, settings)
    if not usable:
        return ()
    places = _places(usable, settings)
    chosen = [int(np.linalg.norm(places - np.median(places, axis=0), axis=1).argmin())]
    distance = np.linalg.norm(places - places[chosen[0]], axis=1)
    while len(chosen) < min(count, len(usable)):
        distance[chosen] = -1.0
        chosen.append(int(distance.argmax()))
        away = np.linalg.norm(places - places[chosen[-1]], axis=1)
        distance = np.minimum(distance, away)
    return tuple(sorted(usable[n].index for n in chosen))


def good_frames(candidates: Sequence[Candidate], settings: SelectionSettings) -> list[Candidate]:
    """Return the candidates that surely show a bare face as sharp as those around them."""
    sharp = np.array([one.sharpness for one in candidates])
    fit = _fit(candidates, settings)
    good = []
    for n, one in enumerate(candidates):
        around = sharp[max(0, n - settings.neighbours) : n + settings.neighbours + 1]
        enough = one.sharpness >= settings.sharp_share * float(np.median(around))
        if enough and fit[n] and one.presence >= settings.min_presence:
            good.append(one)
    return good


def sharpness(gray: U8, points_px: FloatArray) -> float:
    """Return the strength of the finest detail around some points, relative to the contrast.

    The standard deviation of the Laplacian over that of the grey levels; motion blur and bad
    focus lower it.

    Args:
        gray: (H, W).
        points_px: (L, 2) points of the face.
    """
    low = np.maximum(points_px.min(axis=0).astype(int), 0)
    high = points_px.max(axis=0).astype(int) + 2
    face = gray[low[1] : high[1], low[0] : high[0]].astype(np.float32)
    while face.shape[1] > SHARPNESS_WIDTH_PX:
        face = face[: face.shape[0] // 2 * 2, : face.shape[1] // 2 * 2]
        face = 0.25 * (face[::2, ::2] + face[1::2, ::2] + face[::2, 1::2] + face[1::2, 1::2])
    if min(face.shape) < 3:
        return 0.0
    middle = face[1:-1, 1:-1]
    around = face[:-2, 1:-1] + face[2:, 1:-1] + face[1:-1, :-2] + face[1:-1, 2:]
    return float((around - 4 * middle).std() / (face.std() + 1.0))


def _fit(candidates: Sequence[Candidate], settings: SelectionSettings) -> BoolArray:
    """Return where the start is over and nothing seems to cover the face (N,)."""
    if len(candidates) < settings.least_compared:
        return np.ones(len(candidates), bool)
    settled = np.array([one.index - candidates[0].index >= settings.settling for one in candidates])
    head = np.array([one.head_rad for one in candidates])
    causes = np.array([_causes(one) for one in candidates])
    score = covered(np.array([one.skin for one in candidates]), causes, head[:, 0])
    return np.asarray(settled & (score < settings.most_covered))


def _causes(one: Candidate) -> FloatArray:
    """Return what the look of the skin depends on: pose and place, jaw, mouth and brows (13,)."""
    yaw, pitch, roll = one.head_rad
    gap, width = (float(np.linalg.norm(one.shape[a] - one.shape[b])) for a, b in _MOUTH)
    brows = float(one.shape[_BROWS, 1].mean() - one.shape[_EYES, 1].mean())
    turned = [yaw, pitch, roll, yaw * yaw, pitch * pitch, yaw * pitch]
    return np.array([*turned, np.log(one.size_px), gap, gap * gap, width, brows, *one.place])


def _places(candidates: Sequence[Candidate], settings: SelectionSettings) -> FloatArray:
    """Return the candidates as points (N, D); a distance of 1 is one step of diversity."""
    angles = np.array([one.head_rad for one in candidates]) / settings.angle_rad
    shapes = np.array([(one.shape * _SHARES[:, None]).ravel() for one in candidates])
    sizes = np.log([one.size_px for one in candidates])[:, None] / settings.log_size
    return np.concatenate([angles, shapes / (settings.shape * np.sqrt(N_INTERNAL)), sizes], axis=1)
