"""Facts about a user's own blendshapes."""

from dataclasses import replace

import numpy as np
import pytest

from core.blendshapes import REACH_MM, spread_offsets, user_blendshapes, usual_rotation
from core.face_model import deltas_mm, load_face_model, neutral_mm
from core.fit_space import face_at, fit_space
from core.geometry import (
    matrix_from_head_angles,
    matrix_from_quaternion,
    quaternion_from_matrix,
    rotation_facing_camera,
)
from core.landmarks import N_INTERNAL
from tests.core.painted_user import fit_of
from tests.core.tracked_faces import ASSETS


@pytest.fixture(scope="module")
def model():
    return load_face_model(ASSETS / "face_model.npz")


def fitted(model, seed, offsets_mm):
    return fit_of(np.random.default_rng(seed).normal(size=model.n_identities), offsets_mm)


def test_landmarks_are_exactly_where_the_fit_has_them(model, rng):
    fit = fitted(model, 2, rng.normal(0, 1.5, (N_INTERNAL, 3)))
    user = user_blendshapes(model, fit)
    face = fit_space(model).face(fit.identity, fit.offsets_mm)
    vertices = model.landmark_vertices
    found = user.neutral_mm[vertices] + user.landmark_offsets_mm
    assert np.allclose(found, face.neutral_mm[:N_INTERNAL], atol=1e-9)
    # What later fits read is the same.
    assert np.allclose(face_at(model, user).neutral_mm[:N_INTERNAL], found, atol=1e-12)


def test_without_offsets_the_face_is_the_models(model):
    fit = fitted(model, 3, np.zeros((N_INTERNAL, 3)))
    user = user_blendshapes(model, fit)
    assert np.allclose(user.neutral_mm, neutral_mm(model, fit.identity), atol=1e-12)
    assert np.array_equal(user.deltas_mm, deltas_mm(model, fit.identity).astype(np.float32))
    assert not user.landmark_offsets_mm.any()
    assert np.array_equal(user.identity, fit.identity)


def test_offsets_move_the_neutral_face_only(model, rng):
    offsets = rng.normal(0, 1.0, (N_INTERNAL, 3))
    plain = user_blendshapes(model, fitted(model, 4, np.zeros((N_INTERNAL, 3))))
    moved = user_blendshapes(model, fitted(model, 4, offsets))
    assert np.array_equal(plain.deltas_mm, moved.deltas_mm)
    assert np.abs(plain.neutral_mm - moved.neutral_mm).max() > 0.1


def test_landmarks_that_agree_carry_the_surface_along(model):
    shift = np.array([2.0, -1.0, 0.5])
    neutral = neutral_mm(model, np.zeros(model.n_identities))
    smooth = spread_offsets(neutral, model.landmark_vertices, np.tile(shift, (N_INTERNAL, 1)))
    carried = smooth[model.landmark_vertices] @ shift / (shift @ shift)
    assert carried.min() > 0.5 and carried.max() < 1.05


def test_one_landmark_against_its_neighbours_hardly_moves_the_surface(model):
    neutral = neutral_mm(model, np.zeros(model.n_identities))
    offsets = np.zeros((N_INTERNAL, 3))
    offsets[N_INTERNAL - 1] = 3.0
    smooth = spread_offsets(neutral, model.landmark_vertices, offsets)
    assert np.abs(smooth).max() < 0.5 * 3.0


def test_skin_far_from_all_landmarks_stays(model):
    neutral = neutral_mm(model, np.zeros(model.n_identities))
    smooth = spread_offsets(neutral, model.landmark_vertices, np.full((N_INTERNAL, 3), 2.0))
    away = np.linalg.norm(neutral[:, None] - neutral[model.landmark_vertices], axis=2).min(axis=1)
    assert np.any(away > 4 * REACH_MM)
    assert np.abs(smooth[away > 4 * REACH_MM]).max() < 0.01


def test_the_displacement_is_the_textbook_gaussian_process():
    # One landmark, one vertex at a distance of one reach: k / (1 + 1).
    points = np.array([[0.0, 0, 0], [REACH_MM, 0, 0]])
    smooth = spread_offsets(points, np.array([0]), np.array([[0.0, 2.0, 0.0]]))
    assert smooth[0, 1] == pytest.approx(1.0)
    assert smooth[1, 1] == pytest.approx(np.exp(-0.5))


def test_a_few_turned_heads_do_not_change_how_the_head_is_usually_held():
    usual = (0.05, -0.1, 0.02)
    fit = fit_of(np.zeros(3), angles=[usual] * 5 + [(0.8, 0.1, 0.0), (0.0, 0.5, 0.3)])
    found = matrix_from_quaternion(usual_rotation(fit))
    assert np.allclose(found, matrix_from_head_angles(*usual), atol=0.01)


def test_how_the_head_is_held_does_not_depend_on_where_it_is():
    usual, place = matrix_from_head_angles(0.1, -0.05, 0.0), np.array([200.0, -50.0, 500.0])
    facing = rotation_facing_camera(place)
    assert np.allclose(facing @ [0, 0, -1], -place / np.linalg.norm(place))
    fit = replace(
        fit_of(np.zeros(3)), rotations_wxyz=[quaternion_from_matrix(facing @ usual)],
        translations_mm=[place],
    )  # fmt: skip
    assert np.allclose(matrix_from_quaternion(usual_rotation(fit)), usual)
