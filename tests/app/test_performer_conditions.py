"""What the performer wears, holds and sits in; pictures need an offscreen OpenGL context."""

import numpy as np
import pytest

from app.avatars.build import Head
from app.avatars.wardrobe import Wardrobe, load_wardrobe
from app.performer import hand
from app.performer.conditions import DIM_SENSOR, check_conditions, dimmed, dimmed_room
from app.performer.events import CALM_S, ROUND_S, held_share
from app.performer.glasses import frame_and_lenses
from app.performer.growth import fringe
from app.performer.lights import LIGHTS
from app.performer.measured import MOTION_S, ONE_SIDED
from app.performer.microphone import microphone
from app.performer.opening import Scenario, open_performer
from app.performer.people import CAST, Person, load_person
from app.performer.props import lips_mm
from app.performer.sensor import SensorSettings
from app.performer.shapes import Solid, grid_triangles, joined, surface_of, tube, turned
from app.performer.takes import LIFELESS, make_take
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.face_model import FaceModel, load_face_model, shape_vertices
from core.landmarks import NAMES, SHAPE_NAMES
from core.records import FloatArray


@pytest.fixture(scope="module")
def model() -> FaceModel:
    return load_face_model(asset("face_model.npz"))


@pytest.fixture(scope="module")
def wardrobe(model) -> Wardrobe:
    return load_wardrobe(asset("."), model)


@pytest.fixture(scope="module", params=sorted(CAST))
def person(request, model) -> Person:
    return load_person(asset("people.npz"), model, request.param)


def volume_mm3(solid: Solid) -> float:
    a, b, c = (solid.points_mm[solid.triangles[:, k]] for k in range(3))
    return float(np.einsum("ti,ti->", a, np.cross(b, c)) / 6)


def landmark(model: FaceModel, person: Person, name: str) -> FloatArray:
    return person.neutral_mm[shape_vertices(model)[NAMES.index(name)]]


def test_the_surface_of_a_ball_is_closed_and_has_its_volume():
    axis = np.arange(-30.0, 31.0, 2.0)
    places = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    field = np.linalg.norm(places - [1.0, -2.0, 0.5], axis=-1) - 20
    ball = surface_of(field, np.full(3, -30.0), 2.0)
    # Positive only if the triangles are counter-clockwise from outside.
    assert volume_mm3(ball) == pytest.approx(4 / 3 * np.pi * 20**3, rel=0.02)
    edges = ball.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    there = {tuple(edge) for edge in edges.tolist()}
    assert len(there) == len(edges)
    assert there == {(b, a) for a, b in there}


def test_tubes_and_turned_bodies_have_their_volume():
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    circle = np.stack([20 * np.cos(turn), 20 * np.sin(turn), 0 * turn], axis=1)
    ring = tube(circle, 2.0, np.array([0.0, 0.0, 1.0]), closed=True, sides=24)
    assert volume_mm3(ring) == pytest.approx(np.pi * 4 * 2 * np.pi * 20, rel=0.03)
    can = turned(np.array([[1e-3, 0], [5.0, 1e-3], [5.0, 10.0], [1e-3, 10.001]]), sides=48)
    assert volume_mm3(can) == pytest.approx(np.pi * 25 * 10, rel=0.01)
    both = joined(ring, can)
    assert volume_mm3(both) == pytest.approx(volume_mm3(ring) + volume_mm3(can))


def test_a_grid_faces_the_viewer_when_columns_run_right_and_rows_up():
    x, y = np.meshgrid([0.0, 1.0, 2.0], [0.0, -1.0])
    points = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    for a, b, c in grid_triangles(2, 3):
        assert np.cross(points[b] - points[a], points[c] - points[a])[2] < 0


