"""The face of one's own from the first frames: truth recovered, bounded, reset."""

import numpy as np
import pytest

from app.resources import asset
from core.camera import camera_for, project
from core.face_model import load_face_model
from core.fit_problem import State, posed
from core.fit_space import face_at, fit_space
from core.geometry import matrix_from_head_angles, procrustes, quaternion_from_matrix
from core.landmarks import NAMES
from core.model_fit import choose_picks
from core.quick_identity import QuickIdentity, QuickSettings
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


def performance(face, rng, n_frames=N_FRAMES, focal_px=FOCAL_PX, smiling=0):
    """Tracked frames of a person who turns the head and smiles now and then, or first for long."""
    times = np.arange(n_frames) / 30
    angles = np.stack([0.5 * np.sin(2 * times), 0.2 * np.sin(1.3 * times), 0 * times], axis=1)
    rotations = np.stack([matrix_from_head_angles(*one) for one in angles])
    places = np.tile([0.0, 0.0, 600.0], (n_frames, 1))
    expressions = np.zeros((n_frames, 46))
    expressions[:, 28:30] = np.clip(np.sin(3 * times), 0, 0.8)[:, None]
    expressions[:smiling, 28:30] = 0.7
    state = State(rotations, places, expressions)
    picks = choose_picks(face, state)
    points = np.take_along_axis(posed(face.points_mm(expressions), state), picks[..., None], axis=1)
    points_px = project(camera_for(SIZE_PX, focal_px), points)
    points_px += 0.3 * rng.normal(size=points_px.shape)
    blank = np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.zeros(2)
    return state, [Landmarks2D(one, *blank) for one in points_px]


def play(quick, state, landmarks, first=0):
    """Offer a performance frame by frame; return the faces that came back."""
    found = []
    for n, one in enumerate(landmarks, first):
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


def test_settles_when_nothing_changes_any_more(model, person):
    state, landmarks = performance(person, np.random.default_rng(0), 200)
    settings = QuickSettings(first_calls=10, settled_calls=20, most_calls=30)
    found = play(
        QuickIdentity(model, camera_for(SIZE_PX, FOCAL_PX), True, settings), state, landmarks
    )
    assert not found[0].settled
    assert found[-1].settled


def test_without_frames_there_is_no_face(model):
    settings = QuickSettings(first_calls=1, settled_calls=2, most_calls=3)
    quick = QuickIdentity(model, camera_for(SIZE_PX, FOCAL_PX), True, settings)
    assert [quick.advance() for _ in range(20)] == [None] * 20


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


def test_a_smile_worn_at_first_does_not_stay_in_the_face(model, person):
    """Two seconds of a smile without a break, then a resting face."""
    state, landmarks = performance(person, np.random.default_rng(0), smiling=60)
    quick = QuickIdentity(model, camera_for(SIZE_PX, FOCAL_PX), True)
    early = play(quick, state, landmarks[:60], first=0)[-1]
    late = play(quick, state, landmarks[60:], first=60)[-1]
    corners = [NAMES.index("R_mouth_corner"), NAMES.index("L_mouth_corner")]
    smile_mm = np.linalg.norm(person.deltas_mm[28:30].sum(axis=0)[corners], axis=1).mean()

    def lifted_mm(face):
        return np.linalg.norm((face.neutral_mm - person.neutral_mm)[corners], axis=1).mean()

    assert lifted_mm(early.face) < 0.35 * smile_mm
    assert lifted_mm(late.face) < 0.2 * smile_mm


def test_somebody_else_is_noticed_and_fitted(model, person):
    """The second person's frames are tracked with the first one's face, as they would be."""
    other = fit_space(model).face(
        np.random.default_rng(8).normal(size=model.n_identities), np.zeros((60, 3))
    )
    quick = QuickIdentity(model, camera_for(SIZE_PX, FOCAL_PX), True)
    play(quick, *performance(person, np.random.default_rng(0), 240))
    last = play(quick, *performance(other, np.random.default_rng(1), 240))[-1]
    assert distance_mm(last.face, other) < 0.5 * distance_mm(person, other)
