"""Facts about the pictures of a profile between shooting and training."""

from dataclasses import replace

import numpy as np
import pytest

from app import workbook
from app.first_fit import first_fit
from app.replacing import ProfileChangedError
from app.setup_steps import unseen
from app.shelf import Shelf
from app.workbook import Workbook
from core.draft import Draft
from core.landmark_edit import points_of
from core.records import Landmarks2D, Progress
from core.setup_plan import SHOTS
from core.store import load
from tests.app.test_editor import film, folder  # noqa: F401  fixtures
from tests.core.held_out_person import face_model, filmed, person
from tests.core.synthetic_fit import result_of

SHOT = "grin_yaw+0"


def nothing(rgb):
    return None


@pytest.fixture
def landmarks(rng):
    return Landmarks2D(
        rng.uniform(0, 400, (75, 2)), np.zeros(75, bool), rng.random(75),
        rng.uniform(0, 400, (2, 2)), rng.random(2),
    )  # fmt: skip


@pytest.fixture
def rgb(rng):
    return rng.integers(0, 255, (48, 64, 3), np.uint8)


def test_a_shot_is_there_for_the_next_program(tmp_path, rgb, landmarks):
    book = Workbook(tmp_path / "new", nothing)
    assert book.names == () and book.profile is None
    book.put(SHOT, rgb, landmarks, {"sharp": 0.4})
    again = Workbook(tmp_path / "new", nothing)
    assert again.names == (SHOT,)
    assert np.array_equal(again.image(SHOT), rgb)
    assert np.array_equal(points_of(again.landmarks(SHOT)), points_of(landmarks))
    assert again.quality(SHOT) == {"sharp": 0.4}
    assert np.array_equal(again.standard(SHOT), book.standard(SHOT))
    assert again.outdated


def test_shots_stand_in_the_order_of_the_prompts(tmp_path, rgb, landmarks):
    book = Workbook(tmp_path, nothing)
    wanted = [SHOTS[n].name for n in (30, 2, 17)]
    for name in wanted:
        book.put(name, rgb, landmarks, {})
    assert book.names == (wanted[1], wanted[2], wanted[0])


def test_a_retaken_shot_replaces_the_first_and_a_dropped_one_is_gone(tmp_path, rgb, landmarks):
    book = Workbook(tmp_path, nothing)
    book.put(SHOT, rgb, landmarks, {})
    book.put(SHOT, 255 - rgb, landmarks, {})
    assert np.array_equal(Workbook(tmp_path, nothing).image(SHOT), 255 - rgb)
    book.remove(SHOT)
    assert book.names == () and Workbook(tmp_path, nothing).names == ()


def test_a_corrected_shot_keeps_its_picture_and_what_was_found(tmp_path, rgb, landmarks):
    book = Workbook(tmp_path, nothing)
    book.put(SHOT, rgb, landmarks, {"sharp": 0.4})
    moved = landmarks.moved(3, 10.0, 20.0)
    book.correct(SHOT, moved)
    again = Workbook(tmp_path, nothing)
    assert np.array_equal(points_of(again.landmarks(SHOT)), points_of(moved))
    assert np.array_equal(points_of(again.automatic(SHOT)), points_of(landmarks))
    assert np.array_equal(again.image(SHOT), rgb) and again.quality(SHOT) == {"sharp": 0.4}


def test_new_shots_stand_beside_those_of_the_profile(folder, rgb, landmarks):  # noqa: F811
    before = Workbook(folder, nothing)
    assert not before.outdated
    before.put(SHOT, rgb, landmarks, {})
    again = Workbook(folder, nothing)
    assert set(again.names) == {*load(folder).names, SHOT} and again.outdated
    again.remove(SHOT)
    assert not Workbook(folder, nothing).outdated


