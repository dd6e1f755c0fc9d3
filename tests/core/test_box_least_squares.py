"""Facts about quadratic steps with bounds."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from core.box_least_squares import minimize_half_bounded, minimize_in_boxes


def problem(rng, n_rows, n_values):
    a, b = rng.normal(size=(n_rows, n_values)), rng.normal(size=n_rows)
    return a, b, a.T @ a, -a.T @ b


@pytest.mark.parametrize("seed", range(5))
def test_agrees_with_scipy_on_bounded_least_squares(seed):
    rng = np.random.default_rng(seed)
    a, b, hessian, gradient = problem(rng, 60, 12)
    lower, upper = -rng.uniform(0, 0.1, 12), rng.uniform(0, 0.1, 12)
    found = minimize_in_boxes(
        hessian[None], gradient[None], lower[None], upper[None], np.zeros((1, 12))
    )[0]
    expected = lsq_linear(a, b, (lower - 1e-12, upper + 1e-12), tol=1e-12).x
    np.testing.assert_allclose(found, expected, atol=2e-4)


@pytest.mark.parametrize("seed", range(5))
def test_free_variables_are_eliminated_exactly(seed):
    rng = np.random.default_rng(10 + seed)
    a, b, hessian, gradient = problem(rng, 60, 14)
    lower, upper = -rng.uniform(0, 0.1, 8), rng.uniform(0, 0.1, 8)
    found = minimize_half_bounded(hessian[None], gradient[None], lower[None], upper[None])[0]
    free = np.full(6, np.inf)
    bounds = (np.r_[-free, lower - 1e-12], np.r_[free, upper + 1e-12])
    expected = lsq_linear(a, b, bounds, tol=1e-12).x
    np.testing.assert_allclose(found, expected, atol=5e-4)


def test_without_active_bounds_it_is_the_newton_step():
    rng = np.random.default_rng(3)
    _, _, hessian, gradient = problem(rng, 80, 10)
    wide = np.full((1, 4), 1e3)
    found = minimize_half_bounded(hessian[None], gradient[None], -wide, wide)[0]
    np.testing.assert_allclose(found, -np.linalg.solve(hessian, gradient), atol=1e-4)


def test_problems_side_by_side_do_not_touch_each_other():
    rng = np.random.default_rng(4)
    many = [problem(rng, 50, 9)[2:] for _ in range(3)]
    hessians, gradients = (np.stack(parts) for parts in zip(*many, strict=True))
    box = np.full((3, 5), 0.05)
    together = minimize_half_bounded(hessians, gradients, -box, box)
    for n in range(3):
        alone = minimize_half_bounded(hessians[n : n + 1], gradients[n : n + 1], -box[:1], box[:1])
        np.testing.assert_allclose(together[n], alone[0], atol=1e-12)


def test_the_start_is_left_as_it_was():
    start = np.full((1, 2), 5.0)
    found = minimize_in_boxes(
        np.eye(2)[None], np.zeros((1, 2)), -np.ones((1, 2)), np.ones((1, 2)), start
    )
    assert np.all(start == 5.0)
    np.testing.assert_array_equal(found, 0.0)
