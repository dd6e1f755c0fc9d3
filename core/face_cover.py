"""Something before the face, told from the grey levels of the skin over a whole video.

The landmark network sees through a hand at the chin: its points stay where they should be and its
presence stays at 1. But the skin there no longer looks as the same pose and mouth made it look in
the other frames, which is what is measured here.
"""

import numpy as np

from core.records import U8, FloatArray

#: Points of the 478-point network on skin that expressions move little, by region.
REGIONS: dict[str, tuple[int, ...]] = {
    "forehead": (9, 69, 71, 104, 151, 299, 301, 333),
    "nose": (4, 6, 47, 134, 165, 277, 363, 391),
    "cheek_right": (50, 100, 117, 139, 177, 187, 206, 227),
    "cheek_left": (280, 329, 346, 368, 401, 411, 426, 447),
    "jaw_right": (135, 138, 140, 192, 207, 210, 212, 215),
    "jaw_left": (364, 367, 369, 416, 427, 430, 432, 435),
    "chin": (83, 171, 175, 194, 200, 313, 396, 418),
}
POINTS = np.concatenate([np.array(points) for points in REGIONS.values()])
#: Side that each region faces: 1 the subject's left, -1 right, 0 ahead.
_SIDES = np.array([1 if n.endswith("left") else -1 if n.endswith("right") else 0 for n in REGIONS])
#: A region of one side is hidden when the head is turned away further than this.
_HIDDEN_YAW_RAD = 0.6
#: A level is the mean over this many squared places, this part of the face's width apart.
_PATCH, _PATCH_STEP = 5, 0.02
#: Levels vary by this part of the face's contrast without any cause that we look for.
_FLOOR = 0.1
_MOST = 6.0
#: How much more a frame may deviate for the leverage of its causes: what a rare pose looks like is
#: foretold badly.
_RARITY = 0.025
_ROUNDS = 10
_RIDGE = 1e-2


def skin_levels(gray: U8, mesh_px: FloatArray) -> FloatArray:
    """Return the grey levels of the skin points (56,), from their median, in parts of their spread.

    Args:
        gray: (H, W).
        mesh_px: (478, 2).
    """
    step = _PATCH_STEP * float(np.ptp(mesh_px[:, 0]))
    offsets = (np.arange(_PATCH) - _PATCH // 2) * step
    grid = np.stack(np.meshgrid(offsets, offsets), axis=-1).reshape(-1, 2)
    place = np.rint(mesh_px[POINTS][:, None] + grid).astype(int)
    x = np.clip(place[..., 0], 0, gray.shape[1] - 1)
    y = np.clip(place[..., 1], 0, gray.shape[0] - 1)
    levels = gray[y, x].mean(axis=1)
    return np.asarray((levels - np.median(levels)) / (levels.std() + 1.0))


def covered(levels: FloatArray, causes: FloatArray, yaw_rad: FloatArray) -> FloatArray:
    """Return how unlike the other frames the most unlike region of each frame is (N,).

    The unit is the usual deviation of a level from what the causes foretell, more in frames with
    rare causes. The frames that stand out lose their say in what is usual, so up to about a
    third of a video may be covered.

    Args:
        levels: (N, 56) skin levels.
        causes: (N, F) numbers on which levels may depend: head angles, place, jaw.
        yaw_rad: (N,) of the head.
    """
    spread = causes.std(axis=0)
    standard = (causes - causes.mean(axis=0)) / np.where(spread > 0, spread, 1.0)
    design = np.column_stack([np.ones(len(causes)), standard])
    seen = _seen(yaw_rad)
    trust = np.ones(len(causes))
    for _ in range(_ROUNDS):
        away = np.abs(levels - design @ _foretold(design, levels, seen * trust[:, None]))
        score = _worst_region(away, seen) / np.sqrt(1 + _RARITY * _leverage(design, trust))
        usual = float(np.median(score))
        beyond = np.maximum(score - usual, 0) / (2 * 1.48 * np.median(np.abs(score - usual)) + 1e-6)
        trust = 1 / (1 + beyond**4)
    return score


def _seen(yaw_rad: FloatArray) -> FloatArray:
    """Return 1 where a skin point faces the camera, 0 where the turned head hides it, (N, 56)."""
    away = yaw_rad[:, None] * _SIDES > _HIDDEN_YAW_RAD
    return np.repeat(1.0 - away, len(POINTS) // len(REGIONS), axis=1)


def _foretold(design: FloatArray, levels: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the coefficients (F, 56) of the weighted ridge regression of every point."""
    normal = np.einsum("nf,nk,ng->kfg", design, weights, design, optimize=True) + _ridge(design)
    right = np.einsum("nf,nk->kf", design, weights * levels)
    return np.asarray(np.linalg.solve(normal, right[..., None])[..., 0].T)


def _leverage(design: FloatArray, trust: FloatArray) -> FloatArray:
    """Return how little the other frames say about one with such causes (N,), F on average."""
    normal = design.T @ (trust[:, None] * design) + _ridge(design)
    share = np.einsum("nf,fn->n", design, np.linalg.solve(normal, design.T))
    return np.asarray(len(design) * share)


def _ridge(design: FloatArray) -> FloatArray:
    ridge = _RIDGE * len(design) * np.eye(design.shape[1])
    ridge[0, 0] = 1e-9
    return ridge


def _worst_region(away: FloatArray, seen: FloatArray) -> FloatArray:
    """Return the mean deviation (N,) of the region that deviates most."""
    visible = np.where(seen > 0, away, np.nan)
    # A side that is never seen has no usual deviation, and needs none.
    visible[0] = np.nan_to_num(visible[0])
    usual = 1.48 * np.nanmedian(visible, axis=0) + _FLOOR
    units = np.minimum(away / usual, _MOST) * seen
    return np.asarray(units.reshape(len(away), len(REGIONS), -1).mean(axis=2).max(axis=1))
