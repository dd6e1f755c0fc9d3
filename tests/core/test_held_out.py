"""Facts about the errors on pictures that training did not see."""

import json
from functools import cache

import numpy as np
import pytest

from core import held_out
from core.camera import project
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.held_out import held_out_report
from core.held_out_pairs import HeldOutSettings, Measured
from core.landmarks import N_LANDMARKS
from core.records import SetupShapes, Shape3D
from core.regressor import Regression
from core.regressor_trainer import TrainSettings
from core.training_set import TrainingSetSettings
from tests.core.painted_user import CALM, painted_user
from tests.synthetic_face import SMALL, finish

N_PICTURES = 20
#: Every fifth from the third on.
HELD = [2, 7, 12, 17]
FEW = TrainingSetSettings(1, 2, 1, augmentation=CALM.augmentation)
TINY = TrainSettings(n_stages=1, n_ferns=4, n_numbers=8, points=SMALL.points)


@pytest.fixture(scope="module")
def user():
    return painted_user()


@pytest.fixture(scope="module")
def shapes(user):
    rng = np.random.default_rng(3)
    points, rotations = [], []
    for yaw in rng.permutation(np.linspace(-0.5, 0.5, N_PICTURES)):
        points.append(user.shape((*rng.uniform(-15, 15, 2), 600), (yaw, 0, 0)))
        rotations.append(quaternion_from_matrix(matrix_from_head_angles(yaw, 0, 0)))
    nothing = np.zeros(N_PICTURES)
    places = np.mean(points, axis=1)
    return SetupShapes(points, rotations, places, np.zeros((N_PICTURES, 46)), nothing)


@cache
def pictures_of(shapes):
    return [painted_user().skin.picture(points) for points in shapes.points_mm]


def report(user, shapes, training=(FEW, TINY), settings=None, seed=4):
    names = tuple(f"frame_{n:05d}" for n in range(N_PICTURES))
    pictures = Measured(names, tuple(pictures_of(shapes)), user.camera, shapes)
    rng = np.random.default_rng(seed)
    return finish(held_out_report(pictures, rng, training, settings or HeldOutSettings()))


class Oracle:
    """In place of a regressor: finds the truth of each picture, moved by some error."""

    def __init__(self, shapes, error_mm):
        self.shapes, self.error_mm, self.starts = shapes, error_mm, []

    def __call__(self, regressor, camera):
        return self

    def run(self, gray, start_mm):
        picture = next(n for n, one in enumerate(pictures_of(self.shapes)) if one is gray)
        self.starts.append((picture, start_mm))
        return Shape3D(self.shapes.points_mm[picture] + self.error_mm(picture), 0.0, 0.0)


def told(user, shapes, monkeypatch, error_mm, settings=None):
    oracle = Oracle(shapes, error_mm)
    monkeypatch.setattr(held_out, "Regression", oracle)
    return report(user, shapes, settings=settings)[0], oracle


def test_a_perfect_regressor_makes_no_error(user, shapes, monkeypatch):
    found, _ = told(user, shapes, monkeypatch, lambda picture: 0.0)
    assert found["mean_rmse_px"] < 1e-9 and found["mean_percent_of_eye_distance"] < 1e-9
    assert set(found["share_under_px"].values()) == {1.0}
    assert max(found["mean_turn_deg"].values()) < 1e-4
    assert found["pictures"] == 4 and found["tries"] == 20


def test_a_known_error_is_reported_in_pixels_of_pictures_640_wide(user, shapes, monkeypatch):
    found, _ = told(user, shapes, monkeypatch, lambda picture: [8.0, 0, 0])
    true_px = [project(user.camera, shapes.points_mm[n, :N_LANDMARKS]) for n in HELD]
    moved = [project(user.camera, shapes.points_mm[n, :N_LANDMARKS] + [8.0, 0, 0]) for n in HELD]
    miss = np.linalg.norm(np.array(moved) - true_px, axis=2)
    expected = 640 / 240 * np.sqrt(np.mean(miss**2, axis=1)).mean()
    assert found["mean_rmse_px"] == pytest.approx(expected)
    assert found["share_under_px"] == {"3": 0.0, "4.5": 0.0, "6": 0.0}
    # A face moved sideways is not turned; 8 mm are about a twelfth of the outer eye corners.
    assert max(found["mean_turn_deg"].values()) < 1e-4
    assert 7 < found["mean_percent_of_eye_distance"] < 12


def test_a_turned_result_is_told_by_its_angle(user, shapes, monkeypatch):
    def error(picture):
        centred = shapes.points_mm[picture] - shapes.points_mm[picture].mean(axis=0)
        return centred @ matrix_from_head_angles(np.deg2rad(3.0), 0, 0).T - centred

    turn = told(user, shapes, monkeypatch, error)[0]["mean_turn_deg"]
    assert turn["yaw"] == pytest.approx(3.0, abs=0.01)
    assert max(turn["pitch"], turn["roll"]) < 0.01


def test_the_worst_pictures_come_first(user, shapes, monkeypatch):
    size_mm = {2: 1.0, 7: 4.0, 12: 2.0, 17: 3.0}
    found, _ = told(user, shapes, monkeypatch, lambda picture: [size_mm[picture], 0, 0])
    assert [one["picture"] for one in found["worst_pictures"]] == [7, 17, 12, 2]
    errors = [one["mean_rmse_px"] for one in found["worst_pictures"]]
    assert errors == sorted(errors, reverse=True) and errors[0] > 3 * errors[-1]