def test_glasses_sit_before_the_eyes_and_reach_the_ears(person, model):
    frame, lenses = frame_and_lenses(model, person.neutral_mm)
    for side in ("R", "L"):
        corners = [landmark(model, person, f"{side}_eye_{end}") for end in ("inner", "outer")]
        eye = np.mean(corners, axis=0)
        glass = lenses.points_mm[np.sign(lenses.points_mm[:, 0]) == np.sign(eye[0])]
        low, high = glass.min(axis=0), glass.max(axis=0)
        assert (low[:2] < np.min(corners, axis=0)[:2]).all()
        assert (high[:2] > np.max(corners, axis=0)[:2]).all()
        near = glass[np.linalg.norm(glass[:, :2] - eye[:2], axis=1) < 8]
        assert 6 < eye[2] - near[:, 2].mean() < 30
    assert frame.points_mm[:, 2].max() > 75
    off_center = frame.points_mm[:, 0].max() + frame.points_mm[:, 0].min()
    assert abs(off_center) < 8


def test_the_fringe_covers_the_brows_but_not_the_eyes(person, model, wardrobe):
    head = Head(model, person.neutral_mm, person.deltas_mm)
    hair, coverage = fringe(head, wardrobe)
    solid = hair.points_mm[coverage > 0.45]
    for name in ("R_brow_3", "L_brow_3", "R_brow_5"):
        point = landmark(model, person, name)
        over = solid[np.abs(solid[:, 0] - point[0]) < 6]
        assert over[:, 1].max() > point[1] - 4
        assert over[over[:, 1] > point[1] - 12, 2].min() < point[2]
    assert solid[:, 1].max() < landmark(model, person, "R_eye_lo_mid")[1]


def test_the_hand_is_away_at_first_then_lies_over_the_lips(person, model):
    solid, head = hand.hand_solid(), np.eye(4)
    head[2, 3] = 600.0
    lips = lips_mm(model, person)

    def place(time_s: float) -> FloatArray:
        matrix = hand.hand_to_camera(head, lips + hand.AT_LIPS_MM, held_share(time_s))
        return solid.points_mm @ matrix[:3, :3].T + matrix[:3, 3]

    assert place(0.0)[:, 1].min() > lips[1] + 150
    over = place(CALM_S + 1.0)
    near = over[np.linalg.norm(over[:, :2] - lips[:2], axis=1) < 12]
    assert len(near) > 20
    # It lies before the lips and touches them at most.
    assert (near[:, 2] - 600 < landmark(model, person, "lip_up_mid")[2] + 6).all()
    np.testing.assert_allclose(place(0.3), place(0.3 + ROUND_S), atol=1e-6)


def test_the_hand_is_of_a_hands_size():
    points = hand.hand_solid().points_mm
    fingers = points[points[:, 0] > -50]
    assert 165 < np.ptp(fingers[:, 0]) < 215
    assert 90 < np.ptp(fingers[:, 1]) < 145
    assert volume_mm3(hand.hand_solid()) > 0


def test_the_microphone_is_before_the_chin(person, model):
    grille, _ = microphone(lips_mm(model, person))
    low, high = grille.points_mm.min(axis=0), grille.points_mm.max(axis=0)
    chin = person.neutral_mm[shape_vertices(model)[60:75]][-1]
    assert low[0] < chin[0] < high[0]
    assert low[1] < chin[1] < high[1]
    assert high[2] < chin[2]


def test_dim_light_is_a_sixth_and_noisy():
    lights = LIGHTS["window"]
    assert dimmed(lights).colors.sum() / lights.colors.sum() == pytest.approx(0.165, abs=0.02)
    assert DIM_SENSOR.read_noise > 4 * SensorSettings().read_noise
    room = np.full((4, 4, 3), 200, np.uint8)
    assert 60 < dimmed_room(room).mean() < 110


def test_conditions_must_exist_and_come_once():
    check_conditions(("glasses", "dim"))
    with pytest.raises(ValueError, match=r"'hat'.*glasses, beard"):
        check_conditions(("hat",))
    with pytest.raises(ValueError, match="'dim' is given twice"):
        check_conditions(("dim", "beard", "dim"))


