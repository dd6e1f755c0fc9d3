"""The training-free solvers' inner loops: derivatives, equations, outline."""

import numpy as np
import pytest

from core.contour import contour_points
from core.energy_face import landmark_rows, solver_face, workspace_for
from core.energy_terms import JointSettings, PaperSettings, joint_terms, paper_terms
from core.geometry import matrix_from_rotation_vector, rotation_vector_from_matrix
from core.kernels import energy
from tests.core.seen_faces import CAMERA, face, head_pose, landmarks
from tests.core.tracked_faces import expression, needs_compiled_kernels

PINHOLE = np.array([620.0, 319.5, 239.5])
STEP = 1e-5


@pytest.fixture
def rng():
    return np.random.default_rng(5)


class Scene:
    """A face in a pose, its landmarks a little off, and memory for the kernels."""

    def __init__(self, rng, n_landmarks=68):
        self.rows = landmark_rows(n_landmarks)
        self.solver = solver_face(face(), self.rows)
        self.tables, self.work = self.solver.tables, workspace_for(self.solver.tables)
        self.coefficients = 0.5 * rng.random(46)
        self.pose = head_pose(0.4, -0.2, 0.1, (20.0, -30.0, 550.0))
        seen = landmarks(face(), self.coefficients, self.pose)[self.rows]
        self.points = np.ascontiguousarray((seen + rng.normal(size=seen.shape)).T)
        energy.pick_outline(self.tables, self.pose, self.coefficients, self.work)
        self.work.root[:] = 0.5 + rng.random(len(self.rows))
        self.express(self.coefficients)

    def express(self, coefficients):
        energy.express(self.tables.neutral, self.tables.deltas, coefficients, self.work.shape)

    def residual(self, pose, coefficients):
        self.express(coefficients)
        energy.reproject(self.points, PINHOLE, pose, self.work)
        return self.work.residual.ravel().copy()


def slope_of(function, at):
    """Return the central differences of a function of a row, (..., len(at))."""
    columns = []
    for i in range(len(at)):
        ahead, behind = at.copy(), at.copy()
        ahead[i] += STEP
        behind[i] -= STEP
        columns.append((function(ahead) - function(behind)) / (2 * STEP))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("size", [0.0, 1e-8, 1e-5, 0.3, 3.0])
def test_matrix_and_its_change_agree_with_the_exponential(rng, size):
    axis = rng.normal(size=3)
    vector = size * axis / np.linalg.norm(axis)
    matrix, left = np.empty((3, 3)), np.empty((3, 3))
    energy.matrix_of(vector, matrix)
    energy.left_jacobian(vector, left)
    np.testing.assert_allclose(matrix, matrix_from_rotation_vector(vector), atol=1e-12)
    small = 1e-5 * rng.normal(size=3)
    moved = matrix_from_rotation_vector(vector + small) @ matrix.T
    np.testing.assert_allclose(rotation_vector_from_matrix(moved), left @ small, atol=2e-9)


@pytest.mark.parametrize("n_landmarks", [68, 75])
def test_jacobian_is_that_of_finite_differences(rng, n_landmarks):
    scene = Scene(rng, n_landmarks)

    def moved(row):
        pose = np.vstack([matrix_from_rotation_vector(row[:3]) @ scene.pose[:3], scene.pose[3]])
        pose[3] += row[3:6]
        return scene.residual(pose, row[6:])

    numeric = slope_of(moved, np.concatenate([np.zeros(6), scene.coefficients]))
    scene.express(scene.coefficients)
    energy.pose_jacobian(PINHOLE, scene.pose, scene.work)
    energy.expression_jacobian(scene.tables, scene.work)
    analytic = scene.work.jacobian.reshape(52, -1).T
    np.testing.assert_allclose(analytic, numeric, atol=1e-5 * np.abs(numeric).max())


def test_pose_equations_are_the_derivatives_of_eq_8_and_9(rng):
    scene = Scene(rng)
    terms = paper_terms(PaperSettings(rotation_smoothness=2e4, translation_smoothness=0.3))
    vector = np.concatenate([rotation_vector_from_matrix(scene.pose[:3]), scene.pose[3]])
    predicted = vector + 0.02 * rng.normal(size=6)

    def cost(row):
        return energy.pose_energy(row, predicted, terms, scene.points, PINHOLE, scene.work)

    numeric = slope_of(cost, vector)
    cost(vector)
    energy.pose_equations(vector, predicted, terms, PINHOLE, scene.work)
    np.testing.assert_allclose(2 * scene.work.gradient[:6], numeric, rtol=1e-5, atol=1e-2)
    jacobian = scene.work.jacobian[:6].reshape(6, -1)
    expected = jacobian @ jacobian.T + np.diag(terms.smooth)
    np.testing.assert_allclose(scene.work.hessian[:6, :6], expected, rtol=1e-10)


@pytest.mark.parametrize("bounds", ["barrier", "box"])
def test_expression_equations_are_the_derivatives_of_eq_10_to_12(rng, bounds):
    scene = Scene(rng)
    terms = paper_terms(PaperSettings(bounds=bounds, barrier_a=1.01, barrier_b=0.01))
    scene.work.pose[:] = scene.pose
    inside = 0.2 + 0.6 * scene.coefficients

    def cost(row):
        return energy.expression_energy(row, scene.tables, terms, scene.points, PINHOLE, scene.work)

    numeric = slope_of(cost, inside)
    cost(inside)
    energy.expression_equations(inside, scene.tables, terms, PINHOLE, scene.work)
    np.testing.assert_allclose(2 * scene.work.gradient[6:], numeric, rtol=1e-4, atol=1e-3)


