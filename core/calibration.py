"""The camera's focal length from the setup pictures [Cao13, camera calibration, fig. 5].

A wrong focal length distorts the projected face, so the fitting error is least at the true one.
The error that we search is that of the whole fit: landmarks, identity and expressions. Identity
depth can stand in for perspective, and only the price of an unlikely face tells them apart; turned
heads show the depth and make the minimum sharp. Where all pictures are frontal the error hardly
depends on the focal length, and the usual focal length of webcams decides.
"""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import cv2
import numpy as np

from core.camera import camera_for
from core.errors import CoreError
from core.face_model import FaceModel
from core.fit_priors import PriorSettings
from core.fit_problem import State
from core.fit_space import FitSpace, fit_space
from core.focal_search import FocalNotBracketedError, search_focal, smooth_minimum
from core.joint_step import Person
from core.landmarks import N_INTERNAL
from core.model_fit import (
    Fit,
    FitSettings,
    check_landmarks,
    joint_rounds,
    refine,
    set_up,
    trust_in_motion,
)
from core.picture_fit import Problem, fit_pictures
from core.records import U8, Camera, FloatArray, Landmarks2D, ModelFit, Progress

T = TypeVar("T")

#: A chessboard must be seen this often.
LEAST_BOARDS = 3


class ChessboardError(CoreError):
    """Too few pictures show the whole chessboard."""

    def __init__(self, found: int, pattern: tuple[int, int]) -> None:
        self.found, self.pattern = found, pattern
        super().__init__(
            f"found a chessboard of {pattern[0]} x {pattern[1]} inner corners in {found} "
            f"pictures, at least {LEAST_BOARDS} are needed: show it whole, sharp and tilted"
        )


@dataclass(frozen=True, slots=True)
class CalibrationSettings:
    """How the focal length is searched.

    Attributes:
        fit: How the model is fitted at each focal length. The contour hardly counts: its
            vertices jump along their strips, which costs more than their places tell.
        low_widths: Shortest focal length, in image widths.
        high_widths: Longest focal length, in image widths.
        usual_widths: Usual focal length of webcams, 60 degrees of view, in image widths.
        usual_spread: How far others are from that, as a ratio.
        dispersion: What the energy is divided by before it meets the usual value: an aligner's
            errors agree from picture to picture, but are counted as independent. Those of
            landmarks placed by hand do not agree; they count in full.
        evaluations: Fits after the first.
        steps: Most joint steps of each.
        tolerance: A fit ends when its error falls by less than this share.
        near_ratio: A search that begins at an earlier result looks so far to both sides of it.
        near_evaluations: Fits after the first of such a search.
    """

    fit: FitSettings = field(
        default_factory=lambda: FitSettings(
            noise_mm=1.0,
            hand_noise_mm=0.5,
            contour_weight=0.02,
            deviation=0.3,
            identity_weight=1.0,
            prior=PriorSettings(slope=4.0),
        )
    )
    low_widths: float = 0.4
    high_widths: float = 3.0
    usual_widths: float = 0.87
    usual_spread: float = 0.25
    dispersion: float = 2.0
    evaluations: int = 10
    steps: int = 12
    tolerance: float = 1e-5
    near_ratio: float = 1.2
    near_evaluations: int = 5


@dataclass(frozen=True, slots=True, eq=False)
class Before:
    """What an earlier training of the same person with the same camera found.

    Attributes:
        focal_px: Focal length.
        fit: The fitted model; only the person is taken from it.
    """

    focal_px: float
    fit: ModelFit


@dataclass(frozen=True, slots=True, eq=False)
class FocalEstimate:
    """What the search found.

    Attributes:
        camera: The camera with the best focal length.
        spread: Standard deviation of the logarithm of the focal length as far as landmark noise
            tells. What an aligner gets wrong alike in all pictures is not in it.
        focals_px: (K,) focal lengths tried, ascending.
        errors: (K,) their errors, up to a constant twice the negative log probability.
    """

    camera: Camera
    spread: float
    focals_px: FloatArray
    errors: FloatArray


