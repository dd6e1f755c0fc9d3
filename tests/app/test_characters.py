"""The drawn characters, and what all avatars must do at all 46 expressions."""

from itertools import pairwise

import cv2
import numpy as np
import pytest

from app.avatars.characters import bent_head, carried, sideless
from app.avatars.fennec import FENNEC
from app.avatars.juno import JUNO
from app.avatars.pieces import Clump, ball, clump, ear, joined, mirrored
from app.avatars.views import portrait
from app.avatars.warp import EyeStyle, Lay, Push, Swell, Warp, evened
from app.render.puppet import Puppet
from app.render.renderer import Scene
from app.render.scene import studio_lights
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.landmarks import NAMES
from tests.app.avatar_pictures import default_gallery, expression_of
from tests.app.gl import renderer_or_skip, silhouette_overlap

NO_GAZE = np.zeros((2, 2))
SHUT = {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0}
DRAWN, HUMANS = ("juno", "fennec"), ("nora", "kofi")
ALL = (*HUMANS, "leo", "mei", "amara", "viktor", *DRAWN)


@pytest.fixture(scope="module")
def gallery():
    return default_gallery()


@pytest.fixture(scope="module")
def avatars(gallery):
    return {name: gallery.built_in(name) for name in gallery.names}


class Stage:
    """Draws avatars in front of nothing."""

    def __init__(self, renderer, avatar, size_px=(220, 220)):
        self.renderer, self.avatar = renderer, avatar
        self.puppet = Puppet(renderer, avatar)
        turn = np.array([1.0, 0, 0, 0])
        self.framing = portrait(avatar, size_px, turn, np.array([0.0, 0, 600]))

    def items(self, shapes):
        places = self.framing.head_to_camera, self.framing.body_to_camera
        return self.puppet.items(expression_of(shapes), NO_GAZE, *places)

    def draw(self, shapes):
        return self.of(self.items(shapes))

    def of(self, items):
        scene = Scene(self.framing.view, studio_lights(), items)
        return self.renderer.draw(scene).astype(int)

    def eyes_seen(self, shapes):
        """Return how many pixels change when the eyeballs are not drawn."""
        items = self.items(shapes)
        return (np.abs(self.of(items) - self.of(items[:-2])).max(axis=2) > 6).sum()


@pytest.fixture(scope="module")
def stages(avatars):
    renderer = renderer_or_skip()
    yield {name: Stage(renderer, avatar) for name, avatar in avatars.items()}
    renderer.release()


def lip_gap_mm(avatar, shapes):
    points = avatar.neutral_mm.astype(float)
    weights = expression_of(shapes)
    for shape in np.flatnonzero(weights):
        entries = slice(*avatar.delta_starts[shape : shape + 2])
        points[avatar.delta_rows[entries]] += weights[shape] * avatar.deltas_mm[entries]
    upper, lower = points[avatar.lip_rows]
    return lower[1] - upper[1]


@pytest.mark.gl
@pytest.mark.parametrize("name", ALL)
def test_shut_lids_hide_the_eyeballs_of_every_avatar(stages, name):
    opened = stages[name].eyes_seen({})
    assert opened > 100
    assert stages[name].eyes_seen(SHUT) < 0.03 * opened
    smile = {"mouthSmileLeft": 1.0, "mouthSmileRight": 1.0, "cheekSquintLeft": 0.6}
    assert stages[name].eyes_seen(SHUT | smile) < 0.05 * opened


@pytest.mark.gl
@pytest.mark.parametrize("name", ALL)
def test_half_shut_lids_hide_half_of_the_eyeballs_and_no_ball_comes_through(stages, name):
    seen = [
        stages[name].eyes_seen({"eyeBlinkLeft": w, "eyeBlinkRight": w})
        for w in (0.0, 0.25, 0.5, 0.75, 1.0)
    ]
    assert all(later < earlier or later == 0 for earlier, later in pairwise(seen))
    assert 0.1 * seen[0] < seen[2] < 0.75 * seen[0]


@pytest.mark.gl
@pytest.mark.parametrize("name", ALL)
def test_an_open_jaw_shows_the_dark_of_the_mouth_and_the_teeth(stages, name):
    stage = stages[name]
    rest, opened = stage.draw({}), stage.draw({"jawOpen": 1.0})
    changed = np.abs(opened - rest).max(axis=2) > 40
    assert changed.sum() > 100
    inside = opened[changed][:, :3].max(axis=1)
    assert (inside < 70).sum() > 12
    # Without what is drawn wet, teeth and tongue, the mouth looks different.
    items = stage.items({"jawOpen": 1.0, "mouthUpperUpLeft": 0.5, "mouthUpperUpRight": 0.5})
    dry = [item for item in items if not item.drawable.material.in_mouth]
    assert len(dry) == len(items) - 1
    assert (np.abs(stage.of(items) - stage.of(dry)).max(axis=2) > 20).sum() > 20
    assert lip_gap_mm(stage.avatar, {"jawOpen": 1.0}) > 14


