"""Pictures of the virtual performer against its truth; they need an offscreen OpenGL context."""

import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

import cv2
import numpy as np
import pytest

from app.performer.opening import Scenario, open_performer, setup_pictures
from app.performer.performer import VirtualPerformer
from app.performer.stage import Stage
from app.render.eyeball import eyeball
from app.render.renderer import Item, Renderer, Scene
from app.render.scene import Material, Mesh, View, placed
from app.resources import asset
from core.alignment import FaceAligner
from core.camera import project
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.setup_plan import SHOTS

if TYPE_CHECKING:
    from app.capture.source import FrameSource

pytestmark = pytest.mark.gl


@pytest.fixture(scope="module")
def performer() -> Iterator[VirtualPerformer]:
    with open_performer(Scenario(take="head_turns")) as source:
        yield source


def test_the_renderer_and_the_camera_agree_to_a_tenth_of_a_pixel(performer):
    renderer = Renderer()
    directions, uv, triangles = eyeball()
    ball = Mesh(4.0 * directions, directions, uv, np.ones((len(uv), 4), np.float32), triangles)
    white = Material(
        "plain",
        np.full((1, 1, 3), 255, np.uint8),
        {"gloss": 0.0, "roughness2": 1.0, "lit": 9.0},
        two_sided=True,
    )
    drawable = renderer.upload(ball, white)
    camera, off = performer.camera, []
    for point in performer.truth(100).points_mm[::9]:
        place = placed(np.eye(3), point)
        scene = Scene(
            View(camera, supersampling=2),
            performer._setting.lights,
            [Item(drawable, place, place)],
        )
        alpha = renderer.draw(scene)[..., 3].astype(float)
        rows, columns = np.mgrid[: alpha.shape[0], : alpha.shape[1]]
        seen = np.array([np.sum(columns * alpha), np.sum(rows * alpha)]) / alpha.sum()
        off.append(seen - project(camera, point))
    renderer.release()
    assert np.abs(off).max() < 0.1
    assert np.linalg.norm(np.mean(off, axis=0)) < 0.04


def test_the_skin_lies_at_the_true_landmarks(performer):
    """The depth of the picture at each projected landmark is that landmark's own depth."""
    stage = Stage(performer._setting)
    try:
        for index in (0, 105, 300):
            truth, pixels = performer.truth(index), performer.landmarks_px(index)
            posture = performer._script.posture(performer._time_s(index))
            depth = stage.depth_mm(truth.expression, truth.gaze_rad, posture)
            x, y = np.float32(pixels[:75]).T
            seen = cv2.remap(depth, x, y, cv2.INTER_LINEAR)[:, 0]
            off = truth.points_mm[:75, 2] - seen
            # A hidden landmark lies behind what is seen; one on an edge mixes two surfaces.
            visible = np.abs(off) < 6
            assert visible.mean() > 0.6
            assert np.median(np.abs(off[visible])) < 0.6
    finally:
        stage.release()


def test_the_generic_aligner_finds_the_face_and_its_landmarks(performer):
    aligner = FaceAligner(asset("aligner"))
    errors = []
    for index in range(0, performer.n_frames, 40):
        angles = head_angles_from_matrix(
            matrix_from_quaternion(performer.truth(index).rotation_wxyz)
        )
        found = aligner.first(performer.picture(index).rgb)
        assert found is not None, f"no face at yaw {np.rad2deg(angles[0]):.0f} degrees"
        if abs(angles[0]) < np.deg2rad(30):
            off = found.landmarks.points_px[:60] - performer.landmarks_px(index)[:60]
            errors.append(np.linalg.norm(off, axis=1).mean())
    assert np.mean(errors) < 4


def test_it_is_a_source_of_frames():
    with open_performer(Scenario(take="still", person="tomas")) as source:
        plain: FrameSource = source
        frames = [plain.read() for _ in range(3)]
        assert plain.size_px == (640, 480)
        assert plain.fps == 30
        assert not plain.live
        assert [f.index for f in frames if f] == [0, 1, 2]
        assert [f.time_s for f in frames if f] == pytest.approx([0, 1 / 30, 2 / 30])
        assert frames[0] is not None
        assert frames[0].rgb.shape == (480, 640, 3)
        assert frames[0].gray.shape == (480, 640)
    assert source.read() is None
    source.close()


def test_the_same_scenario_gives_the_same_pictures_in_any_order(performer):
    late = performer.picture(2)
    with open_performer(Scenario(take="head_turns")) as again:
        played = [again.read() for _ in range(3)]
    assert played[2] is not None
    np.testing.assert_array_equal(played[2].rgb, late.rgb)


def test_fast_motion_is_blurred():
    with open_performer(Scenario(take="fast_motion")) as source:
        speed = [
            np.abs(source.landmarks_px(i + 1) - source.landmarks_px(i)).max() for i in range(100)
        ]
        fast, still = int(np.argmax(speed)), 0
        sharpness = []
        for index in (fast, still):
            x, y = source.landmarks_px(index)[:60].mean(axis=0).astype(int)
            face = source.picture(index).gray[y - 70 : y + 70, x - 60 : x + 60]
            sharpness.append(cv2.Sobel(face, cv2.CV_32F, 1, 0).std())
    assert speed[fast] > 8
    assert sharpness[0] < 0.9 * sharpness[1]


def test_a_live_performer_keeps_to_the_clock():
    with open_performer(Scenario(take="still"), live=True) as source:
        frames, times = [], []
        for _ in range(8):
            frames.append(source.read())
            times.append(time.monotonic())
    indices = [f.index for f in frames if f]
    assert indices == sorted(set(indices))
    # The first pictures are slow to draw; an index is chosen before its picture is drawn.
    shown, elapsed = indices[-1] - indices[2], times[-1] - times[2]
    longest = max(np.diff(times))
    assert shown == pytest.approx(elapsed * 30, abs=longest * 30 + 1.5)


def test_a_take_ends_or_loops():
    with open_performer(Scenario(take="still"), loop=True) as source:
        n = source.n_frames
        np.testing.assert_allclose(
            source.truth(n + 5).points_mm, source.truth(5).points_mm, atol=1e-9
        )
        source._index = n
        assert source.read() is not None
    with open_performer(Scenario(take="still")) as source:
        source._index = source.n_frames
        assert source.read() is None


@pytest.mark.parametrize("focal_px", [520.0, 760.0])
def test_the_focal_length_is_that_of_the_pictures(focal_px):
    aligner = FaceAligner(asset("aligner"))
    with open_performer(Scenario(take="still", focal_px=focal_px)) as source:
        found = aligner.first(source.picture(0).rgb)
        points = source.truth(0).points_mm[:60]
    assert found is not None
    seen = found.landmarks.points_px[:60] - source.camera.center_px
    slopes = points[:, :2] / points[:, 2:]
    estimate = np.sum((seen - seen.mean(0)) * (slopes - slopes.mean(0))) / np.sum(
        (slopes - slopes.mean(0)) ** 2
    )
    assert estimate == pytest.approx(focal_px, rel=0.06)


@pytest.mark.slow
def test_the_setup_pictures_show_the_prompted_shots():
    pictures = setup_pictures()
    assert [name for name, _, _ in pictures] == [shot.name for shot in SHOTS]
    for (_, frame, truth), shot in zip(pictures, SHOTS, strict=True):
        yaw = head_angles_from_matrix(matrix_from_quaternion(truth.rotation_wxyz))[0]
        assert abs(np.rad2deg(yaw - shot.yaw)) < 12
        assert frame.rgb.std() > 20
