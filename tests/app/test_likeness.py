"""The user's own skin and colours, from pictures of a person whose looks are known."""

import time
from dataclasses import dataclass

import cv2
import numpy as np
import pytest

from app.avatars.complexion import skin_texture
from app.avatars.gallery import Gallery
from app.avatars.likeness.atlas import make_atlas
from app.avatars.likeness.blend import blurred
from app.avatars.likeness.choice import choose, head_angles_deg, sharpness
from app.avatars.likeness.glasses import without_rims
from app.avatars.likeness.ground import Pictures, lay_ground, window
from app.avatars.likeness.light import RoomLight, basis, room_light
from app.avatars.likeness.make import make_likeness
from app.avatars.likeness.surroundings import Surroundings, at_vertices
from app.avatars.likeness.tone import light_of_skin
from app.avatars.likeness.views import View, displayed, posed, scene_light, view_of
from app.avatars.looks import LOOKS, linear
from app.avatars.painter import AvatarPainter, AvatarWish
from app.avatars.views import overlay
from app.performer.lights import LIGHTS
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.blendshapes import user_blendshapes
from core.camera import camera_for, project
from core.face_model import load_face_model, neutral_mm
from core.geometry import matrix_from_head_angles, matrix_from_quaternion, quaternion_from_matrix
from core.kernels.raster import cover
from core.landmarks import N_LANDMARKS
from core.records import Landmarks2D, ModelFit, SetupShapes
from tests.app.gl import renderer_or_skip

MAPS = asset("textures") / "skin"
PLACE_MM = np.array([0.0, -20, 560])
#: Yaw, pitch in degrees of the pictures; in the last the eyes are shut.
ANGLES_DEG = (
    (0, 0), (-28, 0), (28, 0), (-9, 4), (10, -4), (-48, 0), (48, 0), (0, 13), (0, -13), (4, 2),
    (-4, -3), (14, 3), (0, 0),
)  # fmt: skip
LOOKS_OF_HER = LOOKS["olive"].changed(freckles=0.7, brow_density=1.0, hair=(120, 70, 40))


def done(steps):
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


@dataclass
class Session:
    """A person in front of a camera, and all that a profile knows of her."""

    pictures: Pictures
    skin: np.ndarray  # what her skin's texture really is


def film(model, gallery, light, *, looks=LOOKS_OF_HER):
    camera = camera_for((480, 400), 470.0)
    identity = np.zeros(model.n_identities)
    identity[:3] = (0.7, -0.8, 0.5)
    avatar = gallery.of_identity(identity, looks, "her")
    renderer = renderer_or_skip()
    painter = AvatarPainter(renderer, LIGHTS[light])
    images, marks, turns, weights = [], [], [], []
    blink = np.array([name.startswith("eyeBlink") for name in EXPRESSION_NAMES], float)
    for number, angles in enumerate(ANGLES_DEG):
        turn = quaternion_from_matrix(matrix_from_head_angles(*np.deg2rad(angles), 0.0))
        expression = blink if number == len(ANGLES_DEG) - 1 else 0 * blink
        framing = overlay(avatar, camera, turn, PLACE_MM)
        picture = painter.draw(AvatarWish(avatar, framing, expression, np.zeros((2, 2))))
        images.append(np.ascontiguousarray(picture[..., :3]))
        turns.append(turn)
        weights.append(expression)
        marks.append(landmarks(model, identity, turn, camera))
    renderer.release()
    count = len(images)
    places = np.tile(PLACE_MM, (count, 1))
    shapes = SetupShapes(
        np.zeros((count, 77, 3)), np.array(turns), places, np.array(weights), np.ones(count)
    )
    fit = ModelFit(
        identity, np.array(weights), np.array(turns), places,
        np.zeros((count, N_LANDMARKS), int), np.ones(count),
    )  # fmt: skip
    user = user_blendshapes(model, fit)
    return Session(Pictures(images, marks, shapes, camera, user), skin_texture(MAPS, looks, 1536))


def landmarks(model, identity, turn, camera):
    face = neutral_mm(model, identity) @ matrix_from_quaternion(turn).T + PLACE_MM
    points = np.zeros((N_LANDMARKS, 2))
    points[:60] = project(camera, face[model.landmark_vertices])
    points[60:] = points[:60].mean(axis=0)
    pupils = project(camera, face[model.eye_center_vertices] - [0, 0, 15])
    sure = np.where(np.arange(N_LANDMARKS) < 60, 1.0, 0.0)
    return Landmarks2D(points, np.zeros(N_LANDMARKS, bool), sure, pupils, np.ones(2))


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