def test_printed_barrier_is_flat_on_both_sides_of_a_wall():
    barrier = paper_terms(PaperSettings(bounds="barrier")).barrier
    for inside in (0.0, 0.3, 1.0):
        assert energy.barrier_value(inside, barrier) == pytest.approx(0.0326, abs=0.01)
    for outside in (-0.01, -1.0, 1.01, 2.0):
        assert energy.barrier_value(outside, barrier) == pytest.approx(2.5, abs=0.01)
    assert energy.barrier_value(1.002, barrier) == pytest.approx(2.5 - np.pi**2 / 8, abs=0.01)


@pytest.mark.parametrize("first, last", [(0, 52), (0, 6), (6, 52), (3, 10), (0, 1), (5, 12)])
def test_normal_equations_are_the_products(rng, first, last):
    work = Scene(rng).work
    work.jacobian[:] = rng.normal(size=work.jacobian.shape)
    work.residual[:] = rng.normal(size=work.residual.shape)
    energy.normal_equations(work, first, last)
    jacobian = work.jacobian.reshape(52, -1)[first:last]
    np.testing.assert_allclose(
        work.hessian[first:last, first:last], jacobian @ jacobian.T, rtol=1e-10, atol=1e-9
    )
    np.testing.assert_allclose(
        work.gradient[first:last], jacobian @ work.residual.ravel(), rtol=1e-10, atol=1e-9
    )


def test_damped_solution_is_that_of_numpy_and_a_zero_row_stays(rng):
    root = rng.normal(size=(20, 30))
    hessian, gradient = root @ root.T, rng.normal(size=20)
    hessian[7] = hessian[:, 7] = 0.0
    step = np.empty(20)
    energy.solve_damped(hessian, gradient, 0.1, np.empty((20, 20)), step)
    others = np.delete(np.arange(20), 7)
    reduced = (hessian + 0.1 * np.diag(np.diag(hessian)))[np.ix_(others, others)]
    np.testing.assert_allclose(step[others], np.linalg.solve(reduced, -gradient[others]))
    assert step[7] == 0.0


@pytest.mark.parametrize("yaw", [-1.0, -0.4, 0.0, 0.2, 0.7])
def test_outline_is_that_of_the_fits(rng, yaw):
    scene = Scene(rng, 75)
    person, coefficients = face(), expression(jawOpen=0.5)
    pose = head_pose(yaw, 0.15, -0.1, (40.0, 0.0, 500.0))
    posed = person.points_mm(coefficients[None])[0] @ pose[:3].T + pose[3]
    expected = contour_points(person.neutral_mm, posed[None], pose[None, :3], person.strips)[0]
    energy.pick_outline(scene.tables, pose, coefficients, scene.work)
    along = person.strips[person.strips >= 0]
    np.testing.assert_array_equal(along[scene.tables.picks], expected)
    np.testing.assert_array_equal(scene.tables.neutral[:, -15:].T, person.neutral_mm[expected])


def test_far_landmarks_count_a_quarter_at_the_robust_distance(rng):
    scene = Scene(rng)
    energy.reproject(scene.points, PINHOLE, scene.pose, scene.work)
    scene.points += scene.work.residual / scene.work.root
    scene.points[0, 3] += 5.0
    energy.weigh(scene.points, PINHOLE, scene.pose, np.ones(68), 5.0, 0.0, scene.work)
    shares = scene.work.root**2
    assert shares[3] == pytest.approx(0.25)
    np.testing.assert_allclose(np.delete(shares, 3), 1.0)


@needs_compiled_kernels
def test_joint_solution_is_a_minimum_in_the_box(rng):
    scene = Scene(rng)
    terms = joint_terms(JointSettings())
    pose, coefficients = scene.pose.copy(), np.zeros(46)
    last, weights = np.zeros(46), np.full(68, 1.0)
    energy.fit_jointly(
        scene.tables, scene.points, PINHOLE, weights, terms, last, 60, scene.work, pose,
        coefficients,
    )  # fmt: skip

    def cost(row):
        turned = np.vstack([matrix_from_rotation_vector(row[:3]) @ pose[:3], pose[3] + row[3:6]])
        scene.express(row[6:])
        data = energy.weigh(scene.points, PINHOLE, turned, weights, terms.robust, 0.0, scene.work)
        w, square = row[6:], (row[6:] - last) ** 2
        memory = terms.memory * square / (1 + square / terms.escape**2)
        return 0.5 * (data + np.sum(terms.precision * w**2 + memory) + 2 * terms.slope @ w)

    slope = slope_of(cost, np.concatenate([np.zeros(6), coefficients]))
    jaw, close = terms.jaw_open, terms.mouth_close
    scale = 0.02 * np.sqrt(np.diag(scene.work.hessian)[6:])
    for b in range(46):
        if b in (jaw, close):
            continue
        if coefficients[b] > 0:
            assert slope[6 + b] <= scale[b]
        if coefficients[b] < 1:
            assert slope[6 + b] >= -scale[b]
    assert coefficients[close] <= coefficients[jaw]
    assert np.abs(slope[3:6]).max() < 0.05


def test_pinhole_of_the_tests_is_that_of_the_camera():
    np.testing.assert_allclose(PINHOLE, [CAMERA.focal_px, *CAMERA.center_px])
