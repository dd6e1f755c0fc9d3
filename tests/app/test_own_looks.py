"""Own looks on the disk, and the live window that has them made."""

import hashlib

import numpy as np
import pytest

from app import own_looks
from app.avatars.gallery import Gallery
from app.avatars.likeness.judge import Likeness
from app.avatars.looks import Looks
from app.controllers.desk import open_desk
from app.controllers.own_avatar import MADE, OwnAvatar
from app.controllers.player import Performer
from app.own_looks import (
    LooksUnwritableError,
    choose_hair,
    chosen_hair,
    forget_looks,
    forget_skin,
    likeness_steps,
    load_likeness,
    save_likeness,
    stamp,
)
from app.painting import OWN, avatar_from
from app.replacing import ProfileChangedError
from app.resources import asset
from app.shelf import Shelf
from core.blendshapes import mean_user
from core.face_model import load_face_model
from core.records import Progress
from core.store import load
from tests.app import test_editor
from tests.app.live_fakes import FakeToolbox, FakeTracker
from tests.app.test_editor import film  # noqa: F401  fixture

filmed_folder = test_editor.folder
GREEN = (40, 200, 60)


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


@pytest.fixture(scope="module")
def user(model):
    return mean_user(model)


@pytest.fixture
def likeness():
    skin = np.zeros((64, 64, 4), np.uint8)
    skin[..., :3], skin[..., 3] = GREEN, 90
    return Likeness(skin, Looks(hair=(10, 20, 30), hair_style="short"), {"cover": 0.6})


def test_looks_are_kept_and_found_for_the_same_face_only(model, user, likeness, tmp_path):
    assert load_likeness(user) is None
    assert stamp(user) == 0
    save_likeness(tmp_path / "ann", user, likeness)
    found = load_likeness(user)
    assert found.looks == likeness.looks
    assert found.report == likeness.report
    np.testing.assert_allclose(found.skin.astype(int), likeness.skin, atol=4)
    other = mean_user(model)
    object.__setattr__(other, "neutral_mm", other.neutral_mm + 0.1)
    assert load_likeness(other) is None


def test_looks_of_a_profile_that_is_trained_anew_replace_the_old_ones(
    model, user, likeness, tmp_path
):
    save_likeness(tmp_path / "ann", user, likeness)
    better = mean_user(model)
    object.__setattr__(better, "neutral_mm", better.neutral_mm + 0.1)
    save_likeness(tmp_path / "ann", better, likeness)
    assert load_likeness(user) is None
    assert load_likeness(better) is not None


def test_deleted_pictures_take_the_skin_with_them_and_deleted_profiles_all(
    user, likeness, tmp_path
):
    save_likeness(tmp_path / "ann", user, likeness)
    choose_hair(tmp_path / "ann", "bob")
    forget_skin(tmp_path / "bob")
    assert load_likeness(user).skin is not None
    forget_skin(tmp_path / "ann")
    assert load_likeness(user).skin is None
    assert load_likeness(user).looks.hair == (10, 20, 30)
    forget_looks(tmp_path / "ann")
    assert load_likeness(user) is None
    assert chosen_hair(tmp_path / "ann") == ""


def test_chosen_hair_is_worn_and_survives_training(model, user, likeness, tmp_path):
    save_likeness(tmp_path / "ann", user, likeness)
    before = stamp(user)
    choose_hair(tmp_path / "ann", "bald")
    assert load_likeness(user).looks.hair_style == "bald"
    assert stamp(user) != before
    save_likeness(tmp_path / "ann", user, likeness)
    assert load_likeness(user).looks.hair_style == "bald"
    choose_hair(tmp_path / "ann", "")
    assert load_likeness(user).looks.hair_style == "short"


def test_damaged_looks_are_as_none(user, likeness, tmp_path):
    path = save_likeness(tmp_path / "ann", user, likeness)
    path.write_bytes(path.read_bytes()[:100])
    assert load_likeness(user) is None
    forget_skin(tmp_path / "ann")
    assert not path.exists()


def test_looks_made_in_an_older_way_are_made_again(user, likeness, tmp_path, monkeypatch):
    save_likeness(tmp_path / "ann", user, likeness)
    monkeypatch.setattr(own_looks, "VERSION", own_looks.VERSION + 1)
    assert load_likeness(user) is None


