"""Facts about profiles on the disk: what is told of them, copies, and what is deleted."""

import shutil

import numpy as np
import pytest

from app.commands.edit import open_editor
from app.drive_files import FIRST, Kept, load_kept, save_kept
from app.errors import PicturesDeletedError
from app.profiles import load_setup_images
from app.setup_steps import unseen
from app.shelf import COMING, Shelf, ShelfError, name_taken, size_text
from app.workbook import Workbook
from core.centring import Centre
from core.drive_presets import PRESETS
from core.store import load
from tests.app.test_editor import film, folder  # noqa: F401  fixtures

RGB = np.full((480, 640, 3), 90, np.uint8)


def nothing(rgb):
    return None


@pytest.fixture
def shelf(folder):  # noqa: F811
    """A shelf with one trained profile, "me"."""
    return Shelf(folder.parent)


def test_a_shelf_tells_pictures_and_size_of_each_profile(shelf, folder):  # noqa: F811
    Workbook(shelf.folder / "begun", nothing).put("pose_yaw+0", RGB, unseen(), {})
    (shelf.folder / "notes").mkdir()
    begun, me = shelf.profiles()
    assert (begun.name, begun.trained, begun.n_pictures, begun.n_new) == ("begun", False, 1, 1)
    assert (me.name, me.trained, me.n_new) == ("me", True, 0)
    assert me.n_pictures == len(load(folder).names)
    assert me.size_bytes == sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())
    assert [begun.note, me.note] == ["not yet trained", "trained"]


def test_a_damaged_profile_is_listed_with_what_is_wrong(shelf, folder):  # noqa: F811
    (folder / "profile.json").write_text("{")
    [me] = shelf.profiles()
    assert me.note == "cannot be read" and "profile.json" in me.trouble


def test_no_folder_is_an_empty_shelf(tmp_path):
    assert Shelf(tmp_path / "none").profiles() == []
    assert not name_taken(tmp_path / "none", "me")


def test_a_copy_has_pictures_and_model_and_leads_a_life_of_its_own(shelf):
    shelf.duplicate("me", "me glasses")
    copy, me = (Workbook(shelf.folder / name, nothing) for name in ("me glasses", "me"))
    assert copy.names == me.names and copy.profile is not None
    name = me.names[0]
    copy.put(name, RGB, unseen(), {})
    shelf.delete("me")
    assert [one.name for one in shelf.profiles()] == ["me glasses"]
    assert np.array_equal(Workbook(shelf.folder / "me glasses", nothing).image(name), RGB)


def test_a_copy_never_takes_the_place_of_a_profile(shelf):
    with pytest.raises(ShelfError, match="there is a profile me already"):
        shelf.duplicate("me", "me")
    assert name_taken(shelf.folder, "ME")


def test_a_copy_that_the_disk_has_no_room_for_leaves_nothing(shelf, monkeypatch):
    def full(source, target):
        target.mkdir()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(shutil, "copytree", full)
    with pytest.raises(ShelfError, match="no space left"):
        shelf.duplicate("me", "other")
    assert [path.name for path in shelf.folder.iterdir()] == ["me"]


def test_half_a_copy_is_no_profile(shelf, folder):  # noqa: F811
    shutil.copytree(folder, folder.with_name(COMING + "other"))
    assert [one.name for one in shelf.profiles()] == ["me"]
    shelf.duplicate("me", "other")
    assert {path.name for path in shelf.folder.iterdir()} == {"me", "other"}


def test_without_its_pictures_the_model_is_the_same(shelf, folder):  # noqa: F811
    before = load(folder)
    Workbook(folder, nothing).put("grin_yaw+0", RGB, unseen(), {})
    shelf.delete_pictures("me")
    after = load(folder)
    for name, array in before.regressor.arrays().items():
        assert np.array_equal(after.regressor.arrays()[name], array)
    assert np.array_equal(after.user.deltas_mm, before.user.deltas_mm)
    assert after.camera.focal_px == before.camera.focal_px
    assert not list(folder.rglob("*.png")) + list(folder.rglob("*.jpg"))
    [me] = shelf.profiles()
    assert me.without_pictures and me.note == "trained; pictures deleted"


def test_a_book_whose_pictures_were_deleted_takes_new_ones(shelf, folder):  # noqa: F811
    name = load(folder).names[0]
    assert not Workbook(folder, nothing).pictures_deleted
    shelf.delete_pictures("me")
    book = Workbook(folder, nothing)
    assert book.pictures_deleted and book.names == () and not book.outdated
    book.put(name, RGB, unseen(), {})
    again = Workbook(folder, nothing)
    assert again.names == (name,) and again.outdated
    again.remove(name)
    assert Workbook(folder, nothing).names == ()


def test_the_editor_says_that_the_pictures_were_deleted(shelf, folder):  # noqa: F811
    shelf.delete_pictures("me")
    with pytest.raises(PicturesDeletedError, match="take new pictures: facepuppet setup me"):
        open_editor(folder)


def test_pictures_of_an_untrained_profile_are_not_deleted_without_it(shelf):
    Workbook(shelf.folder / "begun", nothing).put("pose_yaw+0", RGB, unseen(), {})
    with pytest.raises(Exception, match="found no profile"):
        shelf.delete_pictures("begun")
    assert Workbook(shelf.folder / "begun", nothing).names == ("pose_yaw+0",)


def test_a_deleted_profile_is_gone(shelf, folder):  # noqa: F811
    shelf.delete("me")
    assert list(shelf.folder.iterdir()) == [] and shelf.profiles() == []
    with pytest.raises(ShelfError, match="no such file"):
        shelf.delete("me")


def test_setup_images_are_read_while_they_are_there(folder):  # noqa: F811
    assert len(load_setup_images(folder, load(folder)).images) == len(load(folder).names)


@pytest.mark.parametrize(
    "size, text", [(10, "1 kB"), (24_300, "24 kB"), (1_230_000, "1.2 MB"), (24_300_000, "24 MB")]
)
def test_sizes_are_told_shortly(size, text):
    assert size_text(size) == text


def test_a_new_person_of_a_deleted_profiles_name_inherits_no_settings(shelf):
    mine = PRESETS["Lively"][1]
    centre = Centre(np.array([1.0, 0, 0, 0]), np.array([10.0, 0, 500.0]))
    for name in ("me", "other"):
        save_kept(name, "nora", Kept(mine, centre))
    shelf.delete("me")
    assert load_kept("me", "nora").settings == FIRST and load_kept("me", "nora").centre is None
    assert load_kept("other", "nora").settings == mine
