"""Settings of the drive on disk: what was kept comes back, whatever happened to the file."""

from dataclasses import replace

import numpy as np
import pytest

from app.drive_files import (
    FIRST,
    Kept,
    PresetNameError,
    SettingsUnwritableError,
    delete_preset,
    drive_file,
    load_kept,
    load_preset,
    preset_names,
    save_kept,
    save_preset,
)
from core.centring import Centre
from core.drive_presets import PRESETS
from core.drive_settings import DriveSettings, HeadMotion

MINE = replace(FIRST, head=HeadMotion(yaw=0.5))
OTHER = replace(FIRST, head=HeadMotion(yaw=2.0))
CENTRE = Centre(np.array([1.0, 0, 0, 0]), np.array([10.0, 0, 500.0]))


def test_settings_are_kept_for_each_profile_and_avatar():
    save_kept("anna", "nora", Kept(MINE, CENTRE))
    save_kept("anna", "leo", Kept(OTHER, CENTRE))
    kept = load_kept("anna", "nora")
    assert kept.settings == MINE
    assert kept.notes == ()
    assert load_kept("anna", "leo").settings == OTHER
    assert load_kept("bert", "nora").settings == FIRST


def test_the_centre_is_kept_for_the_profile_whatever_the_avatar():
    save_kept("anna", "nora", Kept(MINE, CENTRE))
    there = load_kept("anna", "viktor").centre
    np.testing.assert_array_equal(there.translation_mm, CENTRE.translation_mm)
    assert load_kept("bert", "nora").centre is None
    save_kept("anna", "leo", Kept(MINE))
    assert load_kept("anna", "nora").centre is None


def test_a_new_avatar_begins_with_what_the_profile_used_last():
    save_kept("anna", "nora", Kept(MINE, CENTRE))
    assert load_kept("anna", "viktor").settings == MINE
    assert load_kept("", "viktor").settings == FIRST


@pytest.mark.parametrize("content", ["", "{", "[1, 2]", '{"head": 3'])
def test_of_a_broken_file_the_last_good_state_is_used_and_told(content):
    save_kept("anna", "nora", Kept(MINE))
    save_kept("anna", "nora", Kept(OTHER))
    path = drive_file("anna", "nora")
    path.write_text(content)
    kept = load_kept("anna", "nora")
    assert kept.settings == MINE
    assert "nora.json is damaged, expected" in kept.notes[0]
    assert path.with_name("nora.json.broken").read_text() == content


def test_without_any_good_file_the_usual_settings_are_used_and_told():
    path = drive_file("", "own")
    path.parent.mkdir(parents=True)
    path.write_text("no settings")
    kept = load_kept("", "own")
    assert kept.settings == FIRST
    assert len(kept.notes) == 1
    assert load_kept("", "own").notes == ()


def test_values_that_cannot_be_are_limited_and_told():
    save_kept("anna", "nora", Kept(MINE))
    path = drive_file("anna", "nora")
    path.write_text(path.read_text().replace('"yaw": 0.5', '"yaw": 77'))
    kept = load_kept("anna", "nora")
    assert kept.settings.head.yaw == 3.0
    assert "head.yaw is 77, expected 0 to 3" in kept.notes[0]


def test_profiles_that_are_paths_have_a_file_inside_the_settings(home):
    path = drive_file("../../etc/x", "own")
    assert path.parent.parent == home / "settings" / "drive"
    save_kept("../../etc/x", "own", Kept(MINE))
    assert load_kept("../../etc/x", "own").settings == MINE


def test_what_cannot_be_written_is_told_and_what_was_there_stays(home):
    home.mkdir()
    (home / "settings").write_text("a file where a folder should be")
    with pytest.raises(SettingsUnwritableError, match=r"they hold until the program ends"):
        save_kept("anna", "nora", Kept(MINE))


def test_presets_are_saved_listed_chosen_and_deleted():
    save_preset("My stream / evening", MINE)
    assert preset_names() == [*PRESETS, "My stream / evening"]
    assert load_preset("My stream / evening").settings == MINE
    save_preset("My stream / evening", OTHER)
    assert load_preset("My stream / evening").settings == OTHER
    delete_preset("My stream / evening")
    delete_preset("My stream / evening")
    assert preset_names() == list(PRESETS)
    assert load_preset("Calm").settings == PRESETS["Calm"][1]


@pytest.mark.parametrize("name", ["", "   ", "x" * 50, "natural", "Calm", "\udcff" * 90])
def test_names_that_presets_cannot_have_are_refused(name):
    with pytest.raises(PresetNameError, match="choose another name"):
        save_preset(name, DriveSettings())


def test_a_name_whose_file_name_would_be_too_long_is_refused_with_the_reason():
    save_preset("\u6f14" * 20, MINE)
    assert preset_names()[-1] == "\u6f14" * 20
    with pytest.raises(PresetNameError, match=r"takes 270 bytes as a file name, .* at most 200"):
        save_preset("\u6f14" * 30, MINE)


def test_settings_that_are_kept_twice_leave_those_before_as_the_last_good_ones():
    for settings in (OTHER, MINE, MINE, MINE):
        save_kept("anna", "nora", Kept(settings))
    drive_file("anna", "nora").write_text("{")
    assert load_kept("anna", "nora").settings == OTHER


def test_a_damaged_preset_is_told():
    save_preset("Mine", MINE)
    next(drive_file("", "").parent.parent.parent.glob("presets/*.json")).write_text("{")
    kept = load_preset("Mine")
    assert kept.settings == FIRST
    assert "the preset Mine is damaged" in kept.notes[0]
