import cv2
import numpy as np
import pytest

from app.errors import SeveralFacesError, TooFewPicturesError
from app.setup_steps import check_one_person, collect, listed, unseen
from core.alignment import Alignment
from core.errors import NoFaceError
from core.face_regions import FaceBox, Region
from core.frame_selection import SelectionSettings
from core.geometry import matrix_from_head_angles
from core.landmarks import MESH478
from core.records import Landmarks2D
from core.setup_plan import SHOTS

FACE = np.random.default_rng(3).normal(0, 1, (478, 3)) * [12, 12, 5]


def box(width, x=10.0):
    return FaceBox(np.array([x, 10.0]), np.array([width, width]), 0.9, np.zeros((6, 2)))


class GreyMeansFace:
    """An aligner that sees a face in every picture whose mean is bright enough.

    The head's yaw grows with the picture's red, so that frames differ.
    """

    def __init__(self, faces=(40.0,)):
        self.faces = faces

    def detect(self, rgb):
        return [box(width) for width in self.faces] if rgb.mean() > 60 else []

    def first(self, rgb):
        return self.follow(rgb, None)

    def follow(self, rgb, previous):
        if rgb.mean() <= 60:
            return None
        rotation = matrix_from_head_angles(rgb[..., 0].mean() / 255, 0, 0)
        mesh = FACE @ rotation.T + [32, 24, 0]
        marks = Landmarks2D(
            mesh[MESH478, :2], np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2)
        )
        region = Region(np.zeros(2), 64.0, 0.0)
        return Alignment(marks, mesh[:, :2], mesh[:, 2], rotation, 0.99, region)


def follow(steps):
    progress = []
    while True:
        try:
            progress.append(next(steps))
        except StopIteration as end:
            return end.value, progress


def write_pictures(folder, levels):
    noise = np.random.default_rng(0).integers(-20, 20, (48, 64, 1))
    for name, level in levels.items():
        cv2.imwrite(str(folder / f"{name}.png"), np.clip(noise + [[[level] * 3]], 0, 255))


def write_video(path, reds):
    noise = np.random.default_rng(0).integers(-40, 40, (48, 64, 1))
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25, (64, 48))
    for red in reds:
        picture = np.clip(noise + [[[90, 90, red]]], 0, 255).astype(np.uint8)
        writer.write(picture if red else np.zeros_like(picture))
    writer.release()


def test_pictures_named_by_shot_get_their_standard_coefficients(tmp_path):
    shot = SHOTS[20]
    write_pictures(tmp_path, {shot.name: 120, "holiday": 120})
    pictures, progress = follow(collect(tmp_path, GreyMeansFace()))
    row = pictures.images.names.index(shot.name)
    np.testing.assert_array_equal(pictures.images.standard[row], shot.standard)
    assert np.isnan(pictures.images.standard[1 - row]).all()
    assert [(one.done, one.total) for one in progress] == [(1, 2), (2, 2)]


def test_a_picture_without_a_face_is_kept_blind_and_mentioned(tmp_path):
    write_pictures(tmp_path, {"pose_yaw+90": 0, "pose_yaw+0": 120, "holiday": 0})
    pictures, _ = follow(collect(tmp_path, GreyMeansFace()))
    blind = pictures.landmarks[pictures.images.names.index("pose_yaw+90")]
    assert not blind.confidence.any()
    placed, dropped = pictures.notes
    assert placed.startswith("no face found in pose_yaw+90: placed by the prompt")
    assert dropped == "no face found in holiday: left out"


def test_no_face_in_any_picture_says_so(tmp_path):
    write_pictures(tmp_path, {"a": 0, "b": 10})
    with pytest.raises(NoFaceError, match=r"any of the 2 pictures.*80 px wide"):
        follow(collect(tmp_path, GreyMeansFace()))


def test_two_people_in_a_picture_are_refused_by_name(tmp_path):
    write_pictures(tmp_path, {"a": 120})
    with pytest.raises(SeveralFacesError, match="2 faces of similar size in a,"):
        follow(collect(tmp_path, GreyMeansFace(faces=(40.0, 30.0))))


def test_a_small_face_in_the_background_is_no_second_person():
    check_one_person([box(40), box(15)], "a")
    check_one_person([], "a")


def test_a_video_gives_its_most_different_frames_by_number(tmp_path):
    write_video(tmp_path / "a.avi", [120] * 90 + list(range(20, 250, 4)) + [120] * 30)
    pictures, progress = follow(collect(tmp_path / "a.avi", GreyMeansFace()))
    numbers = [int(name.removeprefix("frame_")) for name in pictures.images.names]
    assert len(numbers) == 60 and numbers == sorted(numbers)
    # The camera settles first; none of those frames is taken.
    assert numbers[0] == SelectionSettings().settling
    # A third of the video turns the head; by chance that would be 20 of the 60.
    assert len([n for n in numbers if 90 <= n < 148]) > 26
    assert np.isnan(pictures.images.standard).all()
    assert {one.label for one in progress} == {
        "Looking for good frames",
        "Taking the chosen frames",
    }


def test_a_video_without_a_face_or_with_too_few_frames_says_what_is_needed(tmp_path):
    write_video(tmp_path / "dark.avi", [0] * 20)
    with pytest.raises(NoFaceError, match=r"any frame of .*dark\.avi"):
        follow(collect(tmp_path / "dark.avi", GreyMeansFace()))
    write_video(tmp_path / "short.avi", [100] * 4)
    with pytest.raises(TooFewPicturesError, match=r"4 usable pictures in short\.avi, expected at"):
        follow(collect(tmp_path / "short.avi", GreyMeansFace()))


def test_a_video_of_two_people_is_refused(tmp_path):
    write_video(tmp_path / "a.avi", list(range(20, 250, 4)))
    with pytest.raises(SeveralFacesError, match="most frames of"):
        follow(collect(tmp_path / "a.avi", GreyMeansFace(faces=(40.0, 38.0))))


def test_long_lists_are_cut():
    assert listed(["a", "b"]) == "a, b"
    assert listed([str(n) for n in range(9)]) == "0, 1, 2, 3, 4 and 4 more"


def test_unseen_landmarks_have_no_confidence():
    assert not unseen().confidence.any() and not unseen().pupil_confidence.any()