@pytest.fixture(scope="module")
def gallery(model):
    return Gallery(asset("."), model)


@pytest.fixture(scope="module")
def ground(model):
    return lay_ground(model, MAPS)


@pytest.fixture(scope="module")
def sessions(model, gallery):
    return {light: film(model, gallery, light) for light in ("window", "lamp_left")}


@pytest.fixture(scope="module")
def likenesses(model, sessions):
    return {
        light: done(make_likeness(model, session.pictures, MAPS))
        for light, session in sessions.items()
    }


def albedo_of(ground, texture):
    return np.square(ground.atlas.gathered(texture[..., :3]) / 255)


def face_of(ground):
    """Return texels that every frontal picture shows."""
    return ground.plain & (ground.window > 0.9) & (ground.near_hair < 0.1)


@pytest.mark.gl
@pytest.mark.parametrize("light", ["window", "lamp_left"])
def test_own_skin_is_nearer_to_the_pictures_than_painted_skin(likenesses, light):
    found = likenesses[light]
    assert found.skin is not None
    assert found.skin.shape == (1536, 1536, 4)
    assert found.report["own_levels"] < 0.9 * found.report["painted_levels"]
    assert found.report["cover"] > 0.5


@pytest.mark.gl
def test_own_skin_has_the_detail_of_the_true_skin(ground, sessions, likenesses):
    """Freckles and blotches are where they are in truth; painted skin has others."""
    face = face_of(ground)
    ones = np.ones(len(face), np.float32)

    def detail(texture):
        albedo = albedo_of(ground, texture)
        return (albedo / blurred(albedo, ones, ground.atlas, 14.0) - 1).mean(axis=1)[face]

    truth = detail(sessions["window"].skin)
    own = np.corrcoef(truth, detail(likenesses["window"].skin))[0, 1]
    other = skin_texture(MAPS, likenesses["window"].looks, 1536)[:, ::-1]
    painted = np.corrcoef(truth, detail(np.ascontiguousarray(other)))[0, 1]
    assert own > 0.3
    assert own > painted + 0.2


@pytest.mark.gl
def test_the_light_of_the_pictures_is_divided_out(ground, sessions, likenesses):
    """A lamp at one side makes one half of the pictures darker, but not of the skin."""
    face = face_of(ground)
    mean = ground.model.mean_mm.astype(float)
    left = ground.atlas.at_texels(mean)[:, 0] > 0

    def sides(values):
        return np.log(values[face & left].mean() / values[face & ~left].mean())

    session = sessions["lamp_left"].pictures
    head = session.head(ground.model, 0)
    seen = view_of(session.images[0], head, session.camera, ground.atlas, ground.model)
    in_picture = sides(seen.light.mean(axis=1))
    on_skin = sides(albedo_of(ground, likenesses["lamp_left"].skin).mean(axis=1))
    assert abs(in_picture) > 0.5
    assert abs(on_skin) < 0.3 * abs(in_picture)


@pytest.mark.gl
def test_skin_hair_and_eyes_have_their_colours(likenesses):
    looks = likenesses["window"].looks
    for name, most in (("skin", 28), ("hair", 45), ("iris", 60)):
        truth = np.array(getattr(LOOKS_OF_HER, name), float)
        assert np.abs(np.array(getattr(looks, name)) - truth).max() < most, name
    assert looks.hair_style == "short"


@pytest.mark.gl
def test_the_texture_has_no_seam_at_the_edge_of_what_was_seen(model, likenesses):
    """Across edges of triangles, colour changes no more where skins meet than in painted skin."""
    small = make_atlas(model, 1536)
    texture = likenesses["window"].skin
    color = small.gathered(texture[..., :3])
    values, area = at_vertices(small, color, np.ones(len(color), np.float32))
    opened = window(model.mean_mm)
    triangles = model.triangles[model.part_triangles("skin")]
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    pairs = np.unique(pairs, axis=0)
    pairs = pairs[(area[pairs] > 0).all(axis=1)]
    steps = np.abs(np.diff(values[pairs], axis=1)[:, 0]).max(axis=1)
    steps /= np.maximum(np.linalg.norm(np.diff(model.mean_mm[pairs], axis=1)[:, 0], axis=1), 1.0)
    share = opened[pairs].mean(axis=1)
    edge, far = (share > 0.05) & (share < 0.95), share == 0
    below = model.mean_mm[pairs, 1].mean(axis=1) > 20  # not the painted hairline
    assert edge.sum() > 100
    assert np.quantile(steps[edge & below], 0.95) < 1.5 * np.quantile(steps[far & below], 0.95) + 1