def calibrate(
    model: FaceModel, size_px: tuple[int, int], landmarks: Sequence[Landmarks2D],
    standard: FloatArray | None, settings: CalibrationSettings,
) -> Generator[Progress, None, Camera]:  # fmt: skip
    """Return the camera of the setup pictures; see `estimate_focal`."""
    estimate = yield from estimate_focal(model, size_px, landmarks, standard, settings)
    return estimate.camera


def estimate_focal(
    model: FaceModel, size_px: tuple[int, int], landmarks: Sequence[Landmarks2D],
    standard: FloatArray | None, settings: CalibrationSettings, before: Before | None = None,
) -> Generator[Progress, None, FocalEstimate]:  # fmt: skip
    """Find the focal length at which the face model fits the pictures best.

    After an earlier training the search begins at its result and looks around it only; that takes
    half the time and finds the same. Where the error still falls at the edge it begins anew.

    Args:
        model: The bilinear face model.
        size_px: Width and height of the pictures.
        landmarks: N pictures' landmarks.
        standard: (N, B) coefficients a*, NaN rows or None without prompts.
        settings: How to search.
        before: What an earlier training found.

    Yields:
        Progress, once per round of the first fit, then with the focal length and its error once
        per evaluation.

    Raises:
        FewLandmarksError: A picture cannot be fitted.
        FocalNotBracketedError: The error falls up to an end of the interval.
    """
    check_landmarks(landmarks)
    space, width = fit_space(model), size_px[0]
    settings = replace(settings, dispersion=_dispersion(landmarks, settings))
    if before is not None:
        near = camera_for(size_px, before.focal_px)
        problem, guess = set_up(space, near, landmarks, settings.fit, standard)
        start = replace(guess, person=Person(before.fit.identity, before.fit.offsets_mm))
        try:
            narrow = _around(before.focal_px / width, settings)
            return (yield from _searched(problem, space, start, narrow))
        except FocalNotBracketedError:
            # Too much has changed.
            pass
    camera = camera_for(size_px, settings.usual_widths * width)
    problem, start = set_up(space, camera, landmarks, settings.fit, standard)
    return (yield from _searched(problem, space, start, settings))


def _around(widths: float, settings: CalibrationSettings) -> CalibrationSettings:
    """Return the settings of a search around a focal length in image widths."""
    return replace(
        settings,
        fit=replace(settings.fit, rounds=1),
        low_widths=widths / settings.near_ratio,
        high_widths=widths * settings.near_ratio,
        evaluations=settings.near_evaluations,
    )


def _searched(
    problem: Problem, space: FitSpace, start: Fit, settings: CalibrationSettings
) -> Generator[Progress, None, FocalEstimate]:
    """Search the interval of the settings, from a start."""
    size_px = problem.camera.size_px
    rounds, total = settings.fit.rounds, settings.fit.rounds + settings.evaluations + 1
    first = yield from _part(refine(problem, space, start, settings.fit), 0, total)
    trial = _Trials(problem, space, first, settings)
    low, high = settings.low_widths * size_px[0], settings.high_widths * size_px[0]
    search = search_focal(trial.error, low, high, settings.evaluations - 1)
    best = yield from _part(search, rounds, total)
    focals = np.array(sorted(trial.tried))
    errors = np.array([trial.tried[focal] for focal in focals])
    middle, spread = smooth_minimum(np.log(focals), errors, np.log(best))
    return FocalEstimate(camera_for(size_px, float(np.exp(middle))), spread, focals, errors)


def _dispersion(landmarks: Sequence[Landmarks2D], settings: CalibrationSettings) -> float:
    """Return what the energy is divided by, 1 where all trusted landmarks are placed by hand."""
    trust = np.stack([one.confidence[:N_INTERNAL] for one in landmarks])
    by_hand = np.stack([one.edited[:N_INTERNAL] for one in landmarks])
    share = np.average(by_hand, weights=trust)
    return float(1 + (settings.dispersion - 1) * (1 - share))


def _part(
    steps: Generator[Progress, None, T], before: int, total: int
) -> Generator[Progress, None, T]:
    """Run a part of the work that comes after `before` steps of `total`."""
    while True:
        try:
            inner = next(steps)
        except StopIteration as end:
            return end.value  # type: ignore[no-any-return]
        yield replace(inner, done=before + inner.done, total=total)


