"""The face of one's own from the first frames: truth recovered, bounded, reset."""

import numpy as np
import pytest

from app.resources import asset
from core.camera import camera_for, project
from core.face_model import load_face_model
from core.fit_problem import State, posed
from core.fit_space import face_at, fit_space
from core.geometry import matrix_from_head_angles, procrustes, quaternion_from_matrix
from core.model_fit import choose_picks
from core.quick_identity import QuickIdentity
from core.records import Landmarks2D

SIZE_PX, FOCAL_PX = (640, 480), 600.0
N_FRAMES = 150


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


@pytest.fixture(scope="module")
def person(model):
    """A face of the model that is not the mean one."""
    identity = np.random.default_rng(3).normal(size=model.n_identities) * 0.8
    return fit_space(model).face(identity, np.zeros((60, 3)))


def performance(face, rng, n_frames=N_FRAMES, focal_px=FOCAL_PX):
    """Tracked frames of a person who turns the head and smiles now and then."""
    times = np.arange(n_frames) / 30
    angles = np.stack([0.5 * np.sin(2 * times), 0.2 * np.sin(1.3 * times), 0 * times], axis=1)
    rotations = np.stack([matrix_from_head_angles(*one) for one in angles])
    places = np.tile([0.0, 0.0, 600.0], (n_frames, 1))
    expressions = np.zeros((n_frames, 46))
    expressions[:, 28:30] = np.clip(np.sin(3 * times), 0, 0.8)[:, None]
    state = State(rotations, places, expressions)
    picks = choose_picks(face, state)
    points = np.take_along_axis(posed(face.points_mm(expressions), state), picks[..., None], axis=1)
    points_px = project(camera_for(SIZE_PX, focal_px), points)
    points_px += 0.3 * rng.normal(size=points_px.shape)
    blank = np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.zeros(2)
    return state, [Landmarks2D(one, *blank) for one in points_px]


def play(quick, state, landmarks):
    """Offer a performance frame by frame; return the faces that came back."""
    found = []
    for n, one in enumerate(landmarks):
        quick.offer(
            one, state.expressions[n], quaternion_from_matrix(state.rotations[n]),
            state.translations_mm[n], 0.9,
        )  # fmt: skip
        found.append(quick.advance())
    return [one for one in found if one is not None]


def distance_mm(face, truth):
    """Mean distance of the inner landmarks after a similarity."""
    a, b = face.neutral_mm[:60], truth.neutral_mm[:60]
    scale, rotation, shift = procrustes(a, b)
    return np.linalg.norm(scale * a @ rotation.T + shift - b, axis=1).mean()


@pytest.fixture(scope="module")
def found(model, person):
    state, landmarks = performance(person, np.random.default_rng(0))
    return play(QuickIdentity(model, camera_for(SIZE_PX, FOCAL_PX), True), state, landmarks)


def test_face_comes_nearer_to_the_truth(model, person, found):
    mean = fit_space(model).face(np.zeros(model.n_identities), np.zeros((60, 3)))
    assert distance_mm(found[-1].face, person) < 0.3 * distance_mm(mean, person)


def test_faces_come_at_most_once_a_second(found):
    assert 1 <= len(found) <= N_FRAMES / 30


def test_known_focal_length_is_kept(found):
    assert found[-1].camera.focal_px == pytest.approx(FOCAL_PX, rel=1e-4)


def test_face_agrees_with_its_blendshapes(model, found):
    face, again = found[-1].face, face_at(model, found[-1].user)
    assert np.abs(face.neutral_mm - again.neutral_mm).max() < 1e-3
    assert np.abs(face.deltas_mm - again.deltas_mm).max() < 1e-3
    assert found[-1].user is found[-1].user


def test_focal_length_is_found_from_turned_heads(model, person):
    state, landmarks = performance(person, np.random.default_rng(1), focal_px=FOCAL_PX)
    quick = QuickIdentity(model, camera_for(SIZE_PX, 690.0), False)
    last = play(quick, state, landmarks)[-1]
    assert abs(last.camera.focal_px - FOCAL_PX) < 60
    assert 0 < last.focal_spread < 0.15


def test_unsure_frames_are_not_looked_at(model, person):
    state, landmarks = performance(person, np.random.default_rng(0), 60)
    quick = QuickIdentity(model, camera_for(SIZE_PX, FOCAL_PX), True)
    for n, one in enumerate(landmarks):
        quick.offer(
            one, state.expressions[n], np.array([1.0, 0, 0, 0]), np.array([0, 0, 600.0]), 0.1
        )
        assert quick.advance() is None


def test_after_a_reset_the_same_frames_give_the_same_faces(model, person, found):
    state, landmarks = performance(person, np.random.default_rng(0))
    quick = QuickIdentity(model, camera_for(SIZE_PX, FOCAL_PX), True)
    play(quick, state, landmarks[:70])
    quick.reset()
    again = play(quick, state, landmarks)
    assert np.abs(again[-1].face.neutral_mm - found[-1].face.neutral_mm).max() < 0.05
