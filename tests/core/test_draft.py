"""Facts about what is kept between two trainings."""

import os
from dataclasses import replace

import numpy as np
import pytest

from core.draft import Draft, DraftPicture
from core.generations import DRAFT_NAME, ProfileUnwritableError, check_target
from core.landmark_edit import points_of
from core.records import Landmarks2D


@pytest.fixture
def landmarks(rng):
    return Landmarks2D(
        rng.uniform(0, 400, (75, 2)), rng.random(75) > 0.5, rng.random(75),
        rng.uniform(0, 400, (2, 2)), rng.random(2),
    )  # fmt: skip


@pytest.fixture
def picture(landmarks):
    moved = replace(landmarks, points_px=landmarks.points_px + 1)
    return DraftPicture(moved, landmarks, "smile.png", {"sharp": 0.8, "why": "dim"})


def test_what_was_put_is_there_for_the_next_program(tmp_path, picture):
    Draft(tmp_path).put("smile", picture, b"a picture")
    draft = Draft(tmp_path)
    assert draft.names() == ["smile"]
    found = draft.get("smile")
    assert np.array_equal(points_of(found.landmarks), points_of(picture.landmarks))
    assert np.array_equal(points_of(found.automatic), points_of(picture.automatic))
    assert np.array_equal(found.landmarks.edited, picture.landmarks.edited)
    assert found.quality == {"sharp": 0.8, "why": "dim"}
    assert draft.content(found) == b"a picture"


def test_new_landmarks_keep_the_picture(tmp_path, picture):
    draft = Draft(tmp_path)
    draft.put("smile", picture, b"a picture")
    draft.put("smile", replace(picture, landmarks=picture.automatic))
    found = draft.get("smile")
    assert np.array_equal(points_of(found.landmarks), points_of(picture.automatic))
    assert draft.content(found) == b"a picture"


def test_nothing_there_is_nothing_and_makes_no_folder(tmp_path):
    draft = Draft(tmp_path / "new")
    assert draft.names() == [] and draft.get("smile") is None
    draft.remove("smile")
    draft.clear()
    assert not (tmp_path / "new").exists()


def test_a_damaged_file_costs_one_picture(tmp_path, picture):
    draft = Draft(tmp_path)
    draft.put("smile", picture, b"a picture")
    draft.put("grin", replace(picture, picture_name="grin.png"), b"another one")
    path = tmp_path / DRAFT_NAME / "smile.npz"
    path.write_bytes(path.read_bytes()[:200])
    assert draft.get("smile") is None
    assert draft.get("grin") is not None


def test_a_picture_whose_file_is_gone_does_not_count(tmp_path, picture):
    draft = Draft(tmp_path)
    draft.put("smile", picture, b"a picture")
    (tmp_path / DRAFT_NAME / "smile.png").unlink()
    assert draft.get("smile") is None


def test_a_write_that_fails_leaves_the_old_state(tmp_path, picture, monkeypatch):
    draft = Draft(tmp_path)
    draft.put("smile", picture, b"a picture")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ProfileUnwritableError, match="no space left"):
        draft.put("smile", replace(picture, landmarks=picture.automatic), b"a newer picture")
    monkeypatch.undo()
    found = draft.get("smile")
    assert np.array_equal(points_of(found.landmarks), points_of(picture.landmarks))
    assert draft.content(found) == b"a picture"
    assert not list((tmp_path / DRAFT_NAME).glob("*.new"))


def test_what_is_removed_leaves_no_files(tmp_path, picture):
    draft = Draft(tmp_path)
    draft.put("smile", picture, b"a picture")
    draft.put("grin", replace(picture, picture_name=""))
    draft.clear()
    assert list((tmp_path / DRAFT_NAME).iterdir()) == []


def test_a_folder_with_nothing_but_a_draft_may_become_a_profile(tmp_path, picture):
    Draft(tmp_path).put("smile", picture, b"a picture")
    check_target(tmp_path)


def test_a_picture_can_be_marked_as_left_out(tmp_path):
    draft = Draft(tmp_path)
    assert draft.taken_out() == []
    draft.take_out("smile_yaw+0")
    draft.take_out("glasses~smile_yaw+0")
    assert Draft(tmp_path).taken_out() == ["glasses~smile_yaw+0", "smile_yaw+0"]
    assert draft.names() == []
    draft.take_out("smile_yaw+0", False)
    draft.take_out("never", False)
    assert draft.taken_out() == ["glasses~smile_yaw+0"]
    draft.clear()
    assert draft.taken_out() == []
