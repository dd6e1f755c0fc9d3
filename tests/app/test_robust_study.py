"""What happens to the performer and when; how the robustness study counts."""

import numpy as np
import pytest

from app.performer import hand
from app.performer.conditions import CONDITIONS, LASTING, check_conditions
from app.performer.cup import cup_solid, cup_to_camera
from app.performer.events import (
    CALM_S,
    LIGHT_OFF_S,
    LIGHT_ON_S,
    PASSING_MM,
    ROUND_S,
    held_share,
    hunting_gain,
    light_is_on,
    passing_mm,
    stroke_share,
    switching_gain,
    visit_share,
)
from app.performer.guests import other_than
from app.performer.opening import PEOPLE, TAKE_NAMES, Scenario
from app.performer.people import load_person
from app.performer.props import lips_mm
from app.performer.takes import make_take
from app.resources import asset
from app.studies.robust import FOUND_PX, event_cells, recoveries
from app.studies.robust_events import Event, Filmed, _shares, events
from core.camera import camera_for, project
from core.evaluation import Truth
from core.face_model import eye_centers_mm, load_face_model
from core.live import resting_state
from core.records import Frame

TIMES_S = np.arange(0, 3 * ROUND_S, 1 / 30)
CAMERA = camera_for((640, 480), 600.0)


@pytest.mark.parametrize("share", [held_share, stroke_share, visit_share])
def test_events_come_and_go_in_every_round_and_leave_a_calm_beginning(share):
    shares = np.array([share(time_s) for time_s in TIMES_S])
    assert shares[TIMES_S < CALM_S].max() == 0 and shares.max() > 0.99
    assert shares.min() >= 0 and np.abs(np.diff(shares)).max() < 0.35
    again = [share(time_s + ROUND_S) for time_s in TIMES_S]
    np.testing.assert_allclose(shares, again, atol=1e-9)


def test_somebody_passes_once_a_round_from_side_to_side():
    places = np.array([passing_mm(time_s) for time_s in np.arange(0, ROUND_S, 0.01)])
    assert (places[0], places[-1]) == (-PASSING_MM, PASSING_MM)
    assert np.all(np.diff(places) >= 0)


def test_a_webcam_gets_used_to_the_dark_and_to_the_light_again():
    assert light_is_on(0.0) and not light_is_on(LIGHT_OFF_S + 0.1) and light_is_on(LIGHT_ON_S)
    dark = [switching_gain(t) for t in np.linspace(LIGHT_OFF_S, LIGHT_ON_S - 1e-6, 20)]
    light = [switching_gain(t) for t in np.linspace(LIGHT_ON_S, ROUND_S - 1e-6, 20)]
    assert np.all(np.diff(dark) > 0) and np.all(np.diff(light) < 0)
    # When the light comes back the picture is too bright at first.
    assert dark[0] == 1.0 and light[0] == pytest.approx(dark[-1]) and light[0] > 1.5
    assert light[-1] < 1.05


def test_an_exposure_that_hunts_goes_far_to_both_sides_after_a_calm_beginning():
    gains = np.array([hunting_gain(time_s) for time_s in TIMES_S])
    assert np.all(gains[TIMES_S <= CALM_S] == 1.0)
    assert gains.min() < 0.5 and gains.max() > 1.6
    assert np.abs(np.diff(np.log(gains))).max() < 0.15


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


def test_hand_and_cup_cover_what_they_should_and_nothing_when_away(model):
    person = load_person(asset("people.npz"), model, "mara")
    lips, eyes = lips_mm(model, person), eye_centers_mm(model, person.neutral_mm)
    head = np.eye(4)

    def cover(solid, matrix, place):
        points = solid.points_mm @ matrix[:3, :3].T + matrix[:3, 3]
        near = points[np.linalg.norm(points[:, :2] - place[:2], axis=1) < 9]
        return len(near) > 5 and bool((near[:, 2] < place[2] + 5).any())

    fingers = hand.hand_solid()
    over = hand.hand_to_camera(head, eyes[0] + hand.AT_EYE_MM, 1.0)
    assert cover(fingers, over, eyes[0]) and not cover(fingers, over, eyes[1])
    away = hand.hand_to_camera(head, eyes[0] + hand.AT_EYE_MM, 0.0)
    assert not cover(fingers, away, eyes[0])
    cup = cup_solid()
    there, gone = (
        cup.points_mm @ matrix[:3, :3].T + matrix[:3, 3]
        for matrix in (cup_to_camera(head, lips, 1.0), cup_to_camera(head, lips, 0.0))
    )
    assert (there[:, :2].min(axis=0) < lips[:2] - 5).all()
    assert (there[:, :2].max(axis=0) > lips[:2] + 5).all()
    # Its bottom points to the camera, before the lips.
    assert there[:, 2].min() < lips[2] - 80 and gone[:, 1].min() > lips[1] + 150


