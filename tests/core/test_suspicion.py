"""Facts about which pictures deserve a look."""

import numpy as np
import pytest

from core.landmark_edit import as_hidden
from core.landmarks import GROUPS
from core.records import Landmarks2D
from core.suspicion import suspicion


@pytest.fixture
def face(rng):
    points = rng.uniform(0, 200, (75, 2))
    points[0], points[1] = (0, 0), (200, 200)
    return Landmarks2D(points, np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2))


def away(face, indices, distance_px):
    model = face.points_px.copy()
    model[list(indices), 0] += distance_px
    return model


def test_landmarks_on_the_model_are_good(face):
    assert suspicion(face, face.points_px).level == "good"


@pytest.mark.parametrize(("distance_px", "level"), [(2.0, "good"), (4.5, "look"), (9.0, "bad")])
def test_the_feature_that_is_furthest_off_is_named(face, distance_px, level):
    found = suspicion(face, away(face, GROUPS["eye_left"], distance_px))
    assert found.level == level
    assert level == "good" or found.note.startswith("left eye")


def test_what_is_further_off_comes_first(face):
    near, far = (suspicion(face, away(face, GROUPS["nose"], d)).score for d in (4.0, 5.0))
    assert far > near


def test_hidden_points_do_not_count(face):
    gone = as_hidden(face, GROUPS["eye_left"])
    assert suspicion(gone, away(face, GROUPS["eye_left"], 50.0)).level == "good"


def test_a_picture_without_a_face_comes_before_all_others(face):
    blind = Landmarks2D(
        face.points_px, face.edited, np.zeros(75), face.pupils_px, face.pupil_confidence
    )
    assert suspicion(blind, face.points_px).score > suspicion(face, face.points_px + 100).score
    assert "no face" in suspicion(blind, face.points_px).note


def test_hardly_seen_landmarks_are_suspicious_until_the_user_has_placed_some(face):
    dim = Landmarks2D(
        face.points_px, face.edited, np.full(75, 0.3), face.pupils_px, face.pupil_confidence
    )
    assert suspicion(dim, face.points_px).level == "look"
    placed = dim.moved(3, *face.points_px[3])
    assert suspicion(placed, face.points_px).level == "good"
