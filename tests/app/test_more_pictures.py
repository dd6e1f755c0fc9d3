"""Facts about pictures that come to a profile later, and about those that go."""

from dataclasses import replace

import numpy as np
import pytest

from app import workbook
from app.first_fit import first_fit
from app.resizing import at_size
from app.setup_steps import unseen
from app.workbook import Workbook
from core.camera import camera_for, project, seen_by
from core.extra_shots import COVERS
from core.held_out_choice import held_out_rows
from core.landmark_edit import points_of
from core.records import Landmarks2D
from core.setup_plan import SHOTS, standard_for
from core.store import load
from tests.app.test_editor import film, folder  # noqa: F401  fixtures
from tests.core.held_out_person import face_model, filmed, person
from tests.core.synthetic_fit import result_of

SHOT, GLASSES, HAND = "pose_yaw+0", "glasses~pose_yaw+0", "hand~mouth~pose_yaw+0"


def nothing(rgb):
    return None


@pytest.fixture
def landmarks(rng):
    return Landmarks2D(
        rng.uniform(50, 400, (75, 2)), np.zeros(75, bool), np.ones(75),
        rng.uniform(50, 400, (2, 2)), np.ones(2),
    )  # fmt: skip


@pytest.fixture
def rgb(rng):
    return rng.integers(0, 255, (480, 640, 3), np.uint8)


@pytest.fixture
def trained_with(monkeypatch, folder):  # noqa: F811
    """What trainings were given; they return the profile with the pictures that they got."""
    given = []

    def make_profile(model, pictures, focal_px, rng):
        given.append(pictures)
        yield
        old, n = load(folder), len(pictures.images.names)
        fit = replace(old.fit, **{
            name: np.resize(getattr(old.fit, name), (n, *getattr(old.fit, name).shape[1:]))
            for name in ("expressions", "rotations_wxyz", "translations_mm",
                         "landmark_vertices", "rms_px")
        })  # fmt: skip
        profile = replace(
            old, names=pictures.images.names, standard=pictures.images.standard,
            landmarks=pictures.landmarks, fit=fit, report={"turn": len(given)},
        )  # fmt: skip
        return profile, pictures.images

    monkeypatch.setattr(workbook, "make_profile", make_profile)
    return given


def train(book):
    return result_of(book.train(None, np.random.default_rng(0)))


def test_a_picture_with_glasses_is_trained_on_as_the_shot_it_repeats(
    folder, rgb, landmarks, trained_with  # noqa: F811
):  # fmt: skip
    book = Workbook(folder, nothing)
    book.put(GLASSES, rgb, landmarks, {})
    assert book.outdated and np.array_equal(book.standard(GLASSES), standard_for(SHOT))
    train(book)
    images = trained_with[0].images
    assert np.array_equal(images.standard[images.names.index(GLASSES)], standard_for(SHOT))
    again = Workbook(folder, nothing)
    assert GLASSES in again.names and not again.outdated
    assert np.array_equal(again.image(GLASSES), rgb)


def test_points_behind_the_hand_are_not_trained_on(tmp_path, rgb, landmarks):
    book = Workbook(tmp_path, nothing)
    book.put(HAND, rgb, landmarks, {})
    kept = Workbook(tmp_path, nothing).landmarks(HAND)
    behind = np.isin(np.arange(75), list(COVERS["mouth"]))
    assert not kept.confidence[behind].any() and kept.confidence[~behind].all()
    assert np.array_equal(points_of(kept), points_of(landmarks))


def test_a_live_frame_has_no_prompt_and_gets_the_next_name(folder, rgb, landmarks):  # noqa: F811
    book = Workbook(folder, nothing)
    assert book.new_name() == "live-0001"
    book.put("live-0001", rgb, landmarks.moved(3, 9.0, 9.0), {"from": "live"})
    assert book.new_name() == "live-0002" and np.isnan(book.standard("live-0001")).all()
    again = Workbook(folder, nothing)
    assert again.new_name() == "live-0002" and again.landmarks("live-0001").edited[3]
    assert again.names[-1] == "live-0001" and again.outdated


@pytest.mark.parametrize("size", [(1280, 960), (1280, 720), (320, 240), (480, 640), (853, 480)])
def test_a_frame_of_another_size_shows_what_the_same_camera_saw(size, rng):
    """A ray of the camera meets the same point of the picture at both sizes."""
    home = camera_for((640, 480), 600.0)
    other = seen_by(home, size)
    points_mm = np.column_stack([rng.uniform(-80, 80, (75, 2)), np.full(75, 600.0)])
    marks = Landmarks2D(
        project(other, points_mm), np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2)
    )
    rgb = np.zeros((size[1], size[0], 3), np.uint8)
    spot = project(other, points_mm[:1])[0]
    y, x = np.mgrid[: size[1], : size[0]]
    reach = 0.02 * max(size)
    rgb[np.hypot(x - spot[0], y - spot[1]) < reach] = 255
    picture, moved = at_size(rgb, marks, (640, 480))
    assert picture.shape == (480, 640, 3)
    assert np.abs(moved.points_px - project(home, points_mm)).max() < 0.75
    weights = picture[..., 0].astype(float)
    rows, columns = np.mgrid[:480, :640]
    middle = np.array([np.average(columns, weights=weights), np.average(rows, weights=weights)])
    assert np.abs(middle - moved.points_px[0]).max() < 1.0


def test_points_that_are_cut_off_are_not_trusted(landmarks):
    tall = np.zeros((640, 480, 3), np.uint8)
    points = landmarks.points_px.copy()
    points[:5] = [200.0, 5.0]
    picture, moved = at_size(tall, replace(landmarks, points_px=points), (640, 480))
    assert picture.shape == (480, 640, 3)
    assert not moved.confidence[:5].any() and moved.confidence.sum() > 10


