"""Facts about fitting the face model to landmarks."""

from dataclasses import replace

import numpy as np
import pytest

from core.arkit import EXPRESSION_NAMES
from core.fit_priors import PriorSettings, expression_prior
from core.fit_problem import State, linearise, residuals_px, robust_weights
from core.geometry import matrix_from_rotation_vector, rotation_vector_from_matrix
from core.joint_step import (
    JointProblem,
    Person,
    joint_energy,
    joint_step,
    person_precision,
    shared_jacobian,
)
from core.model_fit import FewLandmarksError, FitSettings, check_landmarks, refine, set_up
from core.picture_fit import fit_pictures
from core.shared_equations import SharedJacobian
from tests.core.synthetic_fit import (
    landmarks_of,
    result_of,
    synthetic_pictures,
    synthetic_space,
)

SPACE = synthetic_space()
USUAL = FitSettings()
#: Priors so weak that exact landmarks decide alone.
TRUSTING = FitSettings(
    noise_mm=0.02,
    contour_weight=1.0,
    deviation=0.0,
    offset_mm=1e-3,
    prior=PriorSettings(slope=0.0),
    rounds=4,
)


def pictures(seed=1, **kwargs):
    rng = np.random.default_rng(seed)
    return synthetic_pictures(SPACE, rng.normal(size=8), rng, **kwargs)


def problem_of(data, settings=USUAL):
    problem, _ = set_up(SPACE, data.camera, data.landmarks, settings, None)
    return problem


def fit_of(data, settings=USUAL, standard=None):
    problem, start = set_up(SPACE, data.camera, data.landmarks, settings, standard)
    return result_of(refine(problem, SPACE, start, settings))


def dense(shared):
    """Return the whole Jacobian (N, L, 2, I + 180)."""
    n_pictures, n_landmarks, _, n_identity = shared.identity.shape
    out = np.zeros((n_pictures, n_landmarks, 2, n_identity + 180))
    out[..., :n_identity] = shared.identity
    for landmark in range(60):
        first = n_identity + 3 * landmark
        out[:, landmark, :, first : first + 3] = shared.offsets[:, landmark]
    return out


def random_steps(rng, data):
    steps = rng.normal(size=(len(data.picks), 52)) * 0.01
    steps[:, 3:6] *= 100
    return steps


def inside(data):
    """The true state with every coefficient away from its bounds."""
    return replace(data.state, expressions=np.full_like(data.state.expressions, 0.4))


def test_derivatives_by_pose_and_expression_agree_with_finite_differences():
    data, rng = pictures(), np.random.default_rng(2)
    problem, state = problem_of(data), inside(pictures())
    state = replace(state, translations_mm=state.translations_mm + 5.0)
    linear = linearise(data.camera, data.face, state, data.picks, problem.observations)
    direction, size = random_steps(rng, data), 1e-4

    def residuals(step):
        moved = state.moved(step * direction)
        return residuals_px(data.camera, data.face, moved, data.picks, problem.observations)

    numeric = (residuals(size) - residuals(-size)) / (2 * size)
    analytic = np.einsum("nlcp,np->nlc", linear.local, direction)
    np.testing.assert_allclose(analytic, numeric, atol=1e-4)


def test_derivatives_by_identity_and_offsets_agree_with_finite_differences():
    data, rng = pictures(), np.random.default_rng(3)
    problem, state = problem_of(data), inside(pictures())
    person = Person(rng.normal(size=8), rng.normal(size=(60, 3)))
    direction, size = rng.normal(size=8 + 180), 1e-4

    def residuals(step):
        moved = person.moved(step * direction)
        face = SPACE.face(moved.identity, moved.offsets_mm)
        return residuals_px(data.camera, face, state, data.picks, problem.observations)

    face = SPACE.face(person.identity, person.offsets_mm)
    linear = linearise(data.camera, face, state, data.picks, problem.observations)
    shared = shared_jacobian(SPACE, state, data.picks, linear.lift, np.ones((1, 1, 1, 1)))
    analytic = dense(shared) @ direction
    numeric = (residuals(size) - residuals(-size)) / (2 * size)
    np.testing.assert_allclose(analytic, numeric, atol=1e-4)


