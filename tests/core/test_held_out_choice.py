"""Facts about which pictures are kept for testing."""

from core.extra_shots import SETS, extra_shots
from core.held_out_choice import held_out_rows
from core.setup_plan import SHOTS, shot_of

NAMES = [shot.name for shot in SHOTS]


def chosen(names, every=5):
    return [names[row] for row in held_out_rows(names, every)]


def test_every_expression_is_tested_once_and_trained_on_twice():
    held = [shot_of(name).expression_name for name in chosen(NAMES)]
    faces = {shot.expression_name for shot in SHOTS} - {"neutral"}
    assert all(held.count(face) == 1 for face in faces)
    assert held.count("neutral") == 3


def test_tests_come_from_all_sides():
    views = [shot_of(name).yaw for name in chosen(NAMES) if "pose" not in name]
    assert [sum(yaw < 0 for yaw in views), sum(yaw > 0 for yaw in views)] == [5, 5]


def test_pictures_that_come_or_go_do_not_change_which_others_are_tested():
    live = [f"live-{n:04d}" for n in range(10)]
    before = set(chosen(NAMES))
    more = [*NAMES[:20], *NAMES[23:], *live]
    after = set(chosen(more))
    assert after - set(live) == before - set(NAMES[20:23])
    assert len(after & set(live)) == 2
    assert set(chosen(more + ["live-0010", "live-0011"])) >= after


def test_of_added_sets_some_pictures_are_tested():
    extra = [shot.name for shot in extra_shots(SETS[0])]
    held = set(chosen(NAMES + extra))
    assert 0 < len(held & set(extra)) < len(extra)


def test_of_a_video_every_fifth_frame_is_tested():
    frames = [f"frame_{n:05d}" for n in range(20)]
    assert held_out_rows(frames, 5) == [2, 7, 12, 17]


def test_where_no_picture_is_for_testing_those_with_examples_are():
    few = [name for name in NAMES if name not in chosen(NAMES)]
    held = chosen(few)
    assert len(held) == 4 and "pose_yaw+0" in held


def test_where_no_picture_has_another_like_it_every_fifth_is_tested():
    apart = [f"pose_yaw{turn}" for turn in ("-90", "-60", "-30", "+0", "+30", "+60", "+90")]
    assert held_out_rows(apart, 5) == [2]


def test_the_only_example_of_a_turn_or_an_expression_is_trained_on():
    turned = ["pose_yaw-30", "pose_yaw+30", "pose_pitch-15", "pose_pitch+15"]
    once = [name for name in NAMES if name.endswith("_yaw+0")]
    held = chosen(once + turned)
    assert set(held) == {"pose_yaw+0", "grin_yaw+0", "eyes_closed_yaw+0"}
