"""Drive settings in files: round trip, and whatever else a file may hold."""

import json
import re
from dataclasses import fields, replace

import pytest

from core.arkit import EXPRESSION_NAMES
from core.drive_json import VERSION, settings_from_plain, settings_to_plain
from core.drive_presets import FACES, KEYS, PRESETS
from core.drive_settings import N_KEYS, DriveSettings, ExpressionKey, Response, key_from
from core.plain_json import json_text
from tests.core.driven_faces import face, index


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_survives_a_file(name):
    settings = PRESETS[name][1]
    assert settings_from_plain(json.loads(json_text(settings_to_plain(settings)))) == (settings, ())


def test_a_file_holds_names_and_only_what_differs():
    responses = list(DriveSettings().responses)
    responses[index("jawOpen")] = Response(gain=1.5)
    plain = settings_to_plain(DriveSettings(responses=tuple(responses), keys=KEYS[:1]))
    assert plain["version"] == VERSION
    assert set(plain["responses"]) == {"jawOpen"}
    assert plain["keys"][0]["weights"]["mouthSmileLeft"] == 0.85


def test_what_is_missing_or_unknown_changes_nothing():
    assert settings_from_plain({"colour": "red", "head": {"tail": 3}}) == (DriveSettings(), ())


@pytest.mark.parametrize(
    ("plain", "note"),
    [
        ({"head": {"yaw": 99}}, r"head.yaw is 99, expected 0 to 3: limited"),
        ({"head": {"yaw": "much"}}, r"head.yaw is 'much', expected a number"),
        ({"head": {"yaw": True}}, r"head.yaw is True, expected a number"),
        ({"head": {"yaw": 10**400}}, r"head.yaw is 1000+, expected a number"),
        ({"steadiness": {"eyes": float("nan")}}, r"steadiness.eyes is nan, expected a number"),
        ({"eyes": {"link_lids": "sometimes"}}, r"one of blinks, never, always"),
        ({"centring": {"head": 1}}, r"centring.head is 1, expected bool"),
        ({"idle": [1, 2]}, r"idle is list, expected named values"),
        ({"responses": {"jawOpen": {"high": -1}}}, r"responses.jawOpen.high is -1"),
        ({"keys": "smile"}, r"keys is str, expected a list"),
        ({"keys": [{}] * 12}, r"keys has 12 entries, expected at most 9"),
        ({"keys": [{"weights": {"jawOpen": 7}}]}, r"keys 1.jawOpen is 7"),
        ({"keys": [{"way": "up"}]}, r"keys 1.way is 'up'"),
        ({"version": VERSION + 1}, r"settings of version 2, this program knows 1"),
        (["no", "settings"], r"the settings is list"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_limited_or_left_and_told(plain, note):
    settings, notes = settings_from_plain(plain)
    assert len(notes) == 1
    assert re.search(note, notes[0])
    again, none = settings_from_plain(settings_to_plain(settings))
    assert (again, none) == (settings, ())


def test_limits_are_stated_for_every_number():
    for part in ("steadiness", "head", "centring", "eyes", "idle"):
        record = getattr(DriveSettings(), part)
        for entry in fields(record):
            if isinstance(getattr(record, entry.name), float):
                low, high = entry.metadata["low"], entry.metadata["high"]
                assert low <= getattr(record, entry.name) <= high, entry.name


def test_a_missing_part_comes_from_the_base():
    base = PRESETS["Cartoon"][1]
    settings, _ = settings_from_plain({"head": {"yaw": 2.0}}, base)
    assert settings == replace(base, head=replace(base.head, yaw=2.0))


def test_faces_of_keys_are_whole_and_named():
    assert len(KEYS) == len(FACES) == N_KEYS
    assert all(max(key.weights) > 0.5 for key in KEYS)
    assert all(len(key.weights) == len(EXPRESSION_NAMES) for key in KEYS)


def test_a_key_can_be_made_of_a_face_and_refuses_another_number_of_weights():
    key = key_from("Mine", face(jawOpen=0.12345, mouthClose=1.7))
    assert key.weights[index("jawOpen")] == 0.123
    assert key.weights[index("mouthClose")] == 1.0
    with pytest.raises(ValueError, match="'short' has 3 weights, expected 46"):
        ExpressionKey("short", (0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="46 and at most 9"):
        DriveSettings(keys=(key,) * 10)
