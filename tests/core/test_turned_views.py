"""Facts about pictures of heads turned further than in the setup."""

import numpy as np
import pytest

from core.camera import project
from core.geometry import register_rigid, rotation_vector_from_matrix
from core.kernels.turning import draw_moved
from core.turned_views import TurnSettings, turn_of, turned_views
from tests.synthetic_face import make_face

PLACE = (12.0, -8.0, 580.0)
EXPRESSION = (0.4, 0.2)


@pytest.fixture(scope="module")
def face():
    return make_face(np.random.default_rng(1))


def views(face, yaws_deg, settings=None):
    shapes = np.array([face.shape((np.deg2rad(y), 0, 0), EXPRESSION, PLACE) for y in yaws_deg])
    pictures = [face.picture(shape) for shape in shapes]
    made = turned_views(pictures, face.camera, shapes, face.triangles, settings or TurnSettings())
    return shapes, pictures, made


@pytest.mark.parametrize("yaw_deg", [-40.0, -10.0, 25.0])
def test_the_turn_of_a_head_in_the_middle_is_its_yaw(face, yaw_deg):
    shape = face.shape((np.deg2rad(yaw_deg), 0, 0), EXPRESSION, (0, 0, 600.0))
    axis, angle = turn_of(shape)
    assert angle == pytest.approx(abs(yaw_deg), abs=3.0)
    assert abs(axis[1]) > 0.95


def test_a_head_is_turned_on_about_its_centre_by_the_angles_asked_for(face):
    shapes, _, made = views(face, [30.0], TurnSettings((12.0, 24.0)))
    assert made.origin.tolist() == [0, 0]
    for turned, wanted_deg in zip(made.points_mm, (12.0, 24.0), strict=True):
        assert np.allclose(turned.mean(axis=0), shapes[0].mean(axis=0))
        rotation, _ = register_rigid(
            shapes[0] - shapes[0].mean(axis=0), turned - turned.mean(axis=0)
        )
        found_deg = np.rad2deg(np.linalg.norm(rotation_vector_from_matrix(rotation)))
        assert found_deg == pytest.approx(wanted_deg, abs=0.01)
        assert turn_of(turned)[1] == pytest.approx(turn_of(shapes[0])[1] + wanted_deg, abs=0.1)


def test_frontal_heads_are_left_alone_and_none_is_turned_too_far(face):
    _, _, made = views(face, [0.0, -30.0, 50.0, 10.0], TurnSettings((12.0, 24.0), 20.0, 65.0))
    assert made.origin.tolist() == [1, 1, 2]
    assert max(turn_of(turned)[1] for turned in made.points_mm) <= 65.0
    assert len(views(face, [30.0], TurnSettings(further_deg=()))[2].images) == 0


def test_the_picture_shows_the_face_as_a_camera_would(face):
    """The true picture of the turned shape is known: compare inside the face."""
    _, pictures, made = views(face, [30.0])
    true = face.picture(made.points_mm[0]).astype(float)
    inside = np.zeros(true.shape, bool)
    x, y = np.rint(project(face.camera, made.points_mm[0])).astype(int).T
    inside[y, x] = True
    error = np.abs(made.images[0] - true)[inside].mean()
    assert error < 0.3 * np.abs(pictures[0] - true)[inside].mean()


def test_what_is_nearer_hides_what_is_further_away():
    picture = np.repeat(np.array([[10, 10, 10, 10, 200, 200, 200, 200]], np.uint8), 8, axis=0)
    left, right = [[0, 0], [3, 0], [0, 7]], [[4, 0], [7, 0], [4, 7]]
    source = np.array([*left, *right], np.float32)
    target = np.array([*right, *right], np.float32)
    triangles = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    for depths, seen in (((1, 2), 10), ((2, 1), 200)):
        depth, out = np.repeat(depths, 3).astype(np.float32), picture.copy()
        nearest = np.full(picture.shape, np.inf, np.float32)
        draw_moved(picture, source, target, depth, triangles, nearest, out)
        assert out[0, 5] == seen
        assert out[7, 7] == 200
        assert np.all(out[:, :4] == 10)


def test_triangles_that_stay_leave_the_picture_as_it_is(face):
    _, pictures, _ = views(face, [30.0])
    corners = np.array([[5.0, 5.0], [200.0, 20.0], [60.0, 150.0], [-50.0, 90.0]], np.float32)
    triangles = np.array([[0, 1, 2], [0, 3, 2], [1, 1, 2]], np.int32)
    out, nearest = pictures[0].copy(), np.full(pictures[0].shape, np.inf, np.float32)
    draw_moved(pictures[0], corners, corners, np.ones(4, np.float32), triangles, nearest, out)
    assert np.abs(out.astype(int) - pictures[0]).max() <= 1
