"""Fits the bilinear model to the landmarks of all setup pictures [Cao13, 4.1]."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from core.contour import contour_points
from core.errors import CoreError
from core.face_model import FaceModel
from core.fit_priors import PriorSettings, expression_prior
from core.fit_problem import (
    Observations,
    State,
    posed,
    residuals_px,
    rms_px,
    start_state,
)
from core.fit_space import Face, FitSpace, fit_space
from core.geometry import quaternion_from_matrix
from core.joint_step import JointProblem, Person, joint_energy, joint_step, person_precision
from core.landmarks import N_INTERNAL
from core.picture_fit import Problem, StepSettings, fit_pictures
from core.records import I32, Camera, FloatArray, Landmarks2D, ModelFit, Progress

#: A picture needs this many trusted internal landmarks for its pose to be found.
LEAST_LANDMARKS = 12
#: A face whose landmarks reach less far has no pose that could be found.
LEAST_FACE_PX = 8.0
TRUSTED = 0.3
#: Levenberg-Marquardt on person and pictures: start, factor after a good and after a bad step.
_DAMPING, _LESS, _MORE = 0.03, 0.3, 4.0


class FewLandmarksError(CoreError):
    """A picture has too few trusted landmarks to be fitted."""

    def __init__(self, picture: int, found: int) -> None:
        self.picture, self.found = picture, found
        super().__init__(
            f"picture {picture} has {found} trusted landmarks inside the face, at least "
            f"{LEAST_LANDMARKS} are needed: place them by hand or leave the picture out"
        )


@dataclass(frozen=True, slots=True)
class FitSettings:
    """How the model is fitted.

    Attributes:
        noise_mm: Landmark noise on the face; it weighs the landmarks against the priors.
        hand_noise_mm: The same of landmarks that the user placed.
        contour_weight: Weight of a contour landmark, which is less certain than an internal one.
        deviation: Error of the shapes themselves, as a share of how far they move a point.
        identity_weight: Cost of a squared identity weight. More than the population's 1: landmark
            errors of one person agree from picture to picture, but are counted as independent.
        offset_mm: Usual distance of a landmark from where the model has it.
        prior: What is known of the expressions.
        rounds: Updates of the contour vertices [Cao13: three].
        steps: Most joint steps in a round.
        tolerance: A round ends when the energy falls by less than this share.
        pictures: How poses and expressions are iterated.
    """

    noise_mm: float = 1.6
    hand_noise_mm: float = 0.6
    contour_weight: float = 0.2
    deviation: float = 0.2
    identity_weight: float = 4.0
    offset_mm: float = 1.0
    prior: PriorSettings = field(default_factory=PriorSettings)
    rounds: int = 3
    steps: int = 10
    tolerance: float = 5e-4
    pictures: StepSettings = field(default_factory=StepSettings)


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A fit in its own terms: what the next one starts from."""

    person: Person
    state: State
    picks: I32
    energy: float


def trusted_landmarks(landmarks: Landmarks2D) -> int:
    """Return how many internal landmarks can be trusted; none of those that lie on one spot."""
    trusted = landmarks.confidence[:N_INTERNAL] > TRUSTED
    points = landmarks.points_px[:N_INTERNAL][trusted]
    if not len(points) or np.ptp(points, axis=0).max() < LEAST_FACE_PX:
        return 0
    return len(points)


def check_landmarks(landmarks: Sequence[Landmarks2D]) -> None:
    """Check that every picture can be fitted.

    Raises:
        FewLandmarksError: One cannot.
    """
    for picture, one in enumerate(landmarks):
        if (found := trusted_landmarks(one)) < LEAST_LANDMARKS:
            raise FewLandmarksError(picture, found)


def observe(
    camera: Camera, start: State, landmarks: Sequence[Landmarks2D], settings: FitSettings
) -> Observations:
    """Return the landmarks with their weights.

    The noise is taken as a length on the face, so that near and far faces, small and large
    pictures are treated alike.
    """
    points = np.stack([one.points_px for one in landmarks])
    confidence = np.stack([one.confidence for one in landmarks])
    sigma = settings.noise_mm * camera.focal_px / start.translations_mm[:, 2]
    confidence[:, N_INTERNAL:] *= settings.contour_weight
    by_hand = np.stack([one.edited for one in landmarks])
    confidence[by_hand] *= (settings.noise_mm / settings.hand_noise_mm) ** 2
    return Observations(points, confidence / sigma[:, None] ** 2, sigma)


def trust_in_motion(
    observations: Observations, face: Face, fit: Fit, settings: FitSettings
) -> Observations:
    """Return the observations with less weight on landmarks that an expression has moved far.

    Nobody's smile is quite the model's. Points that stay where they are in the neutral face tell
    more about pose, identity and focal length than those whose motion is only roughly known.
    """
    points = face.points_mm(fit.state.expressions) - face.neutral_mm
    moved = np.take_along_axis(points, fit.picks[..., None], axis=1)
    error_mm = settings.deviation * np.linalg.norm(moved, axis=-1)
    # What is placed by hand weighs more than 1 and says less than it seems all the sooner.
    exactness = np.maximum(observations.weights * observations.sigma_px[:, None] ** 2, 1.0)
    trust = 1 / (1 + exactness * (error_mm / settings.noise_mm) ** 2)
    return replace(observations, weights=observations.weights * trust)