@pytest.mark.parametrize("name", ALL)
def test_lips_that_close_over_an_open_jaw_meet(avatars, name):
    avatar = avatars[name]
    opened = lip_gap_mm(avatar, {"jawOpen": 1.0})
    assert lip_gap_mm(avatar, {"jawOpen": 1.0, "mouthClose": 1.0}) < 0.12 * opened
    for shape in ("mouthSmileLeft", "mouthPucker", "mouthFrownRight", "cheekPuffLeft"):
        assert lip_gap_mm(avatar, {shape: 1.0}) < 0.15 * opened, shape


@pytest.mark.gl
@pytest.mark.parametrize("name", [*HUMANS, *DRAWN])
def test_every_expression_changes_the_picture_of_every_avatar(stages, name):
    stage = stages[name]
    rest = stage.draw({})
    for shape in EXPRESSION_NAMES:
        # Lips close what the jaw has opened.
        with_jaw = {"jawOpen": 0.6} if shape == "mouthClose" else {}
        before = stage.draw(with_jaw) if with_jaw else rest
        off = np.abs(stage.draw(with_jaw | {shape: 1.0}) - before).max(axis=2) > 6
        assert off.sum() > 15, shape


@pytest.mark.gl
def test_lips_do_not_close_over_a_shut_jaw(stages):
    stage = stages["nora"]
    off = np.abs(stage.draw({"mouthClose": 1.0}) - stage.draw({})).max(axis=2) > 40
    assert off.sum() < 40
    shut = np.abs(stage.draw({"jawOpen": 1, "mouthClose": 1}) - stage.draw({"jawOpen": 1}))
    assert (shut.max(axis=2) > 40).sum() > 150


@pytest.mark.gl
def test_the_creature_has_another_outline_than_all_humans(stages):
    outlines = {name: stage.draw({}) for name, stage in stages.items()}
    humans = [name for name in ALL if name not in DRAWN]
    nearest = {
        a: max(silhouette_overlap(outlines[a], outlines[b]) for b in humans if a != b)
        for a in humans
    }
    furthest = min(nearest.values())
    assert all(silhouette_overlap(outlines["fennec"], outlines[a]) < furthest for a in humans)


def test_the_creature_has_other_proportions_than_the_model(gallery, avatars):
    rows = gallery._model.landmark_vertices

    def muzzle_mm(avatar):
        points = avatar.neutral_mm[rows]
        marks = dict(zip(NAMES, points, strict=False))
        return marks["R_eye_inner"][2] - marks["nose_tip"][2]

    assert muzzle_mm(avatars["fennec"]) > 1.6 * muzzle_mm(avatars["nora"])
    assert avatars["juno"].eyes.radii_mm.min() > 1.3 * avatars["nora"].eyes.radii_mm.max()
    assert avatars["fennec"].neutral_mm[:, 1].min() < avatars["nora"].neutral_mm[:, 1].min() - 15


@pytest.mark.parametrize("character", [JUNO, FENNEC])
def test_a_warp_keeps_eyeballs_round_and_what_touches_together(character):
    centers = np.array([[-30.7, 0, 0], [30.7, 0, 0]])
    warp = Warp(character.steps, character.eyes, centers, 15.9)
    rng = np.random.default_rng(2)
    directions = rng.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for center in centers:
        bent_center = warp(center[None])[0]
        for radius in (15.9, 17.5):
            away = np.linalg.norm(warp(center + radius * directions) - bent_center, axis=1)
            np.testing.assert_allclose(away, radius * character.eyes.size, rtol=1e-6)
    # Neighbours stay neighbours in the same order: the map never folds.
    points = rng.uniform([-60, -60, -45], [60, 110, 60], (4000, 3))
    jacobians = np.stack(
        [(warp(points + 0.01 * step) - warp(points)) / 0.01 for step in np.eye(3)], axis=2
    )
    assert np.linalg.det(jacobians).min() > 0


def test_a_warp_without_steps_changes_nothing():
    centers = np.array([[-30.0, 0, 0], [30, 0, 0]])
    points = np.random.default_rng(3).normal(0, 50, (300, 3))
    np.testing.assert_allclose(Warp((), EyeStyle(), centers, 16.0)(points), points, atol=1e-9)


