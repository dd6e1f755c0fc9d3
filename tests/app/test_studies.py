"""The studies on films whose landmarks are the truth, and one that is really watched."""

import argparse
import json
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from app.main import main
from app.performer.events import held_share
from app.performer.opening import Scenario, open_performer
from app.performer.people import load_person
from app.performer.takes import make_take
from app.performer.truth import Script
from app.resources import asset
from app.studies import bu, conditions, iterations, pose, solvers, still
from app.studies.bu_format import HeadTrackingDataError, films_in, read_truth
from app.studies.film import Film, Way, learned, track, tracker_for
from app.studies.measures import (
    MM_PER_INCH,
    coefficient_errors,
    errors_since_first,
    head_angles_deg,
    pose_errors,
    shake,
    since_first,
    wrapped_deg,
)
from app.studies.report import Column, Report, Table
from core.camera import camera_for, project
from core.face_model import load_face_model
from core.geometry import matrix_from_head_angles, matrix_from_quaternion, quaternion_from_matrix
from core.landmark_flow import Followed
from core.landmarks import N_INTERNAL, N_LANDMARKS
from core.records import Landmarks2D, Progress

CAMERA = camera_for((640, 480), 620.0)


@pytest.fixture(scope="module")
def models():
    """What the studies need when nobody looks at pictures."""
    return SimpleNamespace(face_model=load_face_model(asset("face_model.npz")))


@pytest.fixture(scope="module")
def filmed(models):
    """A function that films a performer without a picture: the landmarks are the true ones."""

    def film(take="head_motion", n=24, first=20, name="mara"):
        person = load_person(asset("people.npz"), models.face_model, name)
        script = Script(make_take(take), person, models.face_model, CAMERA.focal_px)
        times = np.arange(n) / 30
        truths = tuple(script.truth(float(time_s) + first / 30) for time_s in times)
        seen = tuple(seen_of(project(CAMERA, truth.points_mm)) for truth in truths)
        nothing = np.empty((0, N_INTERNAL, 2))
        return Film(take, (640, 480), 30.0, times, seen, truths, CAMERA, nothing)

    return film


def seen_of(points_px):
    """The outline slides over the face, so its landmarks are left out."""
    confidence = np.r_[np.ones(N_INTERNAL), np.zeros(N_LANDMARKS - N_INTERNAL)]
    landmarks = Landmarks2D(
        points_px[:N_LANDMARKS], np.zeros(N_LANDMARKS, bool), confidence, points_px[75:], np.ones(2)
    )
    return Followed(landmarks, None, True, 1.0)


@pytest.fixture
def performed(monkeypatch, filmed):
    """Makes studies film without pictures; returns the scenarios that they asked for."""
    asked = []

    def perform(scenario, models, most):
        asked.append(scenario)
        yield Progress(1, 1, "filming")
        return filmed(scenario.take, min(most, 24), name=scenario.person)

    for module in (pose, still, iterations, solvers, conditions):
        monkeypatch.setattr(module, "perform", perform)
    return asked


def report_of(module, models, *arguments):
    parser = argparse.ArgumentParser()
    module.add_options(parser)
    steps = module.run(parser.parse_args(list(arguments)), models)
    while True:
        try:
            assert isinstance(next(steps), Progress)
        except StopIteration as end:
            return end.value


def posed(rotation, place=(0.0, 0.0, 600.0), expression=()):
    return SimpleNamespace(
        rotation_wxyz=quaternion_from_matrix(rotation), translation_mm=np.array(place),
        expression=np.array(expression),
    )  # fmt: skip


def test_pose_errors_are_those_of_the_axes_that_differ():
    true = posed(matrix_from_head_angles(0.5, -0.2, 0.1))
    found = posed(matrix_from_head_angles(0.5, -0.2 + np.deg2rad(3), 0.1), (1.0, -2.0, 610.0))
    errors = pose_errors([found, true], [true, true])
    np.testing.assert_allclose(errors.degrees, [[0, 3, 0], [0, 0, 0]], atol=1e-9)
    np.testing.assert_allclose(errors.mm, [[1, -2, 10], [0, 0, 0]], atol=1e-9)


def test_angles_wrap_round():
    np.testing.assert_allclose(wrapped_deg(np.array([359.0, -181.0, 180.0])), [-1, 179, -180])


@pytest.mark.parametrize(("axis", "angles"), [(0, (0, 0, 0.3)), (1, (0, 0.3, 0)), (2, (0.3, 0, 0))])
def test_movement_since_the_first_frame_has_the_signs_of_head_angles(axis, angles):
    way = [posed(np.eye(3)), posed(matrix_from_head_angles(*angles))]
    moved = since_first(way)[1, :3]
    np.testing.assert_allclose(moved, head_angles_deg(way[1].rotation_wxyz), atol=1e-9)
    assert moved[axis] == pytest.approx(np.rad2deg(0.3))


