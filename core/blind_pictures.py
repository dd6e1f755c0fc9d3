"""Setup pictures in which no face is found: placed by their prompts, kept for the user's hand.

The aligner sees no face at +-90 degrees. Such a picture is not left out: the person is known from
the others and the pose from the prompt. Nothing is measured in it until the user places points;
with enough of them it is fitted like every other picture. Until then it is not trained on: the
guesses are off by 3 to 10 px, and training on them made the virtual performer's error on heads
turned beyond 40 degrees 5.0 px instead of 2.6.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.face_model import FaceModel
from core.fit_problem import State, posed
from core.fit_space import face_at, fit_vertices
from core.geometry import matrix_from_quaternion, quaternion_from_matrix
from core.landmark_guess import (
    expected_state,
    landmarks_at,
    nearest_prompt,
    placed_kept,
    straight_pupils_mm,
)
from core.landmarks import N_INTERNAL
from core.model_fit import LEAST_LANDMARKS, choose_picks, trusted_landmarks
from core.profile_search import moved_to_skin
from core.records import (
    U8,
    Camera,
    Landmarks2D,
    ModelFit,
    SetupShapes,
    UserBlendshapes,
)
from core.setup_plan import Shot, shot_of


@dataclass(frozen=True, slots=True)
class Sorting:
    """Which pictures are used how, as numbers of the pictures.

    Attributes:
        fitted: Those with enough trusted landmarks.
        guessed: Other prompted ones.
        left_out: The rest.
    """

    fitted: tuple[int, ...]
    guessed: tuple[int, ...]
    left_out: tuple[int, ...]

    @property
    def kept(self) -> tuple[int, ...]:
        """Return fitted and guessed pictures in the order in which they came."""
        return tuple(sorted(self.fitted + self.guessed))


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Landmarks, fit and shapes of pictures, row by row."""

    landmarks: tuple[Landmarks2D, ...]
    fit: ModelFit
    shapes: SetupShapes


@dataclass(frozen=True, slots=True, eq=False)
class Pictures:
    """Setup pictures.

    Attributes:
        names: File stems.
        grays: (H, W) grey levels.
        landmarks: As they came.
    """

    names: tuple[str, ...]
    grays: tuple[U8, ...]
    landmarks: tuple[Landmarks2D, ...]


def prompt_of(name: str) -> Shot | None:
    """Return the prompt of the picture with this file stem, None if it is no shot."""
    return shot_of(name)


def sort_pictures(names: Sequence[str], landmarks: Sequence[Landmarks2D]) -> Sorting:
    """Return which pictures can be fitted, guessed, or neither.

    Guesses need a fitted picture whose prompt is known, too.
    """
    fits = [trusted_landmarks(one) >= LEAST_LANDMARKS for one in landmarks]
    prompted = [prompt_of(name) is not None for name in names]
    anchored = any(fit and asked for fit, asked in zip(fits, prompted, strict=True))
    rows = range(len(names))
    guessed = tuple(n for n in rows if not fits[n] and prompted[n] and anchored)
    return Sorting(
        tuple(n for n in rows if fits[n]),
        guessed,
        tuple(n for n in rows if not fits[n] and n not in guessed),
    )


def with_guesses(
    model: FaceModel, user: UserBlendshapes, camera: Camera, pictures: Pictures, fitted: Placed
) -> Placed:
    """Return the rows of all kept pictures, those that were not fitted by their prompts.

    The prompt says how the head is turned, the skin of the picture with the nearest prompt
    where it is.

    Args:
        model: The face model.
        user: The user's blendshapes.
        camera: The camera.
        pictures: The kept pictures.
        fitted: Rows of those with enough trusted landmarks.
    """
    seen = [trusted_landmarks(one) >= LEAST_LANDMARKS for one in pictures.landmarks]
    prompts = [prompt_of(name) for name in pictures.names]
    # Picture, row of the fit and prompt of what guesses start from.
    order = {n: row for row, n in enumerate(np.flatnonzero(seen).tolist())}
    anchors = [(n, row, shot) for n, row in order.items() if (shot := prompts[n]) is not None]
    known = rows_of_fit(fitted.fit, [row for _, row, _ in anchors])
    shots = [shot for _, _, shot in anchors]
    rows = []
    for n, shot in enumerate(prompts):
        if n in order or shot is None:
            rows.append(_row(fitted, order[n]))
            continue
        nearest = nearest_prompt(shot, shots)
        anchor = (_state_of(known, nearest), pictures.grays[anchors[nearest][0]])
        state = moved_to_skin(
            model, user, camera, expected_state(shot, shots, known), pictures.grays[n], anchor
        )
        rows.append(_guess(model, user, camera, state, pictures.landmarks[n], fitted.fit))
    return _stacked(rows)