def test_whoever_comes_to_visit_is_another_one():
    assert all(other_than(name) != name and other_than(name) in PEOPLE for name in PEOPLE)


def test_one_takes_leaves_the_picture_to_three_sides_and_one_is_quick():
    shift = make_take("leaving").shift_mm
    assert shift[:, 0].max() > 450 and shift[:, 0].min() < -450 and shift[:, 1].max() > 380
    assert np.abs(shift[[0, -1]]).max() < 5
    yaw = np.rad2deg(make_take("shake").head_rad[:, 0])
    assert np.abs(np.diff(yaw)).max() * 240 > 400


def test_every_event_can_be_performed():
    for name, event in events("tomas").items():
        assert event.scenario.take in TAKE_NAMES and event.scenario.person == "tomas", name
        check_conditions(event.scenario.conditions)
    asked = {c for event in events("mara").values() for c in event.scenario.conditions}
    assert asked >= set(CONDITIONS) - set(LASTING)


def test_recovery_counts_frames_from_the_end_of_each_event():
    shares = np.array([0, 0, 0.5, 1, 0.4, 0, 0, 0, 1, 0, 0, 0.0])
    good = np.array([1, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1], bool)
    assert recoveries(shares, good).tolist() == [0.0, 2.0]
    # A film that ends before the face is found says nothing about it.
    assert recoveries(shares, good & (np.arange(12) < 8)).tolist() == [0.0]


def film_of(shares, off_px):
    """A film of a resting head, and states that are off by so much."""
    points = np.random.default_rng(1).normal(size=(77, 3)) * 40 + [0, 0, 600]
    still = Truth(points, np.array([1.0, 0, 0, 0]), np.zeros(3), np.zeros(46), np.zeros((2, 2)))
    blank = np.zeros((480, 640), np.uint8)
    rgb = np.zeros((480, 640, 3), np.uint8)
    frames = [Frame(rgb, blank, n / 30, n) for n in range(len(shares))]
    film = Filmed(frames, [still] * len(frames), CAMERA, np.array(shares))
    states = []
    for frame, off in zip(frames, off_px, strict=True):
        seen = project(CAMERA, points[:75]) + [off, 0]
        at_rest = resting_state("free")
        states.append(
            type(at_rest)(
                frame.time_s, at_rest.rotation_wxyz, np.zeros(3), at_rest.expression,
                at_rest.gaze_rad, points[:75], seen, 1.0, "free", False,
            )
        )  # fmt: skip
    return film, states


def test_errors_are_counted_apart_while_something_happens():
    shares = [0.0] * 25 + [1.0] * 10 + [0.0] * 10
    off = [1.0] * 25 + [9.0] * 10 + [FOUND_PX + 1] * 2 + [1.0] * 8
    lost, calm, during, worst, *rest = event_cells(*film_of(shares, off), 3)
    assert lost == 0 and during == pytest.approx(9) == worst
    assert calm == pytest.approx((13 * 1 + 2 * (FOUND_PX + 1)) / 15)
    assert rest[3:5] == [2.0, 2] and rest[-1] == 3


def test_leaving_lasts_as_long_as_a_landmark_is_outside():
    film, _ = film_of([0.0] * 2, [0.0] * 2)
    out = Truth(film.truths[0].points_mm + [400, 0, 0], *[film.truths[0].rotation_wxyz,
                film.truths[0].translation_mm, film.truths[0].expression,
                film.truths[0].gaze_rad])  # fmt: skip
    event = Event(Scenario("leaving"), None)
    assert _shares(event, film.frames, [film.truths[0], out], CAMERA).tolist() == [0.0, 1.0]
