"""Finds a head of known turn in a picture by its skin, as another picture shows it.

No detector sees a face from the side, and where the head is when the body has turned along is not
known from the prompt. Its shape is, and its skin can be taken from the picture with the nearest
turn: what both pictures show must look alike at the right place.
"""

import numpy as np

from core.camera import project
from core.face_model import PART_NAMES, FaceModel
from core.fit_problem import State, posed, turns_of
from core.records import U8, BoolArray, Camera, FloatArray, UserBlendshapes

#: How far the head is looked for, in parts of the picture's width and height, and the step in px
#: of pictures 640 px wide.
REACH = (0.15, 0.08)
STEP_PX = 2.0
#: Turns in the picture plane that are tried.
TURNS_RAD = np.deg2rad([-8.0, -4.0, 0.0, 4.0, 8.0])
#: What a shift by a tenth of the picture's width costs in correlation, and a turn by 0.1 rad: a
#: good match far away is rather something else.
SHIFT_COST, TURN_COST = 0.1, 0.02
#: Cosine of the steepest skin that is compared, and the part of the head: in front of the ears,
#: below the hair, above the neck, in mm of the model frame.
_STEEPEST = 0.25
_DEEPEST_MM, _HIGHEST_MM, _LOWEST_MM = 95.0, -45.0, 115.0


def moved_to_skin(
    model: FaceModel, user: UserBlendshapes, camera: Camera, expected: State,
    picture: U8, known: tuple[State, U8],
) -> State:  # fmt: skip
    """Return a state turned and moved in the picture plane to where the skin matches best.

    Args:
        model: The face model.
        user: The user's blendshapes.
        camera: The camera of both pictures.
        expected: State of the one picture.
        picture: (H, W) grey levels in which the head is looked for.
        known: State and grey levels of a picture with a similar turn.
    """
    here, there = posed_mm(user, expected), posed_mm(user, known[0])
    rows = _face(model, user) & _facing(model, here) & _facing(model, there)
    rows &= _inside(project(camera, there), known[1].shape)
    pattern = _normalised(sample(known[1], project(camera, there[rows])))
    middle_mm = here[rows].mean(axis=0)
    tried = []
    for angle, turn in zip(TURNS_RAD, turns_of(np.outer(TURNS_RAD, [0.0, 0.0, 1.0])), strict=True):
        places = project(camera, (here[rows] - middle_mm) @ turn.T + middle_mm)
        score, shift_px = _best_shift(picture, places, pattern)
        tried.append((score - TURN_COST * (angle / 0.1) ** 2, shift_px, turn))
    _, shift_px, turn = max(tried, key=lambda one: one[0])
    step_mm = np.append(shift_px * middle_mm[2] / camera.focal_px, 0.0)
    place = turn @ (expected.translations_mm[0] - middle_mm) + middle_mm + step_mm
    return State((turn @ expected.rotations[0])[None], place[None], expected.expressions)


def posed_mm(user: UserBlendshapes, state: State) -> FloatArray:
    """Return the vertices (V, 3) of the one picture of a state in the camera frame."""
    shape = user.neutral_mm + np.tensordot(state.expressions[0], user.deltas_mm, axes=1)
    return np.asarray(posed(shape[None], state)[0])


def sample(picture: U8, places_px: FloatArray) -> FloatArray:
    """Return the grey levels (...) at the nearest pixels of places (..., 2)."""
    height, width = picture.shape
    column = np.clip(np.rint(places_px[..., 0]).astype(int), 0, width - 1)
    row = np.clip(np.rint(places_px[..., 1]).astype(int), 0, height - 1)
    return np.asarray(picture[row, column], dtype=np.float64)


def _best_shift(
    picture: U8, places_px: FloatArray, pattern: FloatArray
) -> tuple[float, FloatArray]:
    """Return the best correlation of the picture with a pattern, and the shift (2,) to it."""
    height, width = picture.shape
    step = STEP_PX * width / 640
    across, down = (
        np.arange(-reach * length, reach * length + step / 2, step)
        for reach, length in zip(REACH, (width, height), strict=True)
    )
    best, shift = -np.inf, np.zeros(2)
    for y in down:
        shifts = np.column_stack([across, np.full(len(across), y)])
        seen = sample(picture, places_px + shifts[:, None])
        cost = SHIFT_COST * np.sum(shifts**2, axis=1) / (0.1 * width) ** 2
        scores = _normalised(seen) @ pattern - cost
        if scores.max() > best:
            best, shift = float(scores.max()), shifts[int(scores.argmax())]
    return best, shift


def _normalised(levels: FloatArray) -> FloatArray:
    """Return levels (..., P) without their mean, of length 1."""
    centred = levels - levels.mean(axis=-1, keepdims=True)
    return np.asarray(centred / (np.linalg.norm(centred, axis=-1, keepdims=True) + 1e-9))


def _face(model: FaceModel, user: UserBlendshapes) -> BoolArray:
    """Return which vertices (V,) are skin of the face."""
    skin = np.zeros(len(user.neutral_mm), bool)
    skin[model.triangles[model.part == PART_NAMES.index("skin")]] = True
    _, y, z = user.neutral_mm.T
    return np.asarray(skin & (z < _DEEPEST_MM) & (y > _HIGHEST_MM) & (y < _LOWEST_MM))


def _facing(model: FaceModel, points_mm: FloatArray) -> BoolArray:
    """Return which vertices (V,) face the camera clearly."""
    skin = model.triangles[model.part == PART_NAMES.index("skin")]
    a, b, c = (points_mm[skin[:, corner]] for corner in range(3))
    normals = np.zeros_like(points_mm)
    np.add.at(normals, skin, np.cross(b - a, c - a)[:, None])
    length = np.linalg.norm(normals, axis=1) * np.linalg.norm(points_mm, axis=1) + 1e-9
    return np.asarray(-np.sum(normals * points_mm, axis=1) / length > _STEEPEST)


def _inside(places_px: FloatArray, shape: tuple[int, ...]) -> BoolArray:
    within = (places_px > 0) & (places_px < np.array(shape[::-1]) - 1)
    return np.asarray(np.all(within, axis=1))