def test_what_a_tracker_takes_for_straight_ahead_cancels_since_the_first_frame():
    tilted = matrix_from_head_angles(0.1, 0.2, -0.1)
    path = [matrix_from_head_angles(a, 0.3 * a, -a) for a in (0.0, 0.2, 0.5)]
    truth = [posed(turn, (10 * k, 0.0, 600.0)) for k, turn in enumerate(path)]
    found = [posed(tilted @ turn, (10 * k, 30.0, 700.0)) for k, turn in enumerate(path)]
    assert np.abs(pose_errors(found, truth).degrees).max() > 5
    errors = errors_since_first(found, truth)
    np.testing.assert_allclose(errors.degrees, 0, atol=1e-9)
    np.testing.assert_allclose(errors.mm, 0, atol=1e-9)


def test_shown_coefficients_are_counted_apart():
    truth = [posed(np.eye(3), expression=[0.0, 0.8, 0.1, 0.0])]
    found = [posed(np.eye(3), expression=[0.2, 0.5, 0.1, 0.1])]
    every, shown = coefficient_errors(found, truth)
    assert every == pytest.approx(0.15)
    assert shown == pytest.approx(0.3)


def test_slow_drift_is_no_shake(rng):
    slow = np.linspace(0, 5, 4000)
    noisy = slow + 0.2 * rng.normal(size=4000)
    np.testing.assert_allclose(shake(np.stack([slow, noisy], axis=1)), [0, 0.2], atol=0.01)


def test_a_table_is_told_to_people_and_to_programs():
    table = Table(
        "Errors", [Column("deg"), Column("lost")], {"here": [1.234, 3], "there": [None, 0]}
    )
    lines = table.text().splitlines()
    assert lines[0] == "Errors"
    assert [line.split() for line in lines[1:]] == [
        ["deg", "lost"], ["here", "1.23", "3"], ["there", "0"]
    ]  # fmt: skip
    assert len({len(line) for line in lines[1:]}) == 1
    report = Report("x", [table], ["a note"])
    assert report.text().endswith("\n\na note")
    assert report.values()["tables"] == {
        "Errors": {"here": {"deg": 1.234, "lost": 3}, "there": {"deg": None, "lost": 0}}
    }


def test_a_film_is_tracked_from_what_was_seen(filmed, models):
    film = filmed()
    states = track(film, models, Way(known_focal=True))
    assert [state.time_s for state in states] == film.times_s.tolist()
    assert not any(state.lost for state in states)
    again = track(film, models, Way(known_focal=True))
    np.testing.assert_array_equal(states[-1].rotation_wxyz, again[-1].rotation_wxyz)
    assert np.abs(pose_errors(states, film.truths).degrees).mean() < 3


def test_frames_without_a_face_are_lost(filmed, models):
    film = filmed(n=6)
    seen = (*film.seen[:3], None, *film.seen[4:])
    blind = Film("", film.size_px, 30.0, film.times_s, seen, film.truths, CAMERA, film.reference_px)
    lost = [state.lost for state in track(blind, models, Way())]
    assert lost == [False, False, False, True, False, False]


def test_the_focal_length_of_a_real_film_is_not_known(filmed, models):
    film = filmed(n=2)
    real = Film("x.avi", film.size_px, 30.0, film.times_s, film.seen, (), None, film.reference_px)
    with pytest.raises(ValueError, match=r"x\.avi is not known"):
        tracker_for(real, models, Way(known_focal=True))


def test_a_learned_face_is_not_the_mean_one(filmed, models):
    user = learned(filmed("mixed", 90), models)
    assert np.abs(user.neutral_mm - models.face_model.mean_mm).max() > 2


def test_pose_study_puts_our_errors_beside_the_published_ones(performed, models):
    report = report_of(pose, models, "--takes", "2", "--frames", "20")
    assert [(s.take, s.person, s.seed) for s in performed] == [
        ("head_motion", "mara", 0), ("head_motion", "tomas", 1)
    ]  # fmt: skip
    errors, each = report.tables
    assert set(pose.WAYS) < set(errors.rows)
    assert errors.rows["[FaceIt19] on BU"][:4] == [2.35, 3.62, 4.38, 3.45]
    assert errors.rows["[FaceIt19] on BU"][4] == pytest.approx(2.27 * MM_PER_INCH)
    ours = errors.rows["a recording"]
    assert ours[3] == pytest.approx(np.mean(ours[:3]))
    assert 0 < ours[3] < 6
    assert ours[7] == pytest.approx(ours[4] / MM_PER_INCH)
    assert len(each.rows) == 2
    assert "40 frames of 2 takes, 0 lost" in report.notes[0]


