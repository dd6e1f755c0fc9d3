"""The virtual performer's timing, takes, webcam and truth; pictures are in test_performer_film."""

import numpy as np
import pytest

from app.performer import acts
from app.performer.curves import blinks, minimum_jerk, pulse, saccades, through, wander
from app.performer.pacing import Pacer
from app.performer.people import CAST, load_person
from app.performer.posture import SKULL_JOINT_MM, posture_of
from app.performer.prompts import setup_take
from app.performer.room import paint_room
from app.performer.sensor import Sensor, SensorSettings
from app.performer.takes import TAKES, Moment, eyes_towards, make_take
from app.performer.truth import Script
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.face_model import FaceModel, load_face_model, shape_vertices
from core.geometry import matrix_from_head_angles, matrix_from_quaternion
from core.setup_plan import SHOTS

TIMES_S = acts.grid(6.0)


@pytest.fixture(scope="module")
def model() -> FaceModel:
    return load_face_model(asset("face_model.npz"))


def test_minimum_jerk_starts_and_ends_at_rest():
    share = np.linspace(0, 1, 10_001)
    way = minimum_jerk(share)
    speed, jolt = np.gradient(way, share), np.gradient(np.gradient(way, share), share)
    assert (way[0], way[-1]) == (0, 1)
    assert np.abs(speed[[0, -1]]).max() < 1e-6
    assert np.abs(jolt[[0, -1]]).max() < 0.02
    assert speed.max() == pytest.approx(1.875, abs=1e-4)


def test_path_reaches_each_pose_and_holds_equal_ones():
    poses = np.array([[0.0], [2.0], [2.0], [-1.0]])
    path = through(TIMES_S, np.array([0.5, 1.5, 3.0, 4.0]), poses)[:, 0]
    at = {time: path[round(time * acts.RATE_HZ)] for time in (0.0, 1.5, 2.0, 3.0, 5.0)}
    assert at == pytest.approx({0.0: 0, 1.5: 2, 2.0: 2, 3.0: 2, 5.0: -1})


def test_pulse_is_full_while_held():
    level = pulse(TIMES_S, 1.0, 0.5, 1.0, 0.25)
    assert level[TIMES_S <= 1].max() == 0
    assert level[(TIMES_S >= 1.5) & (TIMES_S <= 2.5)].min() == 1
    assert np.abs(level[TIMES_S >= 2.75]).max() < 1e-12


def test_wandering_comes_back(rng):
    drift = wander(TIMES_S, rng, np.array([2.9, 1.3]))
    assert drift[0] == pytest.approx(drift[-1], abs=1e-9)
    assert 0.3 < np.ptp(drift) < 5


def test_blinks_shut_the_lids_and_leave_them_open_most_of_the_time(rng):
    lids = blinks(acts.grid(60.0), rng, 3.0)
    starts = np.flatnonzero((lids[1:] > 0.5) & (lids[:-1] <= 0.5))
    assert 12 <= len(starts) <= 30
    assert lids.max() <= 1
    assert np.mean(lids > 0.1) < 0.15
    assert lids[0] == lids[-1] == 0


def test_eyes_jump_instead_of_gliding(rng):
    gaze = saccades(acts.grid(30.0), rng, np.deg2rad([9.0, 5.0]))
    speed = np.linalg.norm(np.diff(gaze, axis=0), axis=1) * acts.RATE_HZ
    assert np.mean(speed < 1e-9) > 0.85
    assert np.rad2deg(speed.max()) > 100


@pytest.mark.parametrize("name", sorted(TAKES))
def test_takes_are_smooth_bounded_and_can_be_looped(name):
    take = make_take(name)
    assert take.expression.min() >= 0
    assert take.expression.max() <= 1
    # A blink closes in 75 ms: at 240 Hz, no coefficient may move on faster than that.
    assert np.abs(np.diff(take.expression, axis=0)).max() < 0.12
    # People shake their heads at up to about 700 degrees per second; nothing else is as quick.
    most = 700 if name == "shake" else 400
    assert np.rad2deg(np.abs(np.diff(take.head_rad, axis=0)).max()) * acts.RATE_HZ < most
    for track in (take.expression, take.head_rad, take.shift_mm, take.gaze_rad):
        np.testing.assert_allclose(track[0], track[-1], atol=1e-9)