def test_the_own_avatar_wears_the_own_skin(model, user, likeness, tmp_path):
    gallery = Gallery(asset("."), model)
    plain = avatar_from(gallery, OWN, user)
    save_likeness(tmp_path / "ann", user, likeness)
    own = avatar_from(gallery, OWN, user)
    skins = [
        next(part.material.texture for part in avatar.parts if part.material.shader == "skin")
        for avatar in (plain, own)
    ]
    assert np.abs(skins[1][..., :3].astype(int) - GREEN).max() < 8
    assert np.abs(skins[0][..., :3].astype(int) - GREEN).max() > 60


class Profiles:
    """Stands for the making of looks of profiles in a folder."""

    def __init__(self):
        self.asked, self.result, self.error = [], Likeness(np.zeros((4, 4, 4)), Looks(), {}), None

    def __call__(self, folder):
        self.asked.append(folder.name)
        yield Progress(0, 1, "Making your own avatar")
        if self.error is not None:
            raise self.error
        return self.result


@pytest.fixture
def desk(qtbot, monkeypatch, tmp_path):
    toolbox, profiles = FakeToolbox(profiles=("ann", "ben")), Profiles()
    monkeypatch.setattr("app.controllers.own_avatar.BEGINS_AFTER_MS", 10)
    monkeypatch.setattr(toolbox, "profile_folder", lambda name: tmp_path / name)
    window, controller = open_desk(toolbox)
    qtbot.addWidget(window)
    own = controller.findChild(OwnAvatar)
    own._make = profiles
    window.show()
    controller.start()
    yield window, controller, own, profiles, tmp_path
    window.close()


def test_looks_are_made_once_the_profile_plays_and_then_shown(qtbot, desk):
    window, controller, own, profiles, _ = desk
    shown = []
    controller.scene.choose = shown.append
    qtbot.waitUntil(lambda: shown == [OWN])
    assert profiles.asked == ["ann"]
    qtbot.waitUntil(lambda: window.message_bar.text == MADE)
    controller.use_profile("ben")
    qtbot.waitUntil(lambda: profiles.asked == ["ann", "ben"])
    # A correction makes the same user better known.
    controller.swapped.emit()
    qtbot.waitUntil(lambda: profiles.asked == ["ann", "ben", "ben"])
    qtbot.waitUntil(lambda: own._job is None)


def test_nothing_is_shown_again_where_no_looks_were_made(qtbot, desk):
    _, controller, own, profiles, _ = desk
    qtbot.waitUntil(lambda: bool(profiles.asked) and own._job is None)
    profiles.result = None
    shown = []
    controller.scene.choose = shown.append
    own.begin()
    qtbot.waitUntil(lambda: len(profiles.asked) == 2 and own._job is None)
    assert shown == []


def test_the_menu_of_hair_keeps_what_is_chosen_for_the_profile(qtbot, desk):
    window, controller, own, _, folder = desk
    assert own.hair.menuAction() in window.menu("Avatar").actions()
    texts = [action.text().replace("&", "") for action in own.hair.actions()]
    assert texts == ["As in the pictures", "Short", "Cropped", "Long", "None"]
    own.hair.actions()[3].trigger()
    assert chosen_hair(folder / "ann") == "bob"
    controller.profile_changed.emit("ben")
    assert own.hair.actions()[0].isChecked()
    controller.profile_changed.emit("ann")
    assert own.hair.actions()[3].isChecked()
    controller.profile_changed.emit("")
    assert not own.hair.isEnabled()


def test_hair_that_cannot_be_kept_is_told_and_not_chosen(qtbot, desk, home):
    window, _, own, profiles, _ = desk
    qtbot.waitUntil(lambda: bool(profiles.asked) and own._job is None)
    home.mkdir(exist_ok=True)
    (home / "likeness").write_text("no folder")
    own.hair.actions()[3].trigger()
    assert "annot keep your own avatar's looks" in window.message_bar.text
    assert own.hair.actions()[0].isChecked() and not own.hair.actions()[3].isChecked()