def _state_of(fit: ModelFit, row: int) -> State:
    one = slice(row, row + 1)
    rotations = matrix_from_quaternion(fit.rotations_wxyz[one])
    return State(rotations, fit.translations_mm[one], fit.expressions[one])


def _guess(
    model: FaceModel, user: UserBlendshapes, camera: Camera, state: State, before: Landmarks2D,
    fit: ModelFit,
) -> Placed:  # fmt: skip
    """Return the row of a picture in which only the pose is known; its distance is NaN."""
    face = face_at(model, user)
    vertices = fit_vertices(model)[0][choose_picks(face, state)]
    whole = posed(face.points_mm(state.expressions), state)
    pupils = posed(straight_pupils_mm(model, user)[None], state)
    points = np.concatenate([whole[:, :N_INTERNAL], whole[:, face.replacements], pupils], axis=1)
    pose = {
        "rotations_wxyz": quaternion_from_matrix(state.rotations[0])[None],
        "translations_mm": state.translations_mm,
        "rms_px": np.full(1, np.nan),
    }
    return Placed(
        (placed_kept(landmarks_at(model, user, camera, state), before),),
        replace(fit, expressions=state.expressions, landmark_vertices=vertices, **pose),
        SetupShapes(points_mm=points, coefficients=state.expressions, **pose),
    )


def _row(placed: Placed, row: int) -> Placed:
    one = [row]
    return Placed(
        placed.landmarks[row : row + 1],
        rows_of_fit(placed.fit, one),
        rows_of_shapes(placed.shapes, one),
    )


def rows_of_shapes(shapes: SetupShapes, rows: Sequence[int]) -> SetupShapes:
    """Return the shapes of some of the pictures."""
    chosen = list(rows)
    return SetupShapes(
        shapes.points_mm[chosen], shapes.rotations_wxyz[chosen], shapes.translations_mm[chosen],
        shapes.coefficients[chosen], shapes.rms_px[chosen],
    )  # fmt: skip


def rows_of_fit(fit: ModelFit, rows: Sequence[int]) -> ModelFit:
    """Return the fit of some of its pictures."""
    chosen = list(rows)
    return replace(
        fit,
        expressions=fit.expressions[chosen],
        rotations_wxyz=fit.rotations_wxyz[chosen],
        translations_mm=fit.translations_mm[chosen],
        landmark_vertices=fit.landmark_vertices[chosen],
        rms_px=fit.rms_px[chosen],
    )


def _stacked(rows: Sequence[Placed]) -> Placed:
    """Return rows one below the other; the person is that of the first."""
    fits, shapes = [row.fit for row in rows], [row.shapes for row in rows]
    return Placed(
        tuple(one for row in rows for one in row.landmarks),
        replace(
            fits[0],
            expressions=np.concatenate([fit.expressions for fit in fits]),
            rotations_wxyz=np.concatenate([fit.rotations_wxyz for fit in fits]),
            translations_mm=np.concatenate([fit.translations_mm for fit in fits]),
            landmark_vertices=np.concatenate([fit.landmark_vertices for fit in fits]),
            rms_px=np.concatenate([fit.rms_px for fit in fits]),
        ),
        SetupShapes(
            np.concatenate([one.points_mm for one in shapes]),
            np.concatenate([one.rotations_wxyz for one in shapes]),
            np.concatenate([one.translations_mm for one in shapes]),
            np.concatenate([one.coefficients for one in shapes]),
            np.concatenate([one.rms_px for one in shapes]),
        ),
    )
