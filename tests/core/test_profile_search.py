"""Facts about finding a head of known turn by its skin."""

import numpy as np
import pytest

from core.camera import camera_for
from core.profile_search import moved_to_skin
from tests.core.held_out_person import face_model, person
from tests.core.painted_head import head_picture, head_state

CAMERA = camera_for((320, 240), 310.0)


def state(yaw, place_mm, in_plane=0.0):
    return head_state((yaw, 0.0, 0.0, in_plane), place_mm)


def picture(one):
    return head_picture(face_model(), person(0), CAMERA, one)


@pytest.mark.parametrize("place", [(0, 0, 600), (55, 12, 600), (-45, -14, 600)])
def test_a_head_is_found_where_its_skin_is(place):
    anchor = state(1.0, (0, 0, 600))
    true, expected = state(1.5, place), state(1.5, (0, 0, 600))
    found = moved_to_skin(
        face_model(), person(0), CAMERA, expected, picture(true), (anchor, picture(anchor))
    )
    np.testing.assert_allclose(found.translations_mm[0], place, atol=4.0)
    np.testing.assert_allclose(found.rotations[0], true.rotations[0], atol=0.08)


def test_a_turn_in_the_picture_is_found_too():
    anchor = state(1.0, (0, 0, 600))
    true, expected = state(1.5, (30, 0, 600), np.deg2rad(8)), state(1.5, (0, 0, 600))
    found = moved_to_skin(
        face_model(), person(0), CAMERA, expected, picture(true), (anchor, picture(anchor))
    )
    before = np.linalg.norm(true.rotations[0] - expected.rotations[0])
    assert np.linalg.norm(true.rotations[0] - found.rotations[0]) < 0.6 * before


def test_an_empty_picture_moves_nothing():
    anchor, expected = state(1.0, (0, 0, 600)), state(1.5, (5, 0, 600))
    blank = np.full((240, 320), 77, np.uint8)
    known = (anchor, picture(anchor))
    found = moved_to_skin(face_model(), person(0), CAMERA, expected, blank, known)
    np.testing.assert_allclose(found.translations_mm, expected.translations_mm, atol=2.0)
    np.testing.assert_allclose(found.rotations, expected.rotations, atol=1e-9)