def test_at_most_five_worst_pictures_are_named(user, shapes, monkeypatch):
    found, _ = told(
        user, shapes, monkeypatch, lambda picture: [picture, 0, 0], HeldOutSettings(2, 1)
    )
    assert found["pictures"] == 10
    assert [one["picture"] for one in found["worst_pictures"]] == [19, 17, 15, 13, 11]


def test_the_bins_of_yaw_hold_every_try_once(user, shapes, monkeypatch):
    found, _ = told(user, shapes, monkeypatch, lambda picture: 0.0)
    angles = {
        n: abs(np.rad2deg(2 * np.arctan2(q[2], q[0]))) for n, q in enumerate(shapes.rotations_wxyz)
    }
    frontal = sum(angles[n] < 15 for n in HELD)
    assert 0 < frontal < 4
    tries = {name: part["tries"] for name, part in found["by_yaw"].items()}
    assert tries == {"0-15 deg": 5 * frontal, "15-40 deg": 20 - 5 * frontal}


def test_starts_are_other_pictures_shapes_moved_to_the_face(user, shapes, monkeypatch):
    exact = HeldOutSettings(starts=1, shift_mm=0.0, turn_rad=0.0)
    _, oracle = told(user, shapes, monkeypatch, lambda picture: 0.0, exact)
    assert [picture for picture, _ in oracle.starts] == HELD
    kept = [n for n in range(N_PICTURES) if n not in HELD]
    centred = shapes.points_mm[kept] - shapes.points_mm[kept].mean(axis=1, keepdims=True)
    for picture, start in oracle.starts:
        middle = shapes.points_mm[picture].mean(axis=0)
        assert np.allclose(start.mean(axis=0), middle)
        distance = np.abs(centred - (start - middle)).max(axis=(1, 2))
        assert distance.min() < 1e-9


def test_starts_are_disturbed_as_far_as_told(user, shapes, monkeypatch):
    settings = HeldOutSettings(every=2, starts=8, shift_mm=6.0, turn_rad=0.0)
    _, oracle = told(user, shapes, monkeypatch, lambda picture: 0.0, settings)
    shifts = [
        start.mean(axis=0) - shapes.points_mm[picture].mean(axis=0)
        for picture, start in oracle.starts
    ]
    assert 4.5 < np.std(shifts) < 7.5


def test_a_trained_regressor_beats_its_starts_and_the_report_is_plain(user, shapes, monkeypatch):
    starts_px = []

    class Watched(Regression):
        def run(self, gray, start_mm):
            miss = np.linalg.norm(start_mm - nearest(start_mm), axis=1)
            starts_px.append(np.sqrt(np.mean(miss**2)))
            return super().run(gray, start_mm)

    def nearest(start_mm):
        middles = shapes.points_mm[HELD].mean(axis=1)
        held = np.linalg.norm(middles - start_mm.mean(axis=0), axis=1).argmin()
        return shapes.points_mm[HELD[held]]

    monkeypatch.setattr(held_out, "Regression", Watched)
    found, progress = report(user, shapes, (CALM, SMALL))
    # 1 mm at 600 mm is about a pixel at 640 px width.
    assert found["mean_rmse_px"] < 0.5 * np.mean(starts_px)
    assert json.loads(json.dumps(found)) == found
    assert [one.done for one in progress] == [0, 1, 2, 3, 4] and progress[-1].total == 4


def test_the_same_seed_gives_the_same_report(user, shapes):
    assert report(user, shapes)[0] == report(user, shapes)[0]


def test_errors_are_told_by_expression_and_by_picture(user, shapes, monkeypatch):
    oracle = Oracle(shapes, lambda picture: [8.0 if picture == 2 else 2.0, 0, 0])
    monkeypatch.setattr(held_out, "Regression", oracle)
    monkeypatch.setattr(held_out, "held_out_rows", lambda names, every: HELD)
    names = [f"frame_{n}" for n in range(N_PICTURES)]
    names[2], names[7], names[12] = "smile_yaw+0", "glasses~smile_yaw+30", "pose_yaw+0"
    pictures = Measured(tuple(names), tuple(pictures_of(shapes)), user.camera, shapes)
    steps = held_out_report(pictures, np.random.default_rng(4), (FEW, TINY), HeldOutSettings())
    found = finish(steps)[0]
    told = {one["name"]: one["rmse_px"] for one in found["by_picture"]}
    assert list(told) == ["smile_yaw+0", "glasses~smile_yaw+30", "pose_yaw+0", "frame_17"]
    tries = {face: part["tries"] for face, part in found["by_expression"].items()}
    assert tries == {"smile": 10, "neutral": 5}
    smile = found["by_expression"]["smile"]["median_rmse_px"]
    assert told["glasses~smile_yaw+30"] < smile < told["smile_yaw+0"]


def test_the_error_after_each_stage_is_told_of_trained_and_of_held_out_pictures(user, shapes):
    found, progress = report(user, shapes, (CALM, SMALL))
    stages = found["stages"]
    assert set(stages) == {"training_px", "held_out_px"}
    for key, errors in stages.items():
        assert errors == [one.plot[key] for one in progress]
        assert len(errors) == 5 and errors[-1] < 0.5 * errors[0]
    # Starts are drawn alike, so both begin alike.
    assert 0.6 < stages["training_px"][0] / stages["held_out_px"][0] < 1.7