def choose_picks(face: Face, state: State) -> I32:
    """Return the point (N, L) of each landmark in each picture, the contour for its pose."""
    posed_mm = posed(face.points_mm(state.expressions), state)
    contour = contour_points(face.neutral_mm, posed_mm, state.rotations, face.strips)
    internal = np.broadcast_to(np.arange(N_INTERNAL), (len(posed_mm), N_INTERNAL))
    return np.concatenate([internal, contour], axis=1).astype(np.int32)


def first_guess(
    space: FitSpace, camera: Camera, landmarks: Sequence[Landmarks2D], standard: FloatArray
) -> Fit:
    """Return the mean person in the poses that POSIT finds."""
    person = Person(np.zeros(space.n_identities), np.zeros((N_INTERNAL, 3)))
    face = space.face(person.identity, person.offsets_mm)
    state = start_state(camera, face.neutral_mm, landmarks, len(face.deltas_mm))
    state = State(state.rotations, state.translations_mm, np.nan_to_num(standard, nan=0.0))
    return Fit(person, state, choose_picks(face, state), np.inf)


def refine(
    problem: Problem, space: FitSpace, start: Fit, settings: FitSettings
) -> Generator[Progress, None, Fit]:
    """Fit person and pictures together, from a start.

    Yields:
        Progress, once per round.
    """
    fit = start
    for turn in range(settings.rounds):
        face = space.face(fit.person.identity, fit.person.offsets_mm)
        fit = replace(fit, picks=choose_picks(face, fit.state))
        if turn == 0:
            fit = replace(fit, state=fit_pictures(problem, face, fit.state, fit.picks))
        trusted = trust_in_motion(problem.observations, face, fit, settings)
        weighed = replace(problem, observations=trusted)
        fit = joint_rounds(weighed, space, fit, settings)
        yield Progress(turn + 1, settings.rounds, "Fitting the face model", {"energy": fit.energy})
    return fit


def joint_rounds(problem: Problem, space: FitSpace, start: Fit, settings: FitSettings) -> Fit:
    """Return the fit after joint steps with the contour vertices held."""
    n_identity = len(start.person.identity)
    precision = person_precision(n_identity, settings.identity_weight, settings.offset_mm)
    joint = JointProblem(problem, *space.narrowed(start.picks), precision)
    person, state, damping = start.person, start.state, _DAMPING
    energy = joint_energy(joint, person, state)
    for _ in range(settings.steps):
        tried = joint_step(joint, person, state, damping)
        tried_energy = joint_energy(joint, *tried)
        if tried_energy >= energy:
            damping *= _MORE
            continue
        gain, energy = energy - tried_energy, tried_energy
        (person, state), damping = tried, max(damping * _LESS, 1e-6)
        if gain < settings.tolerance * energy:
            break
    return Fit(person, state, start.picks, energy)


def fit_model(
    model: FaceModel, camera: Camera, landmarks: Sequence[Landmarks2D], settings: FitSettings,
    standard: FloatArray | None = None,
) -> Generator[Progress, None, ModelFit]:  # fmt: skip
    """Fit identity, poses and expressions to the landmarks of all pictures [Cao13, eq. 3, 4].

    Args:
        model: The bilinear face model.
        camera: The camera of all pictures.
        landmarks: N pictures' landmarks.
        settings: How to fit.
        standard: (N, B) coefficients a* of prompted expressions, NaN rows where there is no
            prompt; None if there is none at all.

    Yields:
        Progress, once per round.

    Returns:
        The fit.

    Raises:
        FewLandmarksError: A picture cannot be fitted.
    """
    check_landmarks(landmarks)
    space = fit_space(model)
    problem, start = set_up(space, camera, landmarks, settings, standard)
    fit = yield from refine(problem, space, start, settings)
    return as_record(problem, space, fit)


def set_up(
    space: FitSpace, camera: Camera, landmarks: Sequence[Landmarks2D], settings: FitSettings,
    standard: FloatArray | None,
) -> tuple[Problem, Fit]:  # fmt: skip
    """Return the problem and the first guess of a fit."""
    if standard is None:
        standard = np.full((len(landmarks), len(space.delta_modes_mm)), np.nan)
    prior = expression_prior(standard, settings.prior)
    start = first_guess(space, camera, landmarks, standard)
    observations = observe(camera, start.state, landmarks, settings)
    return Problem(camera, observations, prior, settings.pictures), start


def as_record(problem: Problem, space: FitSpace, fit: Fit) -> ModelFit:
    """Return the fit as the record that later stages read."""
    face = space.face(fit.person.identity, fit.person.offsets_mm)
    residuals = residuals_px(problem.camera, face, fit.state, fit.picks, problem.observations)
    return ModelFit(
        fit.person.identity,
        fit.state.expressions,
        np.stack([quaternion_from_matrix(one) for one in fit.state.rotations]),
        fit.state.translations_mm,
        space.vertices[fit.picks],
        rms_px(residuals, problem.observations),
        fit.person.offsets_mm,
    )