@pytest.mark.gl
def test_pictures_that_show_something_else_give_no_skin(model, sessions):
    good = sessions["window"].pictures
    rng = np.random.default_rng(5)
    noise = [rng.integers(0, 255, image.shape).astype(np.uint8) for image in good.images]
    bad = Pictures(noise, good.landmarks, good.shapes, good.camera, good.user)
    found = done(make_likeness(model, bad, MAPS))
    assert found is None or found.skin is None


@pytest.mark.gl
def test_without_a_picture_of_the_face_there_is_no_likeness(model, sessions):
    good = sessions["window"].pictures
    nobody = SetupShapes(
        good.shapes.points_mm, good.shapes.rotations_wxyz, good.shapes.translations_mm,
        good.shapes.coefficients, np.full(len(good.images), np.nan),
    )  # fmt: skip
    blind = Pictures(good.images, good.landmarks, nobody, good.camera, good.user)
    assert done(make_likeness(model, blind, MAPS)) is None
    # Pictures that the camera clipped all over show no colour.
    white = [np.full_like(image, 255) for image in good.images]
    clipped = Pictures(white, good.landmarks, good.shapes, good.camera, good.user)
    assert done(make_likeness(model, clipped, MAPS)) is None


@pytest.mark.gl
def test_the_work_can_be_given_up_at_any_moment(model, sessions):
    steps, took_s = make_likeness(model, sessions["window"].pictures, MAPS), []
    while True:
        begun_s = time.thread_time()
        ended = next(steps, None) is None
        took_s.append(time.thread_time() - begun_s)
        if ended:
            break
    assert max(took_s) < 0.15 * sum(took_s)


@pytest.mark.gl
def test_frontal_pictures_at_rest_are_chosen_and_shut_eyes_for_the_lids(sessions):
    session = sessions["window"].pictures
    chosen = choose(
        [sharpness(image) for image in session.images], session.landmarks, session.shapes
    )
    angles = head_angles_deg(session.shapes)
    assert np.abs(angles[chosen.skin[0]]).max() < 5
    assert {-28, 28} <= {round(angles[row, 0]) for row in chosen.skin}
    assert chosen.lids == (len(session.images) - 1,)
    assert len(session.images) - 1 not in chosen.skin


@pytest.mark.gl
def test_hidden_skin_and_other_things_are_not_looked_at(model, ground, sessions):
    session = sessions["window"].pictures
    head = session.head(model, 5)  # turned by 48 degrees
    view = view_of(session.images[5], head, session.camera, ground.atlas, model)
    x = ground.atlas.at_texels(model.mean_mm)[:, 0]
    seen = view.weight > 0.3
    near, far = (x > 35, x < -35) if seen[x > 35].mean() > 0.5 else (x < -35, x > 35)
    assert seen[near & face_of(ground)].mean() > 0.8
    assert seen[far & face_of(ground)].mean() < 0.1


def with_glasses(model, session, row):
    """Return a picture with dark rims that stand 24 mm before the eyes."""
    face = session.user.neutral_mm
    turn = matrix_from_quaternion(session.shapes.rotations_wxyz[row])
    image = session.images[row].copy()
    angle = np.linspace(0, 2 * np.pi, 60)
    for center in face[model.eye_center_vertices]:
        rim = center + np.stack([27 * np.cos(angle), 4 + 21 * np.sin(angle), -24 + 0 * angle], 1)
        pixels = project(session.camera, rim @ turn.T + session.shapes.translations_mm[row])
        cv2.polylines(image, [np.round(pixels).astype(np.int32)], True, (24, 20, 20), 4)
    return image


@pytest.mark.gl
def test_rims_of_glasses_are_no_skin(model, ground, sessions):
    session = sessions["window"].pictures
    results = []
    for worn in (False, True):
        albedos, weights = [], []
        for row in (0, 1, 2):
            image = with_glasses(model, session, row) if worn else session.images[row]
            head = session.head(model, row)
            view = view_of(image, head, session.camera, ground.atlas, model)
            albedos.append(view.light)
            weights.append(view.weight * ground.window)
        results.append((albedos, weights, done(without_rims(ground, albedos, weights))))
    bare, glasses = results
    for before, after in zip(bare[1], bare[2], strict=True):
        np.testing.assert_array_equal(before, after)
    for number, (albedo, before, after) in enumerate(zip(*glasses, strict=True)):
        rim = (albedo.mean(axis=1) < 0.05) & (before > 0.3) & face_of(ground)
        true = bare[0][number].mean(axis=1)
        rim &= (true > 0.15) & (true > 4 * albedo.mean(axis=1))
        assert rim.sum() > 500
        assert (after[rim] > 0).mean() < 0.12
        assert after.sum() > 0.7 * before.sum()


