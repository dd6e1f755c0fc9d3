"""Facts about more pictures for a profile."""

import numpy as np
import pytest

from core.extra_shots import COVERS, SETS, as_seen, cover_of, extra_set, extra_shots
from core.landmarks import GROUPS, MIRROR, N_INTERNAL, NAMES
from core.model_fit import LEAST_LANDMARKS, trusted_landmarks
from core.records import Landmarks2D
from core.setup_plan import SHOTS, set_of, shot_of, standard_for

BY_NAME = {shot.name: shot for shot in SHOTS}


@pytest.fixture
def landmarks(rng):
    return Landmarks2D(
        rng.uniform(0, 400, (75, 2)), np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2)
    )


def test_there_are_sets_for_light_glasses_and_a_hand_of_five_to_ten_pictures():
    assert [one.key for one in SETS] == ["light", "glasses", "hand"]
    assert all(5 <= len(one.shots) <= 10 for one in SETS)


def test_a_picture_of_a_set_is_read_as_the_shot_that_it_repeats():
    for one in SETS:
        for shot in extra_shots(one):
            base = shot_of(shot.name)
            assert base is BY_NAME[base.name]
            assert set_of(shot.name).startswith(one.key)
            assert np.array_equal(standard_for(shot.name), base.standard)
            assert (shot.yaw, shot.pitch, shot.roll) == (base.yaw, base.pitch, base.roll)
    assert set_of("smile_yaw+0") == "" and np.isnan(standard_for("glasses~dance")).all()


def test_names_are_file_names_on_every_system():
    names = [shot.name for one in SETS for shot in extra_shots(one)]
    assert len(set(names)) == len(names)
    assert not any(set(name) & set('/\\:*?"<>|') for name in names)


def test_a_set_goes_on_where_it_stopped_and_begins_anew_when_it_is_whole():
    one = extra_set("light")
    shots = extra_shots(one)
    half = [shot.name for shot in shots[:4]]
    assert [shot.name for shot in extra_shots(one, half)] == [shot.name for shot in shots]
    again = extra_shots(one, [shot.name for shot in shots])
    assert [shot.name for shot in again] == [f"light-2~{name}" for name in one.shots]


def test_an_unknown_set_is_refused():
    with pytest.raises(ValueError, match="'hat'"):
        extra_set("hat")


def test_the_prompt_says_where_the_hand_goes():
    shots = {shot.name: shot for shot in extra_shots(extra_set("hand"))}
    shot = shots["hand~right-cheek~pose_yaw+0"]
    assert shot.instruction.endswith(", and hold a hand before your right cheek.")
    assert cover_of(shot.name) == "right-cheek" and cover_of("glasses~smile_yaw+0") == ""


def test_points_behind_the_hand_count_as_not_seen_unless_placed(landmarks):
    name, mouth = "hand~mouth~pose_yaw+0", GROUPS["lips_outer"]
    seen = as_seen(name, landmarks.moved(mouth[0], 5.0, 6.0))
    assert seen.confidence[mouth[0]] == 1.0
    assert not seen.confidence[list(mouth[1:])].any()
    assert seen.confidence[list(GROUPS["eye_left"])].all() and seen.pupil_confidence.all()
    assert np.array_equal(seen.points_px[mouth[1:], :], landmarks.points_px[mouth[1:], :])
    eye = as_seen("hand~left-eye~pose_yaw+0", landmarks)
    assert eye.pupil_confidence.tolist() == [1.0, 0.0]
    assert as_seen("smile_yaw+0", landmarks) is landmarks


@pytest.mark.parametrize("cover", COVERS)
def test_enough_is_seen_beside_every_hand(cover, landmarks):
    seen = as_seen(f"hand~{cover}~pose_yaw+0", landmarks)
    assert trusted_landmarks(seen) >= 3 * LEAST_LANDMARKS


def test_covers_of_both_sides_are_mirror_images():
    for what in ("cheek", "eye"):
        right, left = COVERS[f"right-{what}"], COVERS[f"left-{what}"]
        assert {int(MIRROR[n]) for n in right} == left
        assert all(NAMES[n].startswith(("R", "L")) for n in right | left if n < N_INTERNAL)