def test_a_frame_of_another_size_is_kept_at_the_size_of_the_others(
    folder, landmarks  # noqa: F811
):  # fmt: skip
    book = Workbook(folder, nothing)
    book.put("live-0001", np.full((720, 1280, 3), 80, np.uint8), landmarks, {})
    assert book.image("live-0001").shape == (480, 640, 3)
    assert Workbook(folder, nothing).image("live-0001").shape == (480, 640, 3)


def test_pictures_before_the_first_training_are_of_one_size_too(tmp_path, landmarks):
    book = Workbook(tmp_path, nothing)
    book.put(SHOT, np.zeros((240, 320, 3), np.uint8), landmarks, {})
    book.put("smile_yaw+0", np.zeros((480, 640, 3), np.uint8), landmarks, {})
    assert book.image("smile_yaw+0").shape == (240, 320, 3)


def test_a_picture_is_taken_out_and_put_back(folder):  # noqa: F811
    book = Workbook(folder, nothing)
    name = book.names[1]
    book.take_out(name)
    assert book.outdated and book.taken_out == {name}
    assert name in book.names and name not in book.used_names
    again = Workbook(folder, nothing)
    assert again.taken_out == {name} and again.outdated
    assert again.n_usable == len(again.names) - 1
    again.take_out(name, False)
    assert not again.outdated and not Workbook(folder, nothing).taken_out


def test_a_picture_that_was_taken_out_is_gone_after_the_training(
    folder, trained_with  # noqa: F811
):  # fmt: skip
    book = Workbook(folder, nothing)
    name = book.names[1]
    book.take_out(name)
    train(book)
    assert name not in trained_with[0].images.names
    assert name not in book.names and not book.outdated and not book.taken_out
    again = Workbook(folder, nothing)
    assert name not in again.names and not again.outdated


def test_a_picture_that_is_taken_again_is_used_again(folder, rgb, landmarks):  # noqa: F811
    book = Workbook(folder, nothing)
    name = book.names[1]
    book.take_out(name)
    book.put(name, rgb, landmarks, {})
    assert not book.taken_out and not Workbook(folder, nothing).taken_out


def test_the_report_keeps_that_of_the_training_before_and_no_older_one(
    folder, rgb, landmarks, trained_with  # noqa: F811
):  # fmt: skip
    before = load(folder).report
    book = Workbook(folder, nothing)
    train(book)
    assert book.profile.report == {"turn": 1, "previous": before}
    book.put("live-0001", rgb, landmarks, {})
    train(book)
    assert load(folder).report == {"turn": 2, "previous": {"turn": 1}}


def test_a_training_knows_what_was_found_before_it_was_corrected(
    folder, trained_with  # noqa: F811
):  # fmt: skip
    anew = replace(load(folder).landmarks[0], points_px=np.zeros((75, 2)))
    book = Workbook(folder, lambda rgb: anew)
    # Only what is tested is looked at again.
    name = book.names[held_out_rows(book.names, 5)[0]]
    other = next(one for one in book.names if one != name)
    found = book.landmarks(name)
    book.correct(name, found.moved(4, 5.0, 6.0))
    train(book)
    row = trained_with[0].images.names.index(name)
    assert trained_with[0].landmarks[row].edited[4]
    assert np.array_equal(trained_with[0].automatic[row].points_px, found.points_px)
    # Of a picture that was corrected long ago the profile no longer tells: the aligner looks.
    train(book)
    assert np.array_equal(trained_with[1].automatic[row].points_px, anew.points_px)
    assert np.array_equal(
        trained_with[1].automatic[trained_with[1].images.names.index(other)].points_px,
        book.landmarks(other).points_px,
    )


def test_a_face_is_fitted_before_the_first_training_with_pictures_of_all_kinds(tmp_path, rng):
    shots = [s for s in SHOTS if s.expression_name in ("neutral", "smile") and abs(s.yaw) < 1.2]
    people = filmed(person(0), shots, rng)
    book = Workbook(tmp_path, nothing)
    picture = np.full((480, 640, 3), 90, np.uint8)
    for shot, marks in zip(shots, people.landmarks, strict=True):
        book.put(shot.name, picture, marks, {})
    book.put(GLASSES, picture, people.landmarks[1], {})
    book.put("live-0001", picture, people.landmarks[2], {})
    book.put("pose_yaw+90", picture, unseen(), {})
    book.take_out("smile_yaw+30")
    camera, _ = result_of(first_fit(face_model(), book))
    assert camera.size_px == (640, 480)
    guess = book.landmarks("pose_yaw+90")
    assert np.ptp(guess.points_px[:60], axis=0).min() > 20


def test_what_comes_while_a_training_is_at_work_is_not_lost(
    folder, rgb, landmarks, trained_with  # noqa: F811
):  # fmt: skip
    book, other = Workbook(folder, nothing), Workbook(folder, nothing)
    first, second, third = book.names[:3]
    book.correct(first, book.landmarks(first).moved(3, 5.0, 6.0))
    steps = book.train(None, np.random.default_rng(0))
    next(steps)
    other.put("live-0001", rgb, landmarks, {})
    book.correct(second, book.landmarks(second).moved(4, 7.0, 8.0))
    book.take_out(third)
    result_of(steps)
    for now in (book, Workbook(folder, nothing)):
        assert now.profile.landmarks[now.profile.names.index(first)].edited[3]
        assert "live-0001" in now.names and np.array_equal(now.image("live-0001"), rgb)
        assert now.landmarks(second).edited[4] and now.taken_out == {third}
        assert now.outdated
    assert "live-0001" not in load(folder).names