def test_heads_turned_too_far_do_not_count(filmed, models, monkeypatch):
    film = filmed(n=30, first=20)
    yaw = np.abs([head_angles_deg(t.rotation_wxyz)[2] for t in film.truths])
    monkeypatch.setattr(pose, "MOST_YAW_DEG", float(np.median(yaw)))
    found, moved, lost = pose.errors_of(film, models, Way())
    assert len(found.degrees) == len(moved.degrees) == 15
    assert lost == 0


def test_a_film_without_a_face_has_no_errors(filmed, models):
    film = filmed(n=3)
    blind = Film(
        "", film.size_px, 30.0, film.times_s, (None,) * 3, film.truths, CAMERA, film.reference_px
    )
    found, _, lost = pose.errors_of(blind, models, Way())
    assert pose.pose_cells(found) == [None] * len(pose.POSE_COLUMNS)
    assert lost == 3
    assert conditions.condition_rows("dim", blind, models)["dim"][:3] == [3, 3, None]
    assert still.still_cells(blind, models, Way())[-2:] == [None, 3]


def test_still_study_finds_no_noise_where_there_is_none(performed, models):
    report = report_of(still, models, "--people", "ayo", "--frames", "24")
    assert performed == [Scenario("statue", "ayo")]
    for table in report.tables:
        *noise, lost = table.rows["ayo"]
        assert lost == 0
        assert max(noise[:3]) < 0.02
        assert min(noise) >= 0


def test_iterations_study_varies_one_number_at_a_time(performed, models):
    report = report_of(iterations, models, "--frames", "10")
    assert [next(iter(table.rows)) for table in report.tables] == 2 * ["rho 1", "epsilon 1"]
    for table in report.tables:
        assert len(table.rows) == len(iterations.COUNTS)
        for cost_ms, degrees, *_ in table.rows.values():
            assert cost_ms > 0
            assert degrees < 12
    for rho, epsilon in (report.tables[:2], report.tables[2:]):
        # Both hold the pair that the paper chose, and it is the same one.
        assert rho.rows["rho 15"][1:] == epsilon.rows["epsilon 15"][1:]
    followed, anew = (report.tables[k].rows["rho 1"][5] for k in (0, 2))
    assert anew >= followed


def test_solvers_study_compares_errors_noise_and_time(performed, models):
    report = report_of(solvers, models, "--frames", "20")
    assert [scenario.take for scenario in performed] == ["mixed", "head_motion", "statue"]
    rows = report.tables[0].rows
    assert set(rows) == set(solvers.SOLVERS)
    names = [column.name for column in report.tables[0].columns]
    for row in rows.values():
        assert row[names.index("ms")] > 0
        assert row[names.index("landmarks px")] < 12
    assert rows["as used"][0] < 6


def test_conditions_study_has_a_row_for_each(performed, models):
    report = report_of(conditions, models, "--frames", "8", "--person", "tomas")
    rows = report.tables[0].rows
    assert {"plain", "asymmetric", "glasses", "beard", "fringe", "hand", "dim"} <= set(rows)
    assert {scenario.person for scenario in performed} == {"tomas"}
    assert ("hand",) in {scenario.conditions for scenario in performed}
    # The hand is away in the first second.
    assert rows.pop("hand, while it covers")[:3] == [0, 0, None]
    for frames, lost, network_px, landmarks_px, *_ in rows.values():
        assert (frames, lost) == (8, 0)
        assert network_px < 1e-6
        assert landmarks_px < 6


def test_a_hand_is_judged_apart_while_it_covers(filmed, models):
    film = filmed("talking", 80)
    rows = conditions.condition_rows("hand", film, models)
    assert rows["hand"][0] == 80
    covered = sum(held_share(float(time_s)) > 0.9 for time_s in film.times_s)
    assert rows["hand, while it covers"][0] == covered > 20


def bu_rows(truths):
    """What the database would say: a running number, inches, roll, yaw, pitch; in a mirror."""
    rows = [[-1.0, 0, 0, 0, 0, 0, 0]]
    for n, truth in enumerate(truths):
        x, y, z = truth.translation_mm / MM_PER_INCH
        m = matrix_from_quaternion(truth.rotation_wxyz)
        about_x = np.arctan2(-m[1, 2], m[2, 2])
        about_y, about_z = np.arcsin(m[0, 2]), np.arctan2(-m[0, 1], m[0, 0])
        rows.append([n, -x, y, z, *np.rad2deg([-about_z, -about_y, about_x])])
    return np.array(rows)