class _Trials:
    """Fits at one focal length after the other, each from the nearest one before.

    Contour vertices and weights are those of the first fit: chosen anew, the error would jump.
    """

    def __init__(
        self, problem: Problem, space: FitSpace, first: Fit, settings: CalibrationSettings
    ):
        face = space.face(first.person.identity, first.person.offsets_mm)
        trusted = trust_in_motion(problem.observations, face, first, settings.fit)
        self._settings, self._space = settings, space
        self._problem = replace(problem, observations=trusted)
        self._fits = {problem.camera.focal_px: first}
        self.tried: dict[float, float] = {}

    def error(self, focal_px: float) -> float:
        """Return the error of the best fit at a focal length, and remember it."""
        settings = self._settings
        nearest = min(self._fits, key=lambda other: abs(np.log(other / focal_px)))
        start = _zoomed(self._fits[nearest], focal_px / nearest)
        problem = replace(self._problem, camera=camera_for(self._problem.camera.size_px, focal_px))
        face = self._space.face(start.person.identity, start.person.offsets_mm)
        state = fit_pictures(problem, face, start.state, start.picks)
        start = replace(start, state=state)
        steps = replace(settings.fit, steps=settings.steps, tolerance=settings.tolerance)
        fit = joint_rounds(problem, self._space, start, steps)
        self._fits[focal_px] = fit
        widths = focal_px / problem.camera.size_px[0]
        unusual = np.log(widths / settings.usual_widths) / settings.usual_spread
        # Cauchy: an unusual lens costs something, but clear evidence for one is believed.
        error = fit.energy / settings.dispersion + 2 * np.log1p(unusual**2)
        self.tried[focal_px] = error
        return float(error)


def _zoomed(fit: Fit, factor: float) -> Fit:
    """Return the fit with the heads moved away as the focal length grows."""
    state = fit.state
    moved = State(state.rotations, state.translations_mm * [1, 1, factor], state.expressions)
    return replace(fit, state=moved)


def chessboard_camera(images: Sequence[U8], pattern: tuple[int, int]) -> Camera:
    """Return the camera from pictures of a chessboard [Zhang 2000].

    The model is the one we use: square pixels, principal point in the middle, no distortion.

    Args:
        images: Pictures (H, W) or (H, W, 3) uint8, all of one size.
        pattern: Inner corners across and down.

    Raises:
        ChessboardError: Too few pictures show the board.
    """
    grays = [one if one.ndim == 2 else cv2.cvtColor(one, cv2.COLOR_RGB2GRAY) for one in images]
    corners = [found for gray in grays if (found := _corners(gray, pattern)) is not None]
    if len(corners) < LEAST_BOARDS:
        raise ChessboardError(len(corners), pattern)
    board = np.zeros((pattern[0] * pattern[1], 3), np.float32)
    board[:, :2] = np.mgrid[: pattern[0], : pattern[1]].T.reshape(-1, 2)
    height, width = grays[0].shape
    start = camera_for((width, height), float(width))
    matrix = np.array([[width, 0, start.center_px[0]], [0, width, start.center_px[1]], [0, 0, 1.0]])
    fixed = cv2.CALIB_FIX_PRINCIPAL_POINT | cv2.CALIB_FIX_ASPECT_RATIO | cv2.CALIB_ZERO_TANGENT_DIST
    fixed |= cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3 | cv2.CALIB_USE_INTRINSIC_GUESS
    boards = [board] * len(corners)
    _, matrix, *_ = cv2.calibrateCamera(
        boards, corners, (width, height), matrix, np.zeros(5), flags=fixed
    )
    return camera_for((width, height), float(matrix[0, 0]))


def _corners(gray: U8, pattern: tuple[int, int]) -> FloatArray | None:
    """Return the inner corners of a chessboard (P, 1, 2), None where it is not seen whole."""
    found, corners = cv2.findChessboardCorners(gray, pattern)
    if not found:
        return None
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 40, 1e-3)
    return np.asarray(cv2.cornerSubPix(gray, corners, (5, 5), (-1, -1), stop))