def test_shared_equations_agree_with_the_whole_jacobian():
    rng = np.random.default_rng(9)
    shared = SharedJacobian(rng.normal(size=(4, 75, 2, 8)), rng.normal(size=(4, 60, 2, 3)))
    whole, residuals = dense(shared), rng.normal(size=(4, 75, 2))
    local = rng.normal(size=(4, 75, 2, 11))
    flat = whole.reshape(-1, 188)
    np.testing.assert_allclose(shared.hessian(), flat.T @ flat, atol=1e-9)
    np.testing.assert_allclose(shared.gradient(residuals), flat.T @ residuals.ravel(), atol=1e-9)
    naive = np.einsum("nlcp,nlcg->npg", local, whole)
    np.testing.assert_allclose(shared.cross(local), naive, atol=1e-9)


def test_a_far_landmark_pulls_with_a_constant_force():
    problem = problem_of(pictures())
    sigma = problem.observations.sigma_px[:, None]
    pulls = []
    for far in (5.0, 50.0):
        residuals = np.zeros((12, 75, 2))
        residuals[..., 0] = far * sigma
        pulls.append(robust_weights(residuals, problem.observations, 2.0) * far)
    np.testing.assert_allclose(pulls[0], pulls[1])


def test_exact_landmarks_give_back_the_person_and_the_poses():
    data = pictures(n_pictures=24)
    fit = fit_of(data, TRUSTING)
    np.testing.assert_allclose(fit.person.identity, data.identity, atol=0.15)
    turn = [
        rotation_vector_from_matrix(a @ b.T)
        for a, b in zip(fit.state.rotations, data.state.rotations, strict=True)
    ]
    assert np.rad2deg(np.linalg.norm(turn, axis=1)).max() < 0.7
    assert np.abs(fit.state.expressions - data.state.expressions).mean() < 0.02
    assert np.abs(fit.state.translations_mm - data.state.translations_mm).max() < 8.0


def test_noisy_landmarks_are_fitted_to_their_noise():
    data = pictures(n_pictures=24, noise_px=0.7)
    fit = fit_of(data)
    face = SPACE.face(fit.person.identity, fit.person.offsets_mm)
    problem = problem_of(data)
    residuals = residuals_px(data.camera, face, fit.state, fit.picks, problem.observations)
    assert np.sqrt(np.mean(residuals[:, :60] ** 2)) < 0.9
    shape_error = np.linalg.norm((face.neutral_mm - data.face.neutral_mm)[:60], axis=1)
    assert shape_error.mean() < 2.0


def test_coefficients_are_coefficients_and_lips_close_over_an_open_jaw_only():
    fit = fit_of(pictures(noise_px=2.0))
    found = fit.state.expressions
    assert found.min() >= 0 and found.max() <= 1
    close, jaw = (EXPRESSION_NAMES.index(name) for name in ("mouthClose", "jawOpen"))
    assert np.all(found[:, close] <= found[:, jaw] + 1e-9)


def test_neutral_pictures_get_no_expression():
    data = pictures()
    neutral = replace(data.state, expressions=np.zeros_like(data.state.expressions))
    rng = np.random.default_rng(5)
    seen = residuals_px(
        data.camera, data.face, neutral, data.picks,
        replace(problem_of(data).observations, points_px=np.zeros((12, 75, 2))),
    )  # fmt: skip
    noisy = seen + 0.5 * rng.normal(size=seen.shape)
    data.landmarks = [landmarks_of(one) for one in noisy]
    found = fit_of(data).state.expressions
    assert found.mean() < 0.005 and np.mean(found > 0.1) < 0.01


def test_what_has_no_confidence_has_no_say():
    data = pictures()
    one = data.landmarks[0]
    confidence = np.ones(75)
    confidence[[5, 70]] = 0.0
    nonsense = one.points_px.copy()
    nonsense[[5, 70]] = 1000.0
    fits = []
    for points in (one.points_px, nonsense):
        data.landmarks[0] = replace(one, points_px=points, confidence=confidence)
        fits.append(fit_of(data))
    np.testing.assert_allclose(fits[0].person.identity, fits[1].person.identity, atol=1e-9)
    np.testing.assert_allclose(fits[0].state.expressions, fits[1].state.expressions, atol=1e-9)