def test_training_takes_all_pictures_and_empties_the_draft(
    folder, film, landmarks, monkeypatch  # noqa: F811
):  # fmt: skip
    book = Workbook(folder, nothing)
    grey = np.full((480, 640, 3), 99, np.uint8)
    book.put(SHOT, grey, landmarks, {})
    seen = []

    def make_profile(model, pictures, focal_px, rng):
        seen.append((pictures.images.names, focal_px))
        yield
        n = len(pictures.images.names)
        old = load(folder)
        return replace(
            old, names=pictures.images.names, standard=pictures.images.standard,
            landmarks=pictures.landmarks,
            fit=replace(old.fit, **{
                name: np.resize(getattr(old.fit, name), (n, *getattr(old.fit, name).shape[1:]))
                for name in ("expressions", "rotations_wxyz", "translations_mm",
                             "landmark_vertices", "rms_px")
            }),
        ), pictures.images  # fmt: skip

    monkeypatch.setattr(workbook, "make_profile", make_profile)
    for _ in book.train(None, np.random.default_rng(0)):
        pass
    assert seen == [(book.names, None)] and SHOT in seen[0][0]
    assert not book.outdated
    assert SHOT in load(folder).names and not Workbook(folder, nothing).outdated


def test_before_the_first_training_a_face_is_fitted_and_profiles_are_guessed(tmp_path, rng):
    shots = [shot for shot in SHOTS if shot.expression_name in ("neutral", "smile")]
    people = filmed(person(0), [s for s in shots if abs(s.yaw) < 1.2], rng)
    seen = dict(zip((shot.name for shot in people.shots), people.landmarks, strict=True))
    book = Workbook(tmp_path, nothing)
    picture = np.full((480, 640, 3), 90, np.uint8)
    for shot in shots:
        book.put(shot.name, picture, seen.get(shot.name, unseen()), {})
    steps = first_fit(face_model(), book)
    camera, user = result_of(steps)
    assert camera.size_px == (640, 480) and user.neutral_mm.shape == face_model().mean_mm.shape
    guess = book.landmarks("pose_yaw-90")
    assert not guess.confidence.any()
    frontal = book.landmarks("pose_yaw+0").points_px
    assert 0.3 < np.ptp(guess.points_px[:60], axis=0)[0] / np.ptp(frontal[:60], axis=0)[0] < 0.9
    shift = guess.points_px[:60].mean(axis=0) - frontal[:60].mean(axis=0)
    # The face moves round the neck to where it looks.
    assert -280 < shift[0] < -60 and abs(shift[1]) < 40
    again = Workbook(tmp_path, nothing)
    assert not again.landmarks("pose_yaw-90").points_px.any()


def trained_with(monkeypatch, folder, meanwhile=lambda: None):  # noqa: F811
    """Let trainings learn nothing but the names; return the names of each."""
    seen = []

    def make_profile(model, pictures, focal_px, rng):
        seen.append(pictures.images.names)
        old, n = load(folder), len(pictures.images.names)
        yield Progress(0, 1, "Training")
        meanwhile()
        fits = ("expressions", "rotations_wxyz", "translations_mm", "landmark_vertices", "rms_px")
        shapes = ("points_mm", "rotations_wxyz", "translations_mm", "coefficients", "rms_px")
        return replace(
            old, names=pictures.images.names, standard=pictures.images.standard,
            landmarks=pictures.landmarks, fit=resized(old.fit, fits, n),
            shapes=resized(old.shapes, shapes, n),
        ), pictures.images  # fmt: skip

    monkeypatch.setattr(workbook, "make_profile", make_profile)
    return seen


def resized(record, names, n):
    arrays = {name: getattr(record, name) for name in names}
    return replace(record, **{k: np.resize(a, (n, *a.shape[1:])) for k, a in arrays.items()})


def train(book):
    return result_of(book.train(None, np.random.default_rng(0)))


GREY = np.full((480, 640, 3), 99, np.uint8)