def test_head_motion_has_200_frames_and_stays_in_the_ranges_of_the_films():
    reached = np.zeros(3)
    for seed in range(12):
        take = make_take("head_motion", seed)
        assert int(take.duration_s * 30) == 200
        assert take.duration_s == pytest.approx(MOTION_S, abs=0.01)
        degrees = np.rad2deg(np.abs(take.head_rad)).max(axis=0)
        assert (degrees < [60, 31, 31]).all()
        # The films begin with a face that looks into the camera.
        assert np.rad2deg(np.abs(take.head_rad[:60])).max() < 3
        reached = np.maximum(reached, degrees)
    assert (reached > [50, 24, 24]).all()


def test_a_statue_does_not_move_at_all():
    take = make_take("statue")
    assert {"statue"} == LIFELESS
    for track in (take.expression, take.head_rad, take.shift_mm):
        assert np.ptp(track, axis=0).max() == 0


def test_every_asymmetric_face_has_unlike_sides():
    take = make_take("asymmetric")
    left = [b for b, name in enumerate(EXPRESSION_NAMES) if name.endswith("Left")]
    right = [EXPRESSION_NAMES.index(EXPRESSION_NAMES[b][:-4] + "Right") for b in left]
    unlike = np.abs(take.expression[:, left] - take.expression[:, right]).max(axis=1)
    assert np.mean(unlike > 0.5) > 0.4
    for name, face in ONE_SIDED.items():
        sides = {side for side in ("Left", "Right") for key in face if key.endswith(side)}
        assert sides, name


#: Where conditions must change the picture, and where they must not, by landmark.
SEEN = {
    ("beard",): (("chin_front",), ("R_eye_inner", "nose_tip")),
    ("fringe", "microphone"): (("R_forehead", "chin_front"), ("R_eye_inner", "nose_tip")),
    ("hand",): (("lip_lo_mid", "L_mouth_corner"), ("L_eye_inner", "L_brow_3")),
    ("dim",): (("nose_tip", "R_cheek"), ()),
}


@pytest.mark.gl
def test_each_condition_shows_where_it_belongs_and_nowhere_else():
    index = 66
    with open_performer(Scenario("statue")) as source:
        plain = source.picture(index).rgb.astype(float)
        pixels = dict(zip(SHAPE_NAMES, source.landmarks_px(index), strict=True))

    def change(conditions: tuple[str, ...]) -> FloatArray:
        with open_performer(Scenario("statue", conditions=conditions)) as source:
            np.testing.assert_array_equal(source.landmarks_px(index)[0], pixels[SHAPE_NAMES[0]])
            return np.abs(source.picture(index).rgb - plain).max(axis=2)

    for conditions, (shown, hidden) in SEEN.items():
        changed = change(conditions)
        for name in shown:
            assert np.median(_near(changed, pixels[name], 3)) > 12, (conditions, name)
        for name in hidden:
            assert np.median(_near(changed, pixels[name], 3)) < 12, (conditions, name)
    changed = change(("glasses",))
    # The rim is thin and dark, somewhere beside the corner of the eye.
    assert _near(changed, pixels["R_eye_outer"], 14).max() > 60
    assert _near(changed, pixels["lip_lo_mid"], 5).max() < 30


def _near(picture: FloatArray, point_px: FloatArray, reach: int) -> FloatArray:
    x, y = np.rint(point_px).astype(int)
    return picture[y - reach : y + reach + 1, x - reach : x + reach + 1]


@pytest.mark.gl
def test_conditions_can_be_combined_and_repeat_themselves():
    scenario = Scenario("talking", "tomas", conditions=("glasses", "beard", "dim"))
    pictures = []
    for _ in range(2):
        with open_performer(scenario) as source:
            assert source.name == "virtual performer (tomas, talking, glasses, beard, dim)"
            pictures.append(source.picture(9).rgb)
    np.testing.assert_array_equal(*pictures)
    assert 15 < pictures[0].mean() < 70


def test_an_unknown_condition_is_named():
    with pytest.raises(ValueError, match=r"'wig'.*fringe"):
        open_performer(Scenario(conditions=("wig",)))