def test_a_few_wild_landmarks_do_little_harm():
    data = pictures(n_pictures=24, noise_px=0.5)
    wild = [one.points_px.copy() for one in data.landmarks]
    rng = np.random.default_rng(6)
    for points in wild:
        points[rng.integers(0, 60, 2)] += rng.normal(size=(2, 2)) * 40
    spoilt = replace_landmarks(data, wild)
    error = np.abs(fit_of(spoilt).state.translations_mm - fit_of(data).state.translations_mm)
    assert error[:, :2].max() < 1.5


def replace_landmarks(data, points):
    out = pictures(n_pictures=len(points), noise_px=0.5)
    out.landmarks = [landmarks_of(one) for one in points]
    assert data.camera.focal_px == out.camera.focal_px
    return out


def test_a_prompt_decides_what_the_landmarks_leave_open():
    data = pictures()
    hidden = [replace(one, confidence=np.r_[np.ones(60), np.zeros(15)]) for one in data.landmarks]
    standard = np.full((12, 46), np.nan)
    standard[3] = 0.0
    standard[3, 7] = 0.8
    settings = FitSettings(noise_mm=50.0)
    problem, start = set_up(SPACE, data.camera, hidden, settings, standard)
    state = fit_pictures(
        problem, SPACE.face(np.zeros(8), np.zeros((60, 3))), start.state, start.picks
    )
    assert state.expressions[3, 7] == pytest.approx(0.8, abs=0.1)
    assert state.expressions[3].sum() == pytest.approx(0.8, abs=0.2)


def test_a_joint_step_near_the_optimum_is_a_newton_step():
    data = pictures(n_pictures=24)
    problem = problem_of(data, TRUSTING)
    joint = JointProblem(problem, SPACE, data.picks, person_precision(8, 1.0, 1e-3))
    rng = np.random.default_rng(7)
    person = Person(data.identity + 0.05 * rng.normal(size=8), np.zeros((60, 3)))
    before = joint_energy(joint, person, data.state)
    after = joint_energy(joint, *joint_step(joint, person, data.state, 1e-9))
    assert after < 0.02 * before


def test_pose_steps_turn_the_head_in_place():
    data = pictures()
    steps = np.zeros((12, 52))
    steps[:, 1] = 0.1
    moved = data.state.moved(steps)
    expected = matrix_from_rotation_vector(np.array([0, 0.1, 0])) @ data.state.rotations[0]
    np.testing.assert_allclose(moved.rotations[0], expected)
    np.testing.assert_array_equal(moved.translations_mm, data.state.translations_mm)


def test_energy_of_the_prior_has_the_gradient_it_says():
    rng = np.random.default_rng(8)
    standard = np.where(rng.random((3, 46)) < 0.5, 0.0, rng.random((3, 46)))
    standard[1], standard[2] = np.nan, 0.0
    prior = expression_prior(standard, PriorSettings())
    at, direction, size = rng.random((3, 46)), rng.normal(size=(3, 46)), 1e-6
    numeric = prior.energy(at + size * direction) - prior.energy(at - size * direction)
    analytic = 2 * np.sum(prior.half_gradient(at) * direction, axis=1)
    np.testing.assert_allclose(analytic, numeric / (2 * size), rtol=1e-5)


def test_says_which_picture_has_too_few_landmarks():
    data = pictures()
    data.landmarks[4] = landmarks_of(data.landmarks[4].points_px, confidence=0.1)
    with pytest.raises(
        FewLandmarksError, match=r"picture 4 has 0 .* leave the picture out"
    ) as caught:
        check_landmarks(data.landmarks)
    assert caught.value.picture == 4 and caught.value.found == 0


def test_landmarks_on_one_spot_show_no_face():
    data = pictures()
    data.landmarks[2] = landmarks_of(np.full_like(data.landmarks[2].points_px, 100.0))
    with pytest.raises(FewLandmarksError, match=r"picture 2 has 0"):
        check_landmarks(data.landmarks)


def test_the_state_of_some_pictures_can_be_taken_over():
    data = pictures()
    other = State(data.state.rotations, data.state.translations_mm + 1, data.state.expressions)
    better = np.arange(12) < 3
    mixed = data.state.where(better, other)
    change = (mixed.translations_mm - data.state.translations_mm)[:, 0]
    np.testing.assert_array_equal(change, better.astype(float))