@pytest.mark.gl
def test_landmarks_pull_the_picture_under_the_mesh(model, sessions):
    session = sessions["window"].pictures
    marks = session.landmarks[0]
    moved = Landmarks2D(
        marks.points_px + [3.0, -2.0], marks.edited, marks.confidence, marks.pupils_px,
        marks.pupil_confidence,
    )  # fmt: skip
    before, after = (
        posed(model, session.user, session.shapes, m, session.camera, 0) for m in (marks, moved)
    )
    shift = (after.pixels - before.pixels)[model.landmark_vertices]
    np.testing.assert_allclose(shift.mean(axis=0), [3, -2], atol=0.4)


def test_displayed_light_is_looked_up_again():
    levels = np.arange(0, 256, dtype=np.float32)
    np.testing.assert_allclose(displayed(scene_light(levels)), levels, atol=0.05)


def test_a_known_light_is_found_and_a_picture_twice_as_bright_has_twice_the_gain():
    rng = np.random.default_rng(1)
    truth = np.zeros((9, 3))
    truth[0], truth[1], truth[3] = 1.0, (0.4, 0.3, 0.2), -0.2
    views = []
    for gain in (1.0, 1.0, 2.0):
        normals = rng.normal(size=(4000, 3)) + [0, 0, -2]
        normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
        light = 0.3 * gain * (basis(normals) @ truth)
        views.append(View(light.astype(np.float32), normals, np.ones(4000, np.float32)))
    found = room_light(views, np.ones(4000, bool))
    assert isinstance(found, RoomLight)
    np.testing.assert_allclose(found.gains[2] / found.gains[0], 2.0, rtol=0.02)
    shade, expected = found.shade(views[0].normals), basis(views[0].normals) @ truth
    off = shade / shade.mean(axis=0) - expected / expected.mean(axis=0)
    assert np.abs(off).mean() < 0.03


@pytest.mark.parametrize("name", ["porcelain", "light", "brown", "deep"])
def test_a_warm_light_is_taken_off_the_skin(name):
    skin = linear(LOOKS[name].skin).astype(float)
    warm = np.array([1.35, 1.0, 0.65])
    white = 0.6 * np.array([0.69, 0.64, 0.61]) * warm
    left = skin * warm / light_of_skin(skin * warm, white) / skin
    assert np.linalg.norm(np.log(left)) < 0.75 * np.linalg.norm(np.log(warm))
    # White light is left as it is.
    usual = light_of_skin(skin, white / warm)
    assert np.abs(np.log(usual)).max() < 0.12


def test_values_go_on_smoothly_where_nothing_is_known(model):
    mesh = Surroundings(model)
    mean = model.mean_mm.astype(float)
    known = (mean[:, 2] < 0) & (mean[:, 1] < 100)
    values = np.where(known[:, None], mean[:, :1] / 50, 99.0)
    out = mesh.extended(values, known.astype(float))
    skin = np.unique(model.triangles[model.part_triangles("skin")])
    shown = skin[known[skin]]
    np.testing.assert_allclose(out[shown].std(), values[shown].std(), rtol=0.1)
    assert np.abs(out[skin]).max() < 2.0


def test_the_nearest_triangle_covers_a_pixel():
    points = np.array(
        [[0, 0, 5], [9, 0, 5], [0, 9, 5], [0, 0, 2], [4, 0, 2], [0, 4, 2]], np.float32
    )
    depth = np.full((10, 10), np.inf, np.float32)
    index = np.full((10, 10), -1, np.int32)
    cover(points, np.array([[0, 1, 2], [3, 5, 4]], np.int32), depth, index)
    assert index[1, 1] == 1
    assert index[6, 1] == 0
    assert index[9, 9] == -1
    assert depth[1, 1] == 2
    naive = cover.py_func
    other, numbers = np.full_like(depth, np.inf), np.full_like(index, -1)
    naive(points, np.array([[0, 1, 2], [3, 5, 4]], np.int32), other, numbers)
    np.testing.assert_array_equal(index, numbers)