def test_what_another_book_keeps_before_a_training_is_trained(
    folder, landmarks, monkeypatch  # noqa: F811
):  # fmt: skip
    seen = trained_with(monkeypatch, folder)
    editor, live = Workbook(folder, nothing), Workbook(folder, nothing)
    live.put("live-0001", GREY, landmarks, {})
    train(editor)
    assert "live-0001" in seen[0] and "live-0001" in load(folder).names
    assert np.array_equal(Workbook(folder, nothing).image("live-0001"), GREY)


def test_what_another_book_keeps_or_changes_during_a_training_stays_in_the_draft(
    folder, landmarks, monkeypatch  # noqa: F811
):  # fmt: skip
    editor, live = Workbook(folder, nothing), Workbook(folder, nothing)
    editor.put("live-0001", GREY, landmarks, {})

    def meanwhile():
        live.put("live-0001", 255 - GREY, landmarks, {})
        live.put("live-0002", GREY, landmarks, {})

    trained_with(monkeypatch, folder, meanwhile)
    train(editor)
    assert Draft(folder).names() == ["live-0001", "live-0002"]
    assert np.array_equal(editor.image("live-0001"), 255 - GREY)
    assert editor.outdated and "live-0002" in editor.names


def test_what_another_training_has_learned_is_in_the_next_one(
    folder, landmarks, monkeypatch  # noqa: F811
):  # fmt: skip
    seen = trained_with(monkeypatch, folder)
    editor, live = Workbook(folder, nothing), Workbook(folder, nothing)
    live.put("live-0001", GREY, landmarks, {})
    train(live)
    editor.put(SHOT, GREY, landmarks, {})
    train(editor)
    assert {"live-0001", SHOT} <= set(seen[1])
    assert {"live-0001", SHOT} <= set(load(folder).names) and not Draft(folder).names()


@pytest.mark.parametrize("deletion", ["delete", "delete_pictures"])
def test_a_training_brings_nothing_back_that_was_deleted_meanwhile(
    folder, landmarks, monkeypatch, deletion  # noqa: F811
):  # fmt: skip
    shelf = Shelf(folder.parent)
    trained_with(monkeypatch, folder, lambda: getattr(shelf, deletion)("me"))
    with pytest.raises(ProfileChangedError, match="while something was made from it"):
        train(Workbook(folder, nothing))
    assert folder.exists() == (deletion == "delete_pictures")
    assert not list(folder.rglob("*.png"))


@pytest.mark.parametrize("deletion", ["delete", "delete_pictures"])
def test_a_training_of_what_was_deleted_before_does_not_begin(
    folder, monkeypatch, deletion  # noqa: F811
):  # fmt: skip
    seen = trained_with(monkeypatch, folder)
    book = Workbook(folder, nothing)
    getattr(Shelf(folder.parent), deletion)("me")
    with pytest.raises(ProfileChangedError):
        train(book)
    assert seen == []


def test_a_deleted_profile_that_was_never_trained_is_not_brought_back(
    tmp_path, folder, landmarks, monkeypatch  # noqa: F811
):  # fmt: skip
    book, shelf = Workbook(folder.parent / "new", nothing), Shelf(folder.parent)
    book.put(SHOT, GREY, landmarks, {})
    trained_with(monkeypatch, folder, lambda: shelf.delete("new"))
    with pytest.raises(ProfileChangedError, match="deleted"):
        train(book)
    assert not book.folder.exists()


def test_a_window_sees_all_pictures_while_they_are_read_anew(folder, monkeypatch):  # noqa: F811
    trained_with(monkeypatch, folder)
    book = Workbook(folder, nothing)
    names, seen = book.names, []
    read = workbook.load_setup_images

    def looked_at(*args):
        seen.append((book.names, book.image(names[0]).shape))
        return read(*args)

    monkeypatch.setattr(workbook, "load_setup_images", looked_at)
    train(book)
    assert seen == [(names, (480, 640, 3))]