def test_a_warp_is_the_same_on_both_sides():
    centers = np.array([[-30.0, 0, 0], [30, 0, 0]])
    mirror = np.array([-1.0, 1, 1])
    points = np.random.default_rng(4).normal(0, 40, (300, 3))
    for character in (JUNO, FENNEC):
        warp = Warp(character.steps, character.eyes, centers, 16.0)
        np.testing.assert_allclose(warp(points * mirror), warp(points) * mirror, atol=1e-9)


def test_the_steps_of_a_warp_do_what_they_say():
    push = Push((10, 0, 0), (5, 5, 5), (1, 2, 3))
    np.testing.assert_allclose(push(np.array([[10.0, 0, 0]])), [[11, 2, 3]], atol=1e-6)
    np.testing.assert_allclose(push(np.array([[-10.0, 0, 0]])), [[-11, 2, 3]], atol=1e-6)
    swell = Swell((0, 0, 0), (1e4, 1e4, 1e4), (2, 1, 0.5))
    np.testing.assert_allclose(swell(np.array([[1.0, 1, 1]])), [[2, 1, 0.5]], atol=1e-6)
    laid = Lay(70, 0.1, (0, 0), (50, 50))(np.array([[80.0, 0, 0], [60, 0, 0]]))
    np.testing.assert_allclose(laid, [[71, 0, 0], [60, 0, 0]], atol=1e-6)


def test_evening_takes_a_bump_off_and_leaves_what_may_not_move():
    grid = np.array([[x, y, 0.0] for y in range(5) for x in range(5)])
    grid[12, 2] = 4.0
    square = [[a, a + 1, a + 6] for a in range(19) if a % 5 < 4]
    square += [[a, a + 6, a + 5] for a in range(19) if a % 5 < 4]
    free = np.ones(25)
    free[0] = 0
    out = evened(grid, np.array(square, np.int32), free, 6)
    assert out[12, 2] < 1.5
    np.testing.assert_array_equal(out[0], grid[0])


def test_pieces_are_closed_and_look_outwards():
    sphere = ball(np.array([1.0, 2, 3]), np.array([4.0, 4, 4]))
    a, b, c = (sphere.points_mm[sphere.triangles[:, k]] for k in range(3))
    normals, middles = np.cross(b - a, c - a), (a + b + c) / 3 - [1, 2, 3]
    large = np.linalg.norm(normals, axis=1) > 1e-6
    assert (np.einsum("tc,tc->t", normals, middles)[large] > 0).all()
    skin = 80 * np.random.default_rng(1).normal(size=(4000, 3))
    skin = 80 * skin / np.linalg.norm(skin, axis=1, keepdims=True) + [0, -20, 80]
    lock = clump(Clump(((0, 60, 5), (0, 30, 15), (0, 0, 5)), 20), skin)
    away = np.linalg.norm(lock.points_mm - [0, -20, 80], axis=1)
    assert away.min() > 75
    assert away.max() < 110
    both = joined([lock, mirrored(lock)])
    assert both.triangles.max() == len(both.points_mm) - 1
    pointed = ear(np.array([40.0, -60, 60]), np.array([80.0, -150, 60]), 70, 15)
    assert pointed.points_mm[:, 1].min() < -148
    assert (pointed.uv[..., 0] <= 1).all()


def test_what_lies_on_the_skin_goes_with_it(gallery, avatars):
    head = bent_head(FENNEC, gallery._model, np.zeros(gallery._model.n_identities))
    corner = head.model.landmark_vertices[NAMES.index("L_mouth_corner")]
    smile = EXPRESSION_NAMES.index("mouthSmileLeft")
    moved = carried(head.neutral_mm[[corner]], head)[smile, 0]
    own = head.deltas_mm[smile, corner]
    assert np.linalg.norm(moved - own) < 0.35 * np.linalg.norm(own)


def test_names_lose_their_side_only():
    assert sideless("eyeBlinkLeft") == "eyeBlink"
    assert sideless("jawLeft") == "jaw"
    assert sideless("mouthRollLower") == "mouthRollLower"


def test_every_built_in_avatar_has_a_small_picture_and_they_differ(gallery):
    folder = asset("avatars") / "thumbnails"
    pictures = {name: cv2.imread(str(folder / f"{name}.jpg")) for name in gallery.names}
    assert all(picture.shape == (96, 96, 3) for picture in pictures.values())
    first = pictures["nora"].astype(int)
    off = [np.abs(pictures[name] - first).mean() for name in gallery.names if name != "nora"]
    assert min(off) > 4
    assert sum(path.stat().st_size for path in folder.iterdir()) < 60_000
    assert len(list(folder.iterdir())) == len(gallery.names)