def test_the_seed_decides_a_take():
    first, same, other = (make_take("mixed", seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.expression, same.expression)
    np.testing.assert_array_equal(first.gaze_rad, same.gaze_rad)
    n = min(len(first.head_rad), len(other.head_rad))
    assert np.abs(first.head_rad[:n] - other.head_rad[:n]).max() > 0.05


def test_head_turns_reach_their_ranges():
    take = make_take("head_turns")
    low, high = np.rad2deg(take.head_rad.min(axis=0)), np.rad2deg(take.head_rad.max(axis=0))
    assert low == pytest.approx([-60, -30, -30], abs=5)
    assert high == pytest.approx([60, 30, 30], abs=5)
    assert np.ptp(take.shift_mm[:, 2]) > 300


def test_expressions_use_every_coefficient():
    used = make_take("expressions").expression.max(axis=0)
    quiet = [name for name, level in zip(EXPRESSION_NAMES, used, strict=True) if level < 0.25]
    assert quiet == []


def test_an_unknown_take_is_named():
    with pytest.raises(ValueError, match=r"'waltz'.*talking"):
        make_take("waltz")


def test_no_act_closes_lips_further_than_the_jaw_opens():
    jaw, close = (EXPRESSION_NAMES.index(n) for n in ("jawOpen", "mouthClose"))
    for name in TAKES:
        take = make_take(name)
        assert (take.expression[:, close] - take.expression[:, jaw]).max() < 0.03


def test_the_eyes_stay_on_the_camera_while_the_head_turns_a_little():
    head = np.deg2rad([[10.0, -5.0, 8.0]])
    gaze = eyes_towards(np.zeros((1, 2)), head)[0].mean(axis=0)
    direction = matrix_from_head_angles(*head[0]) @ -matrix_from_head_angles(*gaze, 0.0)[:, 2]
    # The soft limit of the eyes' travel takes away a little.
    assert np.rad2deg(np.arccos(-direction[2])) < 1.5


def test_a_take_is_interpolated_between_its_samples():
    take = make_take("head_turns")
    between = take.at(100.5 / acts.RATE_HZ)
    np.testing.assert_allclose(between.head_rad, take.head_rad[100:102].mean(axis=0))
    np.testing.assert_array_equal(take.at(-1.0).head_rad, take.head_rad[0])
    np.testing.assert_array_equal(take.at(1e6).head_rad, take.head_rad[-1])


def test_the_prompts_are_followed_imprecisely():
    session = setup_take()
    assert session.names == tuple(shot.name for shot in SHOTS)
    moments = [session.take.at(time) for time in session.times_s]
    asked = np.array([[shot.yaw, shot.pitch, shot.roll] for shot in SHOTS])
    off = np.rad2deg(np.array([m.head_rad for m in moments]) - asked)
    assert 1.5 < off.std() < 4.5
    ratio = [
        m.expression[b] / shot.standard[b]
        for m, shot in zip(moments, SHOTS, strict=True)
        for b in np.flatnonzero(shot.standard > 0.5)
    ]
    assert 0.75 < np.mean(ratio) < 0.95
    assert np.std(ratio) > 0.05


def test_a_prompted_pose_is_held_still_while_its_picture_is_taken():
    session = setup_take()
    for time in session.times_s[::7]:
        before, after = session.take.at(time - 0.1), session.take.at(time + 0.1)
        assert np.rad2deg(np.abs(after.head_rad - before.head_rad).max()) < 0.6
        assert np.abs(after.expression - before.expression).max() < 0.06


def test_the_sensor_repeats_itself_and_its_noise_grows_with_light():
    flat = np.full((120, 160, 3), 30, np.uint8)
    flat[:, 80:] = 200
    sensor = Sensor((160, 120), SensorSettings(jpeg_quality=100, flicker=0.0), seed=4)
    again = Sensor((160, 120), SensorSettings(jpeg_quality=100, flicker=0.0), seed=4)
    picture = sensor.develop(flat, 0.3, 9)
    np.testing.assert_array_equal(picture, again.develop(flat, 0.3, 9))
    assert np.any(picture != sensor.develop(flat, 0.3, 10))
    dark, bright = picture[10:110, 10:70].std(), picture[10:110, 90:150].std()
    assert 0.5 < dark < bright < 4
    assert abs(float(picture[:, 90:150].mean()) - 200) < 1


def test_the_lens_softens_an_edge_without_moving_it():
    edge = np.zeros((60, 200, 3), np.uint8)
    edge[:, 100:] = 180
    quiet = SensorSettings(read_noise=0.0, shot_noise=0.0, flicker=0.0, jpeg_quality=100)
    soft = Sensor((200, 60), quiet, seed=0).develop(edge, 0.0, 0)[30, :, 1].astype(float)
    assert np.abs(np.diff(soft)).max() < 170
    assert 99 < np.interp(90.0, soft[95:105], np.arange(95, 105)) < 100


def test_the_room_depends_on_its_seed():
    first, again, other = (paint_room((160, 120), seed) for seed in (1, 1, 2))
    assert first.shape == (120, 160, 3)
    np.testing.assert_array_equal(first, again)
    assert np.mean(first != other) > 0.5
    assert first.std() > 20


def test_a_live_source_waits_for_the_next_frame_and_leaves_missed_ones_out():
    now = [10.0]

    def sleep(duration_s: float) -> None:
        now[0] += duration_s

    pacer = Pacer(30.0, lambda: now[0], sleep)
    assert [pacer.next_index() for _ in range(3)] == [0, 1, 2]
    assert now[0] == pytest.approx(10 + 2 / 30)
    now[0] = 10.5
    assert [pacer.next_index() for _ in range(2)] == [15, 16]


def test_a_turning_head_stays_on_its_neck():
    moment = Moment(np.zeros(46), np.deg2rad([30.0, 10.0, -12.0]), np.zeros(3), np.zeros((2, 2)))
    posture = posture_of(moment, np.array([0.0, 0.0, 600.0]))
    joint = np.append(SKULL_JOINT_MM, 1.0)
    on_head, on_body = posture.head_to_camera @ joint, posture.body_to_camera @ joint
    np.testing.assert_allclose(on_head, on_body, atol=1e-9)
    rotation = matrix_from_quaternion(posture.rotation_wxyz)
    np.testing.assert_allclose(rotation, posture.head_to_camera[:3, :3], atol=1e-12)


@pytest.mark.parametrize("name", sorted(CAST))
def test_nobody_in_the_cast_is_in_the_span_of_the_model(name, model):
    person = load_person(asset("people.npz"), model, name)
    rows = shape_vertices(model)
    modes = model.identity_modes_mm[:, rows].reshape(model.n_identities, -1).astype(float)
    face = (person.neutral_mm - model.mean_mm)[rows]
    # The best weights that a fit to all vertices finds: see how far the landmarks stay off.
    dense = model.identity_modes_mm.reshape(model.n_identities, -1).astype(float)
    weights = np.linalg.lstsq(dense.T, (person.neutral_mm - model.mean_mm).ravel(), rcond=None)[0]
    left = face - (weights @ modes).reshape(face.shape)
    assert 0.4 < np.sqrt(np.mean(np.sum(left**2, axis=1))) < 2.5
    assert np.abs(person.neutral_mm[model.eye_center_vertices].mean(axis=0)).max() < 1e-9


def test_nobody_else_can_be_cast(model):
    with pytest.raises(ValueError, match=r"'nobody'.*mara"):
        load_person(asset("people.npz"), model, "nobody")


def test_truth_is_the_person_posed(model):
    person = load_person(asset("people.npz"), model, "mara")
    take = make_take("mixed")
    script = Script(take, person, model, 620.0)
    truth = script.truth(4.0)
    rotation = matrix_from_quaternion(truth.rotation_wxyz)
    back = (truth.points_mm - truth.translation_mm) @ rotation
    shape = person.neutral_mm + np.tensordot(truth.expression, person.deltas_mm, axes=1)
    np.testing.assert_allclose(back[:75], shape[shape_vertices(model)], atol=1e-6)
    centers = person.neutral_mm[model.eye_center_vertices]
    sight = (back[75:] - centers) / np.linalg.norm(back[75:] - centers, axis=1, keepdims=True)
    yaw = np.arctan2(sight[:, 0], -sight[:, 2])
    np.testing.assert_allclose(yaw, truth.gaze_rad[:, 0], atol=1e-6)
    np.testing.assert_allclose(np.arcsin(-sight[:, 1]), truth.gaze_rad[:, 1], atol=1e-6)


@pytest.mark.parametrize("name", sorted(CAST))
def test_changed_shapes_still_shut_eyes_and_lips(name, model):
    person = load_person(asset("people.npz"), model, name)
    with np.load(asset("people.npz")) as data:
        plain = data["deltas_mm"][CAST[name].row].astype(np.float32)
    before, after = (np.linalg.norm(d, axis=2) for d in (plain, person.deltas_mm))
    every = np.where(before > 1, after / before.clip(1e-9), np.nan)
    shapes = ("eyeBlinkLeft", "jawOpen", "mouthClose", "mouthSmileLeft")
    ratio = {shape: every[EXPRESSION_NAMES.index(shape)] for shape in shapes}
    assert np.nanmax(np.abs(ratio["eyeBlinkLeft"] - 1)) < 1e-5
    both = np.isfinite(ratio["jawOpen"]) & np.isfinite(ratio["mouthClose"])
    assert both.sum() > 20
    np.testing.assert_allclose(ratio["jawOpen"][both], ratio["mouthClose"][both], rtol=1e-4)
    assert np.nanmax(np.abs(ratio["mouthSmileLeft"] - 1)) > 0.03
