"""Facts about which expressions will be weak, and why."""

import json

import numpy as np
import pytest

from core.arkit import EXPRESSION_NAMES
from core.camera import camera_for
from core.expression_sight import sight_of
from core.records import UserBlendshapes
from core.setup_plan import SHOTS, standard_for
from core.weak_expressions import Shown, weak_expressions
from tests.core.held_out_person import face_model, person

CAMERA = camera_for((640, 480), 600.0)
NAMES = tuple(shot.name for shot in SHOTS if abs(shot.yaw) < 1.2)


def index(name):
    return EXPRESSION_NAMES.index(name)


@pytest.fixture(scope="module")
def sight():
    return sight_of(face_model(), person(0), CAMERA, 600.0)


def shown(names=NAMES, share=1.0, unused=()):
    asked = np.stack([standard_for(name) for name in names])
    return Shown(tuple(names), share * asked, tuple(unused))


def told(sight, pictures):
    return {one["name"]: one for one in weak_expressions(sight, pictures)}


def kinds(one):
    return {reason["kind"] for reason in one["reasons"]}


def test_an_open_jaw_is_seen_well_and_a_puffed_cheek_hardly(sight):
    assert sight.certain[index("jawOpen")] > 0.8 > 0.2 > sight.certain[index("cheekPuffLeft")]
    assert sight.largest_px[index("jawOpen")] > 20 > 3 > sight.largest_px[index("cheekPuffLeft")]
    assert np.all(sight.certain <= sight.alone + 1e-9)
    assert np.all((sight.certain >= -1e-9) & (sight.alone < 1))


def test_a_dimple_is_seen_but_looks_like_a_smile(sight):
    dimple, smile = index("mouthDimpleLeft"), index("mouthSmileLeft")
    assert sight.alone[dimple] > 0.5 and sight.certain[dimple] < 0.2
    assert sight.likeness[dimple].argmax() == smile


def test_the_opposite_movement_is_no_rival(sight):
    left, right = index("jawLeft"), index("jawRight")
    assert sight.likeness[left, right] < -0.8 and sight.certain[left] > 0.6


def test_from_far_away_less_is_seen(sight):
    far = sight_of(face_model(), person(0), CAMERA, 1800.0)
    assert np.median(far.largest_px / sight.largest_px) == pytest.approx(1 / 3, abs=0.02)


def test_a_user_whose_shape_moves_nothing_is_told_so(sight):
    user = person(0)
    deltas = user.deltas_mm.copy()
    deltas[index("jawOpen")] *= 0.01
    still = UserBlendshapes(user.identity, user.neutral_mm, deltas)
    found = told(sight_of(face_model(), still, CAMERA, 600.0), shown())
    assert "jawOpen" not in told(sight, shown())
    assert kinds(found["jawOpen"]) >= {"small"}
    assert found["jawOpen"]["reasons"][0]["px"] < 1


def test_what_pictures_show_well_is_weak_only_by_sight(sight):
    found = told(sight, shown())
    assert "cheekPuff" in found and found["cheekPuff"]["sides"] == "both"
    assert {"smile", "jawLeft", "eyeBlink", "browDown"}.isdisjoint(found)
    assert all(kinds(one) <= {"small", "like", "never asked"} for one in found.values())
    assert "never asked" in kinds(found["jawForward"])


def test_a_missing_prompt_is_named(sight):
    names = [name for name in NAMES if not name.startswith("jaw_left")]
    one = told(sight, shown(names))["jawLeft"]
    assert one["reasons"][-1] == {"kind": "missing", "faces": ["jaw_left"], "pictures": []}
    assert one["sides"] == "" and "jawRight" not in told(sight, shown(names))


def test_pictures_that_were_taken_but_not_used_are_named(sight):
    names = [name for name in NAMES if not name.startswith("jaw_left")]
    one = told(sight, shown(names, unused=["jaw_left_yaw+30", "smile_yaw+0"]))["jawLeft"]
    assert one["reasons"][-1]["kind"] == "unused"
    assert one["reasons"][-1]["pictures"] == ["jaw_left_yaw+30"]


def test_an_expression_that_was_not_made_is_told_with_its_share(sight):
    pictures = shown()
    coefficients = pictures.coefficients.copy()
    coefficients[:, index("browInnerUpLeft")] *= 0.3
    one = told(sight, Shown(NAMES, coefficients, ()))["browInnerUp"]
    assert one["sides"] == "left"
    reason = one["reasons"][-1]
    assert reason["kind"] == "unshown" and reason["faces"] == ["brow_raise"]
    assert reason["share"] == pytest.approx(0.3)


def test_the_weakest_come_first_and_all_is_plain(sight):
    found = weak_expressions(sight, shown(share=0.4))
    strengths = [one["strength"] for one in found]
    assert strengths == sorted(strengths) and json.loads(json.dumps(found)) == found
    assert len(found) > len(weak_expressions(sight, shown()))


def test_pictures_of_a_set_count_as_their_prompt(sight):
    names = [name for name in NAMES if not name.startswith("jaw_left")]
    assert "jawLeft" not in told(sight, shown([*names, "glasses~jaw_left_yaw+0"]))


def test_pictures_without_prompts_count_by_what_they_show(sight):
    """Of a video nobody knows what was meant, but the fit tells what is to be seen."""
    frames = tuple(f"frame_{n:05d}" for n in range(12))
    coefficients = np.zeros((12, 46))
    coefficients[3, index("jawLeft")] = 0.6
    found = told(sight, Shown(frames, coefficients, ()))
    assert "jawLeft" not in found and kinds(found["jawRight"]) == {"missing"}
