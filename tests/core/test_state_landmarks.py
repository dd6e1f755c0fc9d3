"""Facts about the landmarks of a solved face."""

from dataclasses import replace

import numpy as np

from core.camera import camera_for, project, seen_by
from core.face_model import eye_centers_mm
from core.gaze import pupil_directions
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.landmark_edit import as_hidden
from core.live import resting_state
from core.state_landmarks import confirmed, landmarks_of_state, pupils_of_state, with_pupils
from tests.core.held_out_person import face_model, person

CAMERA = camera_for((640, 480), 600.0)


def state(rng):
    rotation = matrix_from_head_angles(0.4, -0.2, 0.1)
    return replace(
        resting_state("trained"), rotation_wxyz=quaternion_from_matrix(rotation), lost=False,
        translation_mm=[30.0, -20.0, 550.0], gaze_rad=[[0.2, -0.1], [0.05, -0.1]],
        landmarks_px=rng.uniform(100, 400, (75, 2)), confidence=0.4,
    )  # fmt: skip


def test_pupils_are_where_the_gaze_was_measured(rng):
    model, user, solved = face_model(), person(0), state(rng)
    pupils = pupils_of_state(model, user, solved)
    pose = np.vstack([matrix_from_head_angles(0.4, -0.2, 0.1), solved.translation_mm])
    radii = np.full(2, float(model.eyeball_radius_mm))
    measured = pupil_directions(pupils, pose, eye_centers_mm(model, user.neutral_mm), radii)
    assert np.allclose(measured, solved.gaze_rad, atol=1e-6)


def test_landmarks_are_those_of_the_state_with_its_confidence_and_none_is_placed(rng):
    solved = state(rng)
    size_px = (1280, 960)
    marks = landmarks_of_state(face_model(), person(0), CAMERA, solved, size_px)
    assert np.array_equal(marks.points_px, solved.landmarks_px) and not marks.edited.any()
    assert np.all(marks.confidence == 0.4) and np.all(marks.pupil_confidence == 0.4)
    pupils = project(seen_by(CAMERA, size_px), pupils_of_state(face_model(), person(0), solved))
    assert np.allclose(marks.pupils_px, pupils)


def marks_of(rng):
    return landmarks_of_state(face_model(), person(0), CAMERA, state(rng), (640, 480))


def test_pupils_are_where_the_aligner_sees_them_unless_it_looks_elsewhere(rng):
    found = marks_of(rng)
    near, far = (
        replace(found, pupils_px=found.pupils_px + [by, 0], pupil_confidence=np.ones(2))
        for by in (3, 60)
    )
    closed = replace(near, pupil_confidence=[1.0, 0.0])
    assert np.array_equal(with_pupils(found, near).pupils_px, near.pupils_px)
    assert np.array_equal(with_pupils(found, far).pupils_px, found.pupils_px)
    one = with_pupils(found, closed).pupils_px - found.pupils_px
    assert np.allclose(one, [[3, 0], [0, 0]])


def test_what_the_user_saw_is_trusted_and_what_is_hidden_is_not(rng):
    marks = replace(marks_of(rng), confidence=np.full(75, 0.1))
    seen = confirmed(as_hidden(marks, [3, 4]))
    assert set(np.flatnonzero(seen.confidence < 0.5)) == {3, 4}
