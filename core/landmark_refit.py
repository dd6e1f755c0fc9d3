"""The face model puts the landmarks right that the user has not placed.

The user's few points say most: pose and expression are solved for them, with the aligner's own
points as weak advice, and every other landmark goes to where the posed model has it.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from core.camera import project
from core.face_model import PART_NAMES, FaceModel, eye_centers_mm
from core.fit_priors import PriorSettings, expression_prior
from core.fit_problem import Observations, State, picked, posed, start_state
from core.fit_space import Face, face_at
from core.landmarks import N_INTERNAL
from core.model_fit import LEAST_LANDMARKS, choose_picks
from core.picture_fit import Problem, StepSettings, fit_pictures
from core.pupils import pupils_mm
from core.records import I32, Camera, FloatArray, Landmarks2D, UserBlendshapes

#: Trust in a point of which nothing is known but where it was guessed.
GUESS = 0.1


@dataclass(frozen=True, slots=True)
class RefitSettings:
    """How far the points are believed.

    Attributes:
        placed_mm: Noise of a point that the user placed.
        found_mm: Noise of one that the aligner found, where the user thought it worth a refit.
        contour_weight: Weight of a contour landmark that the aligner found.
        prior: What is known of the expressions.
        rounds: Updates of the contour vertices.
    """

    placed_mm: float = 0.7
    found_mm: float = 6.0
    contour_weight: float = 0.2
    prior: PriorSettings = field(default_factory=lambda: PriorSettings(slope=1.0))
    rounds: int = 2


@dataclass(frozen=True, slots=True, eq=False)
class FittedModel:
    """The face model over a picture.

    Attributes:
        points_px: (75, 2) where it has the landmarks.
        mesh_px: (V, 2) its vertices.
        edges: (E, 2) pairs of vertices: the edges of the skin that faces the camera.
    """

    points_px: FloatArray
    mesh_px: FloatArray
    edges: I32


class Refitter:
    """Refits pictures of one user; remembers only the user's face."""

    def __init__(
        self, model: FaceModel, user: UserBlendshapes, camera: Camera,
        settings: RefitSettings | None = None,
    ) -> None:  # fmt: skip
        self._camera, self._settings = camera, settings or RefitSettings()
        self._user, self._face = user, face_at(model, user)
        self._skin = model.triangles[model.part == PART_NAMES.index("skin")]
        self._eyes_mm = eye_centers_mm(model, user.neutral_mm)
        self._radius_mm = model.eyeball_radius_mm

    def refit(self, landmarks: Landmarks2D, standard: FloatArray) -> Landmarks2D:
        """Return the landmarks with all that the user has not placed where the model has them.

        Args:
            landmarks: Of one picture.
            standard: (B,) coefficients a* of its prompt, NaN where there is none.
        """
        state = self._solved(landmarks, standard)
        points = project(self._camera, self._points_mm(state))[0]
        kept = landmarks.edited
        pupils = pupils_mm(self._camera, state, self._eyes_mm, self._radius_mm, [landmarks])[0]
        unsure = landmarks.pupil_confidence < 1
        return replace(
            landmarks,
            points_px=np.where(kept[:, None], landmarks.points_px, points),
            confidence=np.where(kept, landmarks.confidence, np.maximum(landmarks.confidence, 0.5)),
            pupils_px=np.where(unsure[:, None], project(self._camera, pupils), landmarks.pupils_px),
        )

    def model_points(self, landmarks: Landmarks2D, standard: FloatArray) -> FloatArray:
        """Return where the model, fitted to all landmarks as they are, has them: (75, 2) px."""
        state = self._solved(landmarks, standard)
        return np.asarray(project(self._camera, self._points_mm(state))[0])

    def fitted(self, landmarks: Landmarks2D, standard: FloatArray) -> FittedModel:
        """Return the model fitted to all landmarks as they are, to compare."""
        state = self._solved(landmarks, standard)
        points_px = np.asarray(project(self._camera, self._points_mm(state))[0])
        moved = np.tensordot(state.expressions[0], self._user.deltas_mm, axes=1)
        mesh_px = project(self._camera, posed((self._user.neutral_mm + moved)[None], state)[0])
        a, b, c = np.moveaxis(mesh_px[self._skin], 1, 0)
        ab, ac = b - a, c - a
        # The corners of triangles that face the camera turn counterclockwise in the picture.
        faces = ab[:, 0] * ac[:, 1] < ab[:, 1] * ac[:, 0]
        sides = self._skin[faces][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        edges = np.unique(np.sort(sides, axis=1), axis=0).astype(np.int32)
        return FittedModel(points_px, np.asarray(mesh_px), edges)

    def _points_mm(self, state: State) -> FloatArray:
        return picked(self._face, state, choose_picks(self._face, state))

    def _solved(self, landmarks: Landmarks2D, standard: FloatArray) -> State:
        start = _start(self._camera, self._face, landmarks)
        prior = expression_prior(standard[None], self._settings.prior)
        problem = Problem(self._camera, self._observed(start, landmarks), prior, StepSettings())
        state = start
        for _ in range(self._settings.rounds):
            state = fit_pictures(problem, self._face, state, choose_picks(self._face, state))
        return state

    def _observed(self, start: State, landmarks: Landmarks2D) -> Observations:
        settings = self._settings
        px_per_mm = self._camera.focal_px / start.translations_mm[:, 2]
        placed = landmarks.edited & (landmarks.confidence > 0)
        noise_mm = np.where(placed, settings.placed_mm, settings.found_mm)
        weights = _trust(landmarks) / (noise_mm * px_per_mm[:, None]) ** 2
        found = ~placed
        found[:N_INTERNAL] = False
        weights = np.where(found, settings.contour_weight * weights, weights)
        return Observations(landmarks.points_px[None], weights, settings.placed_mm * px_per_mm)


def _trust(landmarks: Landmarks2D) -> FloatArray:
    """Return the weights (75,) of the points; a guess is weak advice, a hidden point none."""
    return np.where(landmarks.edited, landmarks.confidence, np.maximum(landmarks.confidence, GUESS))


def _start(camera: Camera, face: Face, landmarks: Landmarks2D) -> State:
    """Return the pose of the placed points where they suffice, else that of all points."""
    trust = _trust(landmarks)
    placed = landmarks.edited & (landmarks.confidence > 0)
    if placed[:N_INTERNAL].sum() >= LEAST_LANDMARKS:
        trust = np.where(placed, 1.0, 0.0)
    believed = replace(landmarks, confidence=trust)
    return start_state(camera, face.neutral_mm, [believed], len(face.deltas_mm))