def test_looks_that_cannot_be_kept_are_told_those_of_a_deleted_profile_are_not(qtbot, desk):
    window, _, own, profiles, folder = desk
    qtbot.waitUntil(lambda: bool(profiles.asked) and own._job is None)
    for error, told in (
        (ProfileChangedError(folder, "deleted"), False),
        (LooksUnwritableError(folder, "no space left"), True),
    ):
        profiles.error, count = error, len(profiles.asked)
        own.begin()
        qtbot.waitUntil(lambda count=count: len(profiles.asked) > count and own._job is None)
        assert (str(error)[1:] in window.message_bar.text) == told


def test_the_avatar_knows_which_profile_plays(qtbot, desk, tmp_path):
    _, controller, _, _, _ = desk
    qtbot.waitUntil(lambda: controller._performing.plays)
    performer = Performer(FakeTracker(FakeToolbox(), "trained"), None, folder=tmp_path / "ann")
    controller._performing.swap(performer)
    assert controller.scene._cast.folder == tmp_path / "ann"
    controller.scene.choose("nora")
    assert controller.scene._cast.folder == tmp_path / "ann"


def test_making_looks_changes_no_file_of_the_profile(model, user, tmp_path, monkeypatch):
    """The profile is only read; looks lie elsewhere."""
    folder = tmp_path / "ann"
    folder.mkdir()
    (folder / "profile.json").write_text("{}")

    def digest():
        return {
            path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()
        }

    class Loaded:
        pass

    profile = Loaded()
    profile.user = user
    profile.landmarks = profile.shapes = profile.camera = None
    made = Likeness(None, Looks(skin=(1, 2, 3)), {})

    def read(folder, profile):
        yield Progress(0, 1, "")
        return "pictures"

    def make(model, pictures, maps):
        yield Progress(0, 1, "")
        return made

    monkeypatch.setattr(own_looks, "load", lambda _: profile)
    monkeypatch.setattr(own_looks, "_pictures", read)
    monkeypatch.setattr(own_looks, "make_likeness", make)
    before = digest()
    assert list(likeness_steps(folder, model))
    assert digest() == before
    assert load_likeness(user).looks.skin == (1, 2, 3)
    # The second time they are there already.
    assert list(likeness_steps(folder, model)) == []


def test_a_copied_profile_wears_its_own_hair(user, likeness, tmp_path):
    ann, copy = tmp_path / "ann", tmp_path / "ann glasses"
    save_likeness(ann, user, likeness)
    choose_hair(copy, "bald")
    assert load_likeness(user, copy).looks.hair_style == "bald"
    assert load_likeness(user, ann).looks.hair_style == "short"
    assert stamp(user, copy) != stamp(user, ann)
    save_likeness(copy, user, likeness)
    choose_hair(ann, "bob")
    assert load_likeness(user, copy).looks.hair_style == "bald"
    assert load_likeness(user, ann).looks.hair_style == "bob"


@pytest.mark.parametrize("deletion", ["delete", "delete_pictures"])
def test_own_looks_of_a_profile_that_is_deleted_meanwhile_are_not_kept(
    filmed_folder, likeness, monkeypatch, deletion
):
    def make(model, pictures, maps):
        getattr(Shelf(filmed_folder.parent), deletion)("me")
        yield Progress(0, 1, "Making your own avatar")
        return likeness

    monkeypatch.setattr(own_looks, "make_likeness", make)
    user = load(filmed_folder).user
    with pytest.raises(ProfileChangedError):
        list(likeness_steps(filmed_folder, None))
    assert load_likeness(user) is None


def test_a_copy_makes_its_own_skin_where_the_other_profiles_was_deleted(
    filmed_folder, likeness, monkeypatch
):
    def make(model, pictures, maps):
        yield Progress(0, 1, "Making your own avatar")
        return likeness

    monkeypatch.setattr(own_looks, "make_likeness", make)
    user = load(filmed_folder).user
    list(likeness_steps(filmed_folder, None))
    shelf = Shelf(filmed_folder.parent)
    shelf.duplicate("me", "copy")
    shelf.delete_pictures("me")
    list(likeness_steps(shelf.folder / "copy", None))
    assert load_likeness(user, shelf.folder / "copy").skin is not None
    assert load_likeness(user, filmed_folder).skin is None
