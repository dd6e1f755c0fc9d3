"""Texture coordinates: the body atlas of the source cut down to the head, face upright.

Skin and mouth cavity share one square; eyes, teeth with tongue, and lashes have squares of
their own. u runs to the right and v down, as in a picture.
"""

import cv2
import numpy as np

from assets.build.face_model.head import PART_NAMES, Head

#: Enlargement of the skin islands from the body atlas.
SCALE = 1.49
#: Half the opening angle of the eyeball that the radius 0.5 of the eye square shows.
EYE_EDGE_RAD = np.deg2rad(110.0)
#: Islands of the skin in the body atlas (u0, v0, u1, v1), v down, and the place (u, v) of the
#: corner of the island in ours; the first is turned by a quarter so that the face is upright.
ISLANDS = (
    ((0.63, 0.18, 1.00, 0.85), (0.005, 0.005)),
    ((0.74, 0.855, 0.94, 0.995), (0.36, 0.60)),
    ((0.00, 0.35, 0.08, 0.47), (0.02, 0.60)),
    ((0.08, 0.35, 0.16, 0.47), (0.16, 0.60)),
    ((0.32, 0.03, 0.44, 0.11), (0.02, 0.80)),
)


def body_to_skin(index: int) -> np.ndarray:
    """Return the (2, 3) affine map of one island from the body atlas (v down) to ours."""
    (u0, v0, _, v1), (x, y) = ISLANDS[index]
    if index == 0:  # right of the body atlas is down here, its down is left
        return np.array([[0, -SCALE, x + SCALE * v1], [SCALE, 0, y - SCALE * u0]])
    return np.array([[SCALE, 0, x - SCALE * u0], [0, SCALE, y - SCALE * v0]])


def warp_body_picture(picture: np.ndarray, size_px: int) -> np.ndarray:
    """Return a picture in the body atlas, such as a region mask, drawn into the skin square."""
    shape = (size_px, size_px, *picture.shape[2:])
    out = np.zeros(shape, picture.dtype)
    scale = np.diag([picture.shape[1], picture.shape[0], 1.0])
    for index, ((u0, v0, u1, v1), _) in enumerate(ISLANDS):
        to_skin = np.vstack([body_to_skin(index), [0, 0, 1]])
        pixels = np.diag([size_px, size_px, 1.0]) @ to_skin @ np.linalg.inv(scale)
        box = np.zeros(picture.shape[:2], np.uint8)
        rows, columns = np.array([v0, v1]) * len(box), np.array([u0, u1]) * box.shape[1]
        box[int(rows[0]) : int(rows[1]), int(columns[0]) : int(columns[1])] = 1
        inside = cv2.warpAffine(box, pixels[:2], (size_px, size_px), flags=cv2.INTER_NEAREST)
        warped = cv2.warpAffine(picture, pixels[:2], (size_px, size_px), flags=cv2.INTER_AREA)
        out[inside > 0] = warped[inside > 0]
    return out


def skin_uv(texture_points: np.ndarray) -> np.ndarray:
    """Return (m, 2) skin coordinates of body atlas points (m, 2), v up."""
    points = texture_points * [1, -1] + [0, 1]
    out = np.zeros_like(points)
    for index, ((u0, v0, u1, v1), _) in enumerate(ISLANDS):
        inside = (points >= [u0, v0]).all(axis=1) & (points <= [u1, v1]).all(axis=1)
        matrix = body_to_skin(index)
        out[inside] = points[inside] @ matrix[:, :2].T + matrix[:, 2]
    return out


def eye_uv(points: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Return coordinates around the pupil: distance from the middle is the angle from it."""
    look = (points - center) / np.linalg.norm(points - center, axis=-1, keepdims=True)
    angle = np.arccos(np.clip(-look[..., 2], -1, 1))
    side = look[..., :2] / np.maximum(np.linalg.norm(look[..., :2], axis=-1, keepdims=True), 1e-9)
    return 0.5 + 0.5 * np.minimum(angle / EYE_EDGE_RAD, 1.0)[..., None] * side


def fitted(uv: np.ndarray) -> np.ndarray:
    """Return coordinates moved and scaled into the unit square, with a small margin."""
    low, high = uv.reshape(-1, 2).min(axis=0), uv.reshape(-1, 2).max(axis=0)
    return 0.02 + 0.96 * (uv - low) / (high - low).max()


def corner_uv(head: Head, neutral: np.ndarray) -> np.ndarray:
    """Return the texture coordinates of every face corner, (F, 4, 2)."""
    uv = skin_uv(head.texture_points)[head.corners]
    flipped = (head.texture_points * [1, -1] + [0, 1])[head.corners]
    for number, part in enumerate(("eye_right", "eye_left")):
        mine = head.part == PART_NAMES.index(part)
        uv[mine] = eye_uv(neutral[head.quads[mine]], neutral[number - 2])
    for parts in (("teeth", "tongue"), ("lashes",)):
        mine = np.isin(head.part, [PART_NAMES.index(part) for part in parts])
        uv[mine] = fitted(flipped[mine])
    return uv
