"""The 3D shape of every setup picture from its landmarks [Cao13, 4.2, eq. 6-8]."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field

import numpy as np

from core.face_model import FaceModel, eye_centers_mm
from core.fit_priors import PriorSettings, expression_prior
from core.fit_problem import State, posed, residuals_px, rms_px, start_state
from core.fit_space import Face, face_at
from core.geometry import matrix_from_quaternion, quaternion_from_matrix
from core.landmarks import N_INTERNAL
from core.model_fit import FitSettings, check_landmarks, choose_picks, observe
from core.picture_fit import Problem, fit_pictures
from core.pupils import pupils_mm
from core.records import (
    I32,
    Camera,
    FloatArray,
    Landmarks2D,
    ModelFit,
    Progress,
    SetupShapes,
    UserBlendshapes,
)

#: E_reg of the paper: as wide for what is asked for as for what is not.
_PRIOR = PriorSettings(standard_spread=0.3, others_share=0.6, neutral_share=0.6)


@dataclass(frozen=True, slots=True)
class RecoverySettings:
    """How shapes are recovered.

    Attributes:
        fit: Noise and priors.
        rounds: Updates of the contour vertices.
    """

    fit: FitSettings = field(default_factory=lambda: FitSettings(prior=_PRIOR))
    rounds: int = 2


def standard_from_fit(fit: ModelFit) -> FloatArray:
    """Return coefficients a* (N, B) for pictures of no prompted expression: those of the fit."""
    return fit.expressions


def recover_shapes(  # noqa: PLR0913
    model: FaceModel, user: UserBlendshapes, camera: Camera, landmarks: Sequence[Landmarks2D],
    fit: ModelFit, standard: FloatArray, settings: RecoverySettings,
) -> Generator[Progress, None, SetupShapes]:  # fmt: skip
    """Recover pose, coefficients and 3D points of every picture.

    Args:
        model: The face model, for its landmark vertices and eyes.
        user: The user's blendshapes.
        camera: The camera of all pictures.
        landmarks: N pictures' landmarks.
        fit: Poses and coefficients to start from.
        standard: (N, B) coefficients a*; NaN rows become those of the fit.
        settings: How to recover.

    Yields:
        Progress, once per round.

    Returns:
        The shapes.

    Raises:
        FewLandmarksError: A picture cannot be fitted.
    """
    check_landmarks(landmarks)
    standard = np.where(np.isnan(standard), standard_from_fit(fit), standard)
    face = face_at(model, user)
    rotations = matrix_from_quaternion(fit.rotations_wxyz)
    state = State(rotations, fit.translations_mm, fit.expressions)
    problem = _problem(camera, state, landmarks, standard, settings.fit)
    picks = choose_picks(face, state)
    for turn in range(settings.rounds):
        state = fit_pictures(problem, face, state, picks)
        picks = choose_picks(face, state)
        yield Progress(turn + 1, settings.rounds, "Recovering 3D shapes")
    return _record(problem, face, state, picks, _pupils(model, user, camera, state, landmarks))


def recover_one(
    model: FaceModel, user: UserBlendshapes, camera: Camera, landmarks: Landmarks2D,
    settings: RecoverySettings,
) -> SetupShapes:  # fmt: skip
    """Return the 3D shape of one picture, from nothing but its landmarks.

    Quick, for the first frame and after tracking was lost.

    Args:
        model: The face model, for its landmark vertices and eyes.
        user: The user's blendshapes.
        camera: The camera.
        landmarks: The picture's landmarks.
        settings: How to recover.

    Raises:
        FewLandmarksError: Too few landmarks are trusted.
    """
    check_landmarks([landmarks])
    face = face_at(model, user)
    unknown = np.full((1, len(user.deltas_mm)), np.nan)
    state = start_state(camera, face.neutral_mm, [landmarks], unknown.shape[1])
    problem = _problem(camera, state, [landmarks], unknown, settings.fit)
    picks = choose_picks(face, state)
    for _ in range(settings.rounds):
        state = fit_pictures(problem, face, state, picks)
        picks = choose_picks(face, state)
    return _record(problem, face, state, picks, _pupils(model, user, camera, state, [landmarks]))


def _pupils(
    model: FaceModel, user: UserBlendshapes, camera: Camera, state: State,
    landmarks: Sequence[Landmarks2D],
) -> FloatArray:  # fmt: skip
    centers = eye_centers_mm(model, user.neutral_mm)
    return pupils_mm(camera, state, centers, model.eyeball_radius_mm, landmarks)


def _problem(
    camera: Camera, state: State, landmarks: Sequence[Landmarks2D], standard: FloatArray,
    settings: FitSettings,
) -> Problem:  # fmt: skip
    prior = expression_prior(standard, settings.prior)
    return Problem(camera, observe(camera, state, landmarks, settings), prior, settings.pictures)


def _record(
    problem: Problem, face: Face, state: State, picks: I32, pupils: FloatArray
) -> SetupShapes:
    in_camera = posed(face.points_mm(state.expressions), state)
    points = [in_camera[:, :N_INTERNAL], in_camera[:, face.replacements], pupils]
    residuals = residuals_px(problem.camera, face, state, picks, problem.observations)
    return SetupShapes(
        np.concatenate(points, axis=1),
        np.stack([quaternion_from_matrix(one) for one in state.rotations]),
        state.translations_mm,
        state.expressions,
        rms_px(residuals, problem.observations),
    )
