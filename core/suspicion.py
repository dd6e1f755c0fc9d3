"""Which pictures' landmarks deserve a look: a few suspects instead of sixty."""

from dataclasses import dataclass

import numpy as np

from core.landmark_edit import hidden
from core.landmarks import GROUPS, N_INTERNAL
from core.records import BoolArray, FloatArray, Landmarks2D

#: Distance from the fitted model, in parts of the face's size: above the first have a look, above
#: the second something is wrong. On good pictures of the development clips it stays below 1.2 %.
LOOK, WRONG = 0.016, 0.03
#: Share of internal landmarks that were not seen above which a picture is suspicious.
UNSEEN = 0.5
FEATURES = {
    "brow_right": "right brow", "brow_left": "left brow", "eye_right": "right eye",
    "eye_left": "left eye", "nose": "nose", "lips_outer": "lips", "lips_inner": "inner lips",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Suspicion:
    """How much a picture deserves a look.

    Attributes:
        score: Larger is worse; the order of the pictures.
        level: "good", "look" or "bad".
        note: Why, for people.
    """

    score: float
    level: str
    note: str


def suspicion(landmarks: Landmarks2D, model_px: FloatArray) -> Suspicion:
    """Judge the landmarks of a picture.

    Args:
        landmarks: As they are.
        model_px: (75, 2) where the fitted model has them.
    """
    inner = slice(0, N_INTERNAL)
    seen = (landmarks.confidence[inner] > 0) & ~hidden(landmarks)[inner]
    if not seen.any():
        return Suspicion(9.0, "bad", "no face was found; place some points, then refit (R)")
    points = landmarks.points_px[inner]
    size = max(float(np.ptp(points[:, 0])), float(np.ptp(points[:, 1])), 1.0)
    off = np.linalg.norm(points - model_px[inner], axis=1) / size
    worst, error = _worst_feature(off, seen)
    unseen = 1 - float(np.mean(landmarks.confidence[inner]))
    score = error + 0.01 * unseen
    if error > WRONG:
        return Suspicion(score, "bad", f"{worst}: {100 * error:.1f} % from the fitted model")
    if error > LOOK:
        return Suspicion(score, "look", f"{worst}: {100 * error:.1f} % from the fitted model")
    if unseen > UNSEEN and not landmarks.edited.any():
        return Suspicion(score, "look", f"{100 * unseen:.0f} % of the landmarks were hardly seen")
    return Suspicion(score, "good", f"within {100 * error:.1f} % of the fitted model")


def _worst_feature(off: FloatArray, seen: BoolArray) -> tuple[str, float]:
    """Return the feature whose seen landmarks are furthest off, and how far (RMS)."""
    errors = {
        text: float(np.sqrt(np.mean(off[list(GROUPS[name])][seen[list(GROUPS[name])]] ** 2)))
        for name, text in FEATURES.items()
        if seen[list(GROUPS[name])].any()
    }
    worst = max(errors, key=errors.__getitem__)
    return worst, errors[worst]
