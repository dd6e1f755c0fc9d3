from pathlib import Path

import numpy as np
import pytest

from app import resources
from app.profiles import (
    MANY_PICTURES,
    ProfileNameError,
    data_folder,
    decoded_pictures,
    encoded_pictures,
    profile_folder,
    profile_names,
)
from app.resources import asset
from core.generations import ProfileDamagedError
from core.records import SetupImages


def make_images(rng, count=3):
    rgbs = tuple(rng.integers(0, 255, (24, 32, 3), dtype=np.uint8) for _ in range(count))
    names = tuple(f"pose_yaw+{n}" for n in range(count))
    return SetupImages(rgbs, names, np.full((count, 46), np.nan))


def test_a_name_lives_in_the_user_data_folder(home):
    assert profile_folder("anna 2") == home / "profiles" / "anna 2"


def test_a_text_with_a_separator_is_a_path(tmp_path):
    assert profile_folder("./anna") == Path("anna")
    assert profile_folder(str(tmp_path / "x" / "anna")) == tmp_path / "x" / "anna"


@pytest.mark.parametrize("text", ["", ".", "..", ".hidden", "a?b", "a:b", "a\nb", "dot.", "gap "])
def test_what_could_be_no_folder_everywhere_is_no_name(text):
    with pytest.raises(ProfileNameError, match="expected letters"):
        profile_folder(text)


@pytest.mark.parametrize("text", ["CON", "nul", "com1.txt", "LPT9", "aux "])
def test_names_of_devices_are_refused(text):
    with pytest.raises(ProfileNameError, match=r"device|space or dot last"):
        profile_folder(text)


@pytest.mark.parametrize("text", ["a" * 61, "a" * 300])
def test_long_names_are_refused_in_few_words(text):
    with pytest.raises(ProfileNameError, match="expected 60 at most") as caught:
        profile_folder(text)
    assert len(str(caught.value)) < 160


def test_names_with_sixty_letters_are_taken(home):
    assert profile_folder("a" * 60) == home / "profiles" / ("a" * 60)


@pytest.mark.parametrize(
    "platform, variable, expected",
    [
        ("linux", "XDG_DATA_HOME", "base/facepuppet"),
        ("win32", "LOCALAPPDATA", "base/facepuppet"),
        ("darwin", "HOME", "base/Library/Application Support/facepuppet"),
    ],
)
def test_each_system_has_its_place_for_user_data(
    tmp_path, monkeypatch, platform, variable, expected
):
    monkeypatch.delenv("FACEPUPPET_HOME")
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setenv(variable, str(tmp_path / "base"))
    assert data_folder() == tmp_path / expected


def test_profiles_are_listed_by_name(home):
    for name in ("berta", "Anna"):
        (home / "profiles" / name).mkdir(parents=True)
        (home / "profiles" / name / "profile.json").write_text("{}")
    (home / "profiles" / "half made").mkdir()
    assert profile_names() == ["Anna", "berta"]


def test_pictures_survive_being_files(rng):
    images = make_images(rng)
    files = encoded_pictures(images)
    assert set(files) == {f"pose_yaw+{n}.png" for n in range(3)}
    back = decoded_pictures(images, files, Path("p"))
    assert back.names == images.names
    for one, other in zip(back.images, images.images, strict=True):
        np.testing.assert_array_equal(one, other)


def test_many_pictures_are_kept_as_jpeg(rng):
    files = encoded_pictures(make_images(rng, MANY_PICTURES))
    assert {Path(name).suffix for name in files} == {".jpg"}


def test_a_missing_or_damaged_picture_is_named(rng):
    images = make_images(rng)
    files = encoded_pictures(images)
    without = {name: content for name, content in files.items() if "+1" not in name}
    with pytest.raises(ProfileDamagedError, match=r"pose_yaw\+1 is not there"):
        decoded_pictures(images, without, Path("p"))
    with pytest.raises(ProfileDamagedError, match=r"pose_yaw\+1 is not decodable"):
        decoded_pictures(images, without | {"pose_yaw+1.png": b"no picture"}, Path("p"))


def test_shipped_files_are_found_and_a_missing_one_says_where_it_was_looked_for():
    assert asset("animation_prior.npz").is_file()
    with pytest.raises(FileNotFoundError, match=r"assets/no_such_file.*install facepuppet again"):
        asset("no_such_file")


def test_an_installed_package_is_preferred_to_the_checkout(tmp_path, monkeypatch):
    (tmp_path / "_data" / "assets").mkdir(parents=True)
    (tmp_path / "_data" / "assets" / "face_model.npz").write_bytes(b"")
    monkeypatch.setattr(resources, "_PACKAGE", tmp_path)
    assert asset("face_model.npz") == tmp_path / "_data" / "assets" / "face_model.npz"
