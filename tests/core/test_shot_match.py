"""Facts about following a prompt."""

import numpy as np
import pytest

from core.arkit import EXPRESSION_NAMES
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.setup_plan import SHOTS
from core.shot_match import follows_unseen, head_angles, is_visible, match

BY_NAME = {shot.name: shot for shot in SHOTS}
REST = np.zeros(len(EXPRESSION_NAMES))


def degrees(*angles):
    return np.deg2rad(angles)


def test_every_prompt_is_followed_by_doing_what_it_asks():
    for shot in SHOTS:
        assert match(shot, np.array([shot.yaw, shot.pitch, shot.roll]), shot.standard).good


def test_no_expression_prompt_is_followed_by_a_resting_face_unless_it_can_hardly_be_seen():
    for shot in SHOTS:
        found = match(shot, np.array([shot.yaw, shot.pitch, shot.roll]), REST)
        asks = shot.expression_name not in ("neutral", "cheek_blowing")
        assert found.expression != asks, shot.name
        assert is_visible(shot) == (shot.expression_name != "cheek_blowing")


def test_the_head_may_be_a_little_off_but_not_much():
    shot = BY_NAME["pose_yaw+30"]
    assert match(shot, degrees(24, 4, -4), REST).good
    wrong = match(shot, degrees(15, 0, 0), REST)
    assert not wrong.pose
    assert np.rad2deg(wrong.turn_rad) == pytest.approx([15, 0, 0])


def test_a_profile_counts_from_where_the_face_is_last_seen():
    shot = BY_NAME["pose_yaw-90"]
    assert match(shot, degrees(-50, 0, 0), REST).pose
    assert match(shot, degrees(-75, 0, 0), REST).pose
    assert not match(shot, degrees(-30, 0, 0), REST).pose
    assert not match(shot, degrees(60, 0, 0), REST).pose


def test_a_face_that_went_out_of_sight_follows_only_a_profile_on_its_side():
    assert follows_unseen(BY_NAME["pose_yaw-90"], degrees(-50, 0, 0))
    assert not follows_unseen(BY_NAME["pose_yaw-90"], degrees(50, 0, 0))
    assert not follows_unseen(BY_NAME["pose_yaw-30"], degrees(-50, 0, 0))


def test_a_neutral_prompt_is_not_followed_by_an_open_mouth():
    open_mouth = REST.copy()
    open_mouth[EXPRESSION_NAMES.index("jawOpen")] = 0.6
    assert not match(BY_NAME["pose_yaw+0"], degrees(0, 0, 0), open_mouth).expression


def test_angles_count_from_how_the_person_looks_straight_ahead():
    def quaternion(*angles):
        return quaternion_from_matrix(matrix_from_head_angles(*degrees(*angles)))

    assert head_angles(quaternion(0, -8, 0), quaternion(0, -8, 0)) == pytest.approx([0, 0, 0])
    assert np.rad2deg(head_angles(quaternion(0, 12, 0), quaternion(0, -8, 0))) == pytest.approx(
        [0, 20, 0], abs=1e-6
    )
