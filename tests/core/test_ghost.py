"""Facts about the ghost of a head that is held as asked."""

from dataclasses import replace

import numpy as np
import pytest

from core.camera import camera_for
from core.geometry import (
    matrix_from_head_angles,
    quaternion_from_matrix,
    rotation_facing_camera,
)
from core.ghost import NECK_MM, GhostHead, outline
from core.live import resting_state
from core.setup_plan import SHOTS
from tests.core.held_out_person import face_model

BY_NAME = {shot.name: shot for shot in SHOTS}
CAMERA = camera_for((640, 480), 620.0)
SEAT = np.array([0.0, 0.0, 600.0])


@pytest.fixture(scope="module")
def head():
    return GhostHead(face_model())


def ghost(head, name, seat=SEAT, now=None):
    facing = quaternion_from_matrix(rotation_facing_camera(seat))
    mean = face_model().mean_mm.astype(float)
    now = facing if now is None else now
    state = replace(resting_state("free"), rotation_wxyz=now, translation_mm=seat)
    return head.ghost(BY_NAME[name], mean, facing, state, CAMERA)


def test_the_outline_of_a_circle_is_that_circle():
    angles = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    circle = 50 * np.column_stack([np.cos(angles), np.sin(angles)]) + [300, 200]
    found = np.linalg.norm(outline(circle) - [300, 200], axis=1)
    assert found == pytest.approx(50, rel=0.01)


def test_a_frontal_head_is_symmetric_and_as_large_as_a_head(head):
    lines = ghost(head, "pose_yaw+0").outline_px
    low, high = lines.min(axis=0), lines.max(axis=0)
    assert low[0] + high[0] == pytest.approx(639, abs=2)
    # A head is about 15 cm wide over the ears, which are 70 cm away, and 22 cm high.
    assert 125 < high[0] - low[0] < 165
    assert 185 < high[1] - low[1] < 245


def test_the_ghost_has_no_neck(head):
    chin = face_model().mean_mm[face_model().landmark_vertices].max(axis=0)[1]
    lines = ghost(head, "pose_yaw+0").outline_px
    assert lines[:, 1].max() < 620 * (chin + 40) / 600 + 240


def test_features_move_to_where_the_face_looks(head):
    straight = np.concatenate(ghost(head, "pose_yaw+0").curves_px).mean(axis=0)
    left = np.concatenate(ghost(head, "pose_yaw+30").curves_px).mean(axis=0)
    right = np.concatenate(ghost(head, "pose_yaw-30").curves_px).mean(axis=0)
    up = np.concatenate(ghost(head, "pose_pitch+15").curves_px).mean(axis=0)
    # The picture is not mirrored: the subject's left is on its right.
    assert left[0] > straight[0] + 20 and right[0] < straight[0] - 20
    assert up[1] < straight[1] - 10


def test_a_profile_shows_its_nose_and_only_the_near_side(head):
    front, side = ghost(head, "pose_yaw+0"), ghost(head, "pose_yaw+90")
    assert len(side.curves_px) < len(front.curves_px)
    assert np.ptp(side.outline_px[:, 0]) > 1.1 * np.ptp(front.outline_px[:, 0])


def test_the_ghost_is_where_the_user_sits_and_faces_the_camera_from_there(head):
    aside = ghost(head, "pose_yaw+0", np.array([150.0, 0.0, 600.0]))
    lines, features = aside.outline_px, np.concatenate(aside.curves_px)
    middle = 0.5 * (lines[:, 0].min() + lines[:, 0].max())
    assert middle == pytest.approx(319.5 + 620 * 150 / 600, abs=25)
    assert abs(features[:, 0].mean() - middle) < 25


def test_the_ghost_stays_while_the_head_turns_into_it(head):
    """A head that turns on its neck sees the ghost in the same place until it is there."""
    start = ghost(head, "pose_yaw+60").outline_px
    for degrees in (20, 40, 60):
        turned = matrix_from_head_angles(np.deg2rad(degrees), 0, 0)
        seat = SEAT + (np.eye(3) - turned) @ NECK_MM
        facing = np.array([1.0, 0, 0, 0])
        state = replace(resting_state("free"), rotation_wxyz=quaternion_from_matrix(turned),
                        translation_mm=seat)  # fmt: skip
        mean = face_model().mean_mm.astype(float)
        lines = head.ghost(BY_NAME["pose_yaw+60"], mean, facing, state, CAMERA).outline_px
        assert np.abs(lines - start).max() < 0.5