def test_the_sensor_file_is_read_in_our_axes_and_units(tmp_path, filmed):
    truths = filmed(n=12).truths
    np.savetxt(tmp_path / "jam1.dat", bu_rows(truths))
    read = read_truth(tmp_path / "jam1.dat", 12)
    for pose_read, truth in zip(read, truths, strict=True):
        np.testing.assert_allclose(pose_read.rotation_wxyz, truth.rotation_wxyz, atol=1e-9)
        np.testing.assert_allclose(pose_read.translation_mm, truth.translation_mm, atol=1e-9)


def test_rows_without_a_running_number_are_read_too(tmp_path):
    np.savetxt(tmp_path / "a.dat", [[1.0, 2.0, 3.0, 0.0, 12.0, 0.0]] * 3)
    read = read_truth(tmp_path / "a.dat", 3)
    assert len(read) == 3
    np.testing.assert_allclose(read[0].translation_mm, [-25.4, 50.8, 76.2])
    np.testing.assert_allclose(head_angles_deg(read[0].rotation_wxyz), [0, 0, 12], atol=1e-9)


@pytest.mark.parametrize(
    ("text", "n_frames", "found"),
    [
        ("1 2 3 4\n", 1, "1 rows of 4 numbers"),
        ("1 2 3 4 5 6\n" * 4, 200, "4 rows for a film of 200 frames"),
        ("x y z\n", 1, "could not convert"),
        ("1 2 3 4 5 nan\n", 1, "1 rows of 6 numbers"),
    ],
)
def test_a_sensor_file_of_something_else_is_refused(tmp_path, text, n_frames, found):
    path = tmp_path / "jam1.dat"
    path.write_text(text)
    with pytest.raises(HeadTrackingDataError, match=found) as caught:
        read_truth(path, n_frames)
    assert "roll yaw pitch" in str(caught.value)


def test_films_are_found_with_their_sensor_files(tmp_path):
    inside = tmp_path / "uniform-light"
    inside.mkdir()
    for name in ("ssm2.AVI", "ssm2.dat", "jam1.avi", "jam1.DAT", "notes.txt", "jam9.avi"):
        (inside / name).touch()
    found = [(film.name, table.name) for film, table in films_in(tmp_path)]
    assert found == [("jam1.avi", "jam1.DAT"), ("ssm2.AVI", "ssm2.dat")]


@pytest.mark.parametrize(
    ("names", "found"),
    [
        ([], r"no \.dat files"),
        (["jam1.dat"], r"1 \.dat files, none with a film"),
        (None, "no folder"),
    ],
)
def test_a_folder_of_another_layout_is_refused(tmp_path, names, found, capsys):
    folder = tmp_path / "bu"
    if names is not None:
        folder.mkdir()
        for name in names:
            (folder / name).touch()
    with pytest.raises(HeadTrackingDataError, match=found):
        films_in(folder)
    assert main(["study", "bu", str(folder)]) == 2
    assert "FOLDER/jam1.avi with FOLDER/jam1.dat" in capsys.readouterr().err


def test_axes_that_run_the_other_way_are_noticed(rng):
    found = rng.normal(size=(50, 6))
    true = found + 0.1 * rng.normal(size=(50, 6))
    true[:, 4] *= -1
    true[:, 5] = 0
    np.testing.assert_allclose(bu.axes_agree([(found, true)]), [1, 1, 1, 1, -1, 0], atol=0.05)


@pytest.mark.gl
def test_a_film_in_the_databases_format_is_watched_and_compared(tmp_path, capsys):
    """Every fourth frame of a take: the whole way from files to the table."""
    with open_performer(Scenario("head_motion", size_px=(320, 240), seed=3)) as source:
        indices = range(0, 96, 4)
        film = cv2.VideoWriter(
            str(tmp_path / "jam1.avi"), cv2.VideoWriter_fourcc(*"MJPG"), 30, (320, 240)
        )
        for index in indices:
            film.write(np.ascontiguousarray(source.picture(index).rgb[..., ::-1]))
        film.release()
        np.savetxt(tmp_path / "jam1.dat", bu_rows([source.truth(index) for index in indices]))
    assert main(["study", "bu", str(tmp_path), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    errors = report["tables"]["Mean absolute errors of the pose"]
    assert errors["here"]["mean deg"] < 4
    assert errors["here"]["x in"] < 0.8
    agreement = report["tables"]["How tracked and true movement agree (correlation over all films)"]
    assert all(value > 0.7 for value in agreement[""].values()), agreement
    assert "1 films, 0 frames lost" in report["notes"][0]
    assert len(report["notes"]) == 1


def test_a_study_must_be_named(capsys):
    with pytest.raises(SystemExit):
        main(["study"])
    assert "pose" not in capsys.readouterr().out
