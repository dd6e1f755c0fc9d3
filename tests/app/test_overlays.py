"""What lies over the pictures, and that each frame waits for its avatar picture."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import Qt

from app.controllers.desk import open_desk
from app.controllers.face_mesh import FaceMesh, face_edges, vertex_normals
from app.controllers.matching import PATIENCE_FRAMES, DelayMatch
from app.controllers.overlays import AXIS_MM, appearance_points_mm, axes
from app.controllers.scene import AvatarScene
from app.resources import asset
from app.views.layers import Bars, Lines, Points, Trace
from app.views.picture_view import PictureView, blank_image
from core.appearance import AppearancePoints
from core.arkit import EXPRESSION_NAMES
from core.blendshapes import mean_user
from core.camera import camera_for, project
from core.face_model import load_face_model
from core.live import resting_state
from core.records import Frame
from tests.app.live_fakes import FakeToolbox

CAMERA_640 = camera_for((640, 480), 640.0)


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


@pytest.fixture
def window(qtbot):
    window, controller = open_desk(FakeToolbox(profiles=["anna"]))
    qtbot.addWidget(window)
    window.show()
    controller.start()
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    yield window
    window.close()


def kinds(pane):
    return {type(layer) for layer in pane.picture.layers}


@pytest.mark.parametrize(
    ("key", "letter", "kind"),
    [
        ("landmarks", Qt.Key.Key_L, Points),
        ("mesh", Qt.Key.Key_M, Lines),
        ("axes", Qt.Key.Key_X, Lines),
        ("trace", Qt.Key.Key_E, Trace),
    ],
)
def test_each_overlay_comes_and_goes_with_its_key(window, qtbot, key, letter, kind):
    window.deeds["landmarks"].setChecked(False)
    qtbot.waitUntil(lambda: kinds(window.source_pane) == set())
    qtbot.waitUntil(window.isActiveWindow)
    qtbot.keyClick(window, letter)
    assert window.deeds.on(key)
    qtbot.waitUntil(lambda: kinds(window.source_pane) == {kind})
    qtbot.keyClick(window, letter)
    qtbot.waitUntil(lambda: kinds(window.source_pane) == set())


def test_bars_of_what_the_avatar_does_lie_over_the_avatar(window, qtbot):
    window.deeds["bars"].trigger()
    qtbot.waitUntil(lambda: kinds(window.avatar_pane) == {Bars})
    assert len(window.avatar_pane.picture.layers[0].values) == 46
    assert kinds(window.source_pane) == {Points}


def test_a_hidden_webcam_picture_shows_what_is_tracked_but_not_the_user(window, qtbot):
    level = window.source_pane.grab().toImage().pixelColor(300, 10)
    window.deeds["blank"].trigger()

    def blanked():
        image = window.source_pane.picture.grab().toImage()
        return image.pixelColor(image.width() // 2, image.height() // 2).red() == 44

    assert level.red() != 44
    qtbot.waitUntil(blanked)
    assert kinds(window.source_pane) == {Points}


def test_the_mesh_lies_on_the_landmarks_and_only_on_skin_that_is_seen(model):
    user, state = mean_user(model), resting_state("free")
    ends = FaceMesh(model, user).lines_px(state, CAMERA_640).reshape(-1, 2)
    inner = project(CAMERA_640, user.neutral_mm[model.landmark_vertices] + state.translation_mm)
    away = np.linalg.norm(inner[:, None] - ends, axis=2).min(axis=1)
    assert np.median(away) < 2.0
    turned = replace(state, rotation_wxyz=[np.cos(0.7), 0, np.sin(0.7), 0])
    assert 100 < len(FaceMesh(model, user).lines_px(turned, CAMERA_640)) < 0.8 * len(ends) / 2


def test_the_mesh_follows_the_expression(model):
    mesh, state = FaceMesh(model, None), resting_state("free")
    jaw = np.zeros(46)
    jaw[EXPRESSION_NAMES.index("jawOpen")] = 1.0
    lowest = mesh.lines_px(state, CAMERA_640)[:, [1, 3]].max()
    assert mesh.lines_px(replace(state, expression=jaw), CAMERA_640)[:, [1, 3]].max() > lowest + 10


def test_normals_point_out_of_the_face(model):
    normals = vertex_normals(model.mean_mm, model.triangles)
    nose = model.mean_mm[:, 2].argmin()
    assert normals[nose, 2] < -0.5
    assert 500 < len(face_edges(model)) < 3000


def test_axes_begin_between_the_eyes_and_show_left_up_and_forwards():
    state = resting_state("free")
    left, up, ahead = (layer.ends_px[0] for layer in axes(state, CAMERA_640))
    centre = project(CAMERA_640, state.translation_mm[None])[0]
    for ends in (left, up, ahead):
        np.testing.assert_allclose(ends[:2], centre)
    length = 640 * AXIS_MM / state.translation_mm[2]
    np.testing.assert_allclose(left[2:] - centre, [length, 0], atol=1e-9)
    np.testing.assert_allclose(up[2:] - centre, [0, -length], atol=1e-9)
    turned = replace(state, rotation_wxyz=[np.cos(0.3), 0, np.sin(0.3), 0])
    assert abs(axes(turned, CAMERA_640)[2].ends_px[0, 2] - centre[0]) > 20
    behind = replace(state, translation_mm=[0, 0, 20.0])
    assert axes(behind, CAMERA_640) == []


def test_appearance_points_are_mixed_from_the_landmarks_that_carry_them():
    points = AppearancePoints(
        [[0, 1, 2], [3, 4, 76]], [[0.5, 0.25, 0.25], [1, 0, 0]], np.zeros((2, 3)),
        np.zeros((1, 1)), np.zeros(2),
    )  # fmt: skip
    regressor = SimpleNamespace(points=lambda stage: points)
    shape = np.arange(225.0).reshape(75, 3)
    expected = 0.5 * shape[0] + 0.25 * shape[1] + 0.25 * shape[2]
    np.testing.assert_allclose(appearance_points_mm(regressor, shape), [expected])


@pytest.mark.parametrize(
    "layer",
    [
        Points(np.full((75, 2), 20.0)),
        Lines(np.array([[5.0, 5.0, 60.0, 40.0]])),
        Bars(np.linspace(0, 1, 46), [f"name{n}" for n in range(46)]),
        Trace(np.linspace(1, 0, 9), np.full(9, 0.9), np.full(9, 0.2), 2.0),
    ],
)
def test_every_layer_leaves_its_mark_on_the_picture(qtbot, layer):
    view = PictureView("Picture")
    qtbot.addWidget(view)
    view.resize(640, 480)
    view.show_image(blank_image(64, 48))
    empty = view.grab().toImage()
    view.show_image(blank_image(64, 48), [layer])
    assert view.grab().toImage() != empty


def frames(n):
    picture = np.zeros((2, 2, 3), np.uint8)
    return [Frame(picture, picture[..., 0].copy(), k / 30, k) for k in range(n)]


def test_a_frame_is_shown_when_its_avatar_picture_comes_and_not_before():
    match, all_frames = DelayMatch(), frames(4)
    assert match.on_solved(all_frames[0])
    assert not match.on_painted(all_frames[0])
    assert not match.on_solved(all_frames[1])
    assert not match.on_solved(all_frames[2])
    assert match.on_painted(all_frames[1])
    assert match.on_painted(all_frames[2])
    assert not match.on_painted(all_frames[1])


def test_frames_do_not_wait_for_an_avatar_that_hangs_and_never_go_back():
    match, all_frames = DelayMatch(), frames(PATIENCE_FRAMES + 9)
    match.on_solved(all_frames[0])
    match.on_painted(all_frames[0])
    shown = [frame.index for frame in all_frames[1:] if match.on_solved(frame)]
    assert shown == list(range(PATIENCE_FRAMES + 1, PATIENCE_FRAMES + 9))
    assert not match.on_painted(all_frames[3])
    match.waits = False
    assert not match.on_painted(all_frames[-1])


def test_the_picture_beside_the_avatar_is_the_one_its_pose_was_solved_from(window, qtbot):
    pairs = []

    def on_painted(painted):
        if painted.wish.frame is not None:
            shown = window.source_pane.picture.layers[0].points_px[0, 0]
            pairs.append((painted.wish.solved.landmarks_px[0, 0], shown))

    # After the one that shows the picture, since it was connected later.
    scene = window.findChild(AvatarScene)
    scene.painted.connect(on_painted)
    qtbot.waitUntil(lambda: len(pairs) > 30)
    assert all(solved == shown for solved, shown in pairs)
    assert len({solved for solved, _ in pairs}) > 20


def test_an_avatar_that_nobody_sees_is_not_drawn_and_frames_do_not_wait_for_it(qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    window, controller = open_desk(toolbox)
    qtbot.addWidget(window)
    window.show()
    controller.start()
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    window.deeds["avatar"].trigger()
    qtbot.wait(50)
    drawn, results = len(toolbox.wishes), []
    controller.solved.connect(results.append)
    qtbot.waitUntil(lambda: len(results) > 10)
    shown = window.source_pane.picture.layers[0].points_px[0, 0]
    assert len(toolbox.wishes) == drawn
    assert shown >= results[-3].state.landmarks_px[0, 0]
    window.deeds["alone"].trigger()
    qtbot.waitUntil(lambda: len(toolbox.wishes) > drawn + 5)
    window.deeds["alone"].trigger()
    window.deeds["avatar"].trigger()
    drawn = len(toolbox.wishes)
    qtbot.waitUntil(lambda: len(toolbox.wishes) > drawn + 5)
    window.close()
