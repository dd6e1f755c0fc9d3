"""Facts about the 60 prompts."""

from collections import Counter

import numpy as np
import pytest

from core.arkit import EXPRESSION_NAMES, mirror_permutation
from core.setup_plan import REQUESTS, SHOTS, STANDARD_WEIGHTS, coefficients, standard_for


def by_name(name):
    return next(shot for shot in SHOTS if shot.name == name)


def test_there_are_15_poses_and_15_expressions_at_three_yaws():
    counts = Counter(shot.expression_name for shot in SHOTS)
    assert len(SHOTS) == 60
    assert counts.pop("neutral") == 15
    assert len(counts) == 15 and set(counts.values()) == {3}


def test_names_are_unique_and_fit_for_files():
    names = [shot.name for shot in SHOTS]
    assert len(set(names)) == 60
    assert {"pose_yaw-90", "pose_yaw+0", "pose_pitch+15", "pose_roll-30", "smile_yaw+30"} <= set(
        names
    )
    assert all(name.isascii() and "/" not in name and " " not in name for name in names)


def test_poses_cover_the_angles_of_the_paper():
    poses = [shot for shot in SHOTS if shot.expression_name == "neutral"]
    yaws = sorted(round(np.rad2deg(shot.yaw)) for shot in poses if shot.name.startswith("pose_yaw"))
    assert yaws == [-90, -60, -30, 0, 30, 60, 90]
    for axis in ("pitch", "roll"):
        found = sorted(round(np.rad2deg(getattr(s, axis))) for s in poses if getattr(s, axis))
        assert found == [-30, -15, 15, 30]


def test_only_one_angle_is_asked_at_a_time():
    for shot in SHOTS:
        assert np.count_nonzero([shot.yaw, shot.pitch, shot.roll]) <= 1


def test_standard_coefficients_are_coefficients_and_differ():
    rows = {shot.expression_name: shot.standard for shot in SHOTS}
    for name, row in rows.items():
        assert row.shape == (46,) and row.min() >= 0 and row.max() <= 1
        assert (row.max() > 0) == (name != "neutral")
    stacked = np.array(list(rows.values()))
    distances = np.linalg.norm(stacked[:, None] - stacked[None], axis=-1)
    assert distances[~np.eye(len(stacked), dtype=bool)].min() > 0.4


def test_left_and_right_prompts_are_mirror_images():
    permutation = mirror_permutation()
    for left, right in (("jaw_left", "jaw_right"), ("squeeze_left_eye", "squeeze_right_eye")):
        a, b = by_name(left + "_yaw+0").standard, by_name(right + "_yaw+0").standard
        np.testing.assert_array_equal(a[permutation], b)


def test_a_name_without_a_side_means_both_sides():
    row = coefficients({"eyeBlink": 0.7, "jawLeft": 0.2})
    assert row[EXPRESSION_NAMES.index("eyeBlinkLeft")] == 0.7
    assert row[EXPRESSION_NAMES.index("eyeBlinkRight")] == 0.7
    assert row.sum() == pytest.approx(1.6)


def test_a_misspelt_expression_is_refused():
    with pytest.raises(ValueError, match="jawOpened"):
        coefficients({"jawOpened": 1.0})


def test_standard_of_a_file_that_is_no_shot_is_unknown():
    assert np.isnan(standard_for("frame_00017")).all()
    np.testing.assert_array_equal(
        standard_for("smile_yaw-30"), coefficients(STANDARD_WEIGHTS["smile"])
    )


def test_instructions_say_the_expression_and_the_turn():
    assert "to your left" in by_name("smile_yaw+30").instruction
    assert "Smile" in by_name("smile_yaw+30").instruction
    assert "up" in by_name("pose_pitch+15").instruction
    assert set(REQUESTS) == set(STANDARD_WEIGHTS)


def test_a_shot_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        SHOTS[0].standard[0] = 1.0
