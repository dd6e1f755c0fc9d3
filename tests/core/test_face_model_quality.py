"""Facts about the shipped faces: many people, all expressions, nothing that looks broken."""

import numpy as np
import pytest

from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.face_model import deltas_mm, load_face_model, neutral_mm, subset
from tests.core import face_regions as at

N_PEOPLE = 60
OPENING = ("jawOpen", "mouthClose", "mouthFunnel", "mouthLowerDown", "mouthUpperUp")
CLOSED = [name for name in EXPRESSION_NAMES if not name.startswith(OPENING)]


def number(name):
    return EXPRESSION_NAMES.index(name)


class Face:
    """Vertices of one person's neutral face and expressions."""

    def __init__(self, neutral, deltas, model):
        self.neutral, self.deltas = neutral, deltas
        self.center = neutral[model.eye_center_vertices[0]]
        ball = neutral[model.eyeball_vertices_right] - self.center
        self.radius = np.linalg.norm(ball, axis=1).max()

    def making(self, **amounts):
        """Return the vertices with expressions turned on."""
        return self.neutral + sum(a * self.deltas[number(n)] for n, a in amounts.items())


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


@pytest.fixture(scope="module")
def faces(model):
    """Random people of the model; far from all vertices, only the tested ones are filled in."""
    skin, _ = at.lid_skin(model)
    lips = [v for ring in at.LIP_RINGS for lip in ring for v in lip]
    named = [at.CORNER_RIGHT, at.CORNER_LEFT, at.CHIN, at.UPPER_LIP_BORDER, at.LOWER_LIP_BORDER]
    ids = np.unique([*skin, *lips, *named, *at.INNER_EDGE, *model.landmark_vertices])
    part = subset(model, ids)
    rng, out = np.random.default_rng(5), []
    for _ in range(N_PEOPLE):
        identity = rng.normal(size=model.n_identities)
        deltas = np.zeros((len(EXPRESSION_NAMES), *model.mean_mm.shape))
        deltas[:, ids] = part.expression_deltas(identity)
        out.append(Face(neutral_mm(model, identity), deltas, model))
    return out


@pytest.fixture(scope="module")
def outsiders(model):
    with np.load(asset("people.npz")) as people:
        assert tuple(people["expression_names"]) == EXPRESSION_NAMES
        pairs = zip(people["neutral_mm"], people["deltas_mm"].astype(float), strict=True)
        return [Face(neutral.astype(float), deltas, model) for neutral, deltas in pairs]


@pytest.fixture(scope="module")
def mean_deltas(model):
    """The expressions of the mean person on the head crop."""
    return deltas_mm(model, np.zeros(model.n_identities))[:, :4177]


@pytest.fixture(scope="module")
def everyone(faces, outsiders):
    return faces + outsiders


def test_eyes_are_open_at_rest_and_shut_without_a_gap_at_a_full_blink(everyone):
    for face in everyone:
        assert at.lid_gap_mm(face.neutral, face.center).max() > 5.0
        assert at.lid_gap_mm(face.making(eyeBlinkRight=1), face.center).max() < 0.05


@pytest.mark.parametrize("amount", [0.0, 0.25, 0.5, 0.75, 1.0])
def test_no_eyeball_comes_through_the_lids_at_any_part_of_a_blink(model, everyone, amount):
    _, triangles = at.lid_skin(model)
    for face in everyone:
        points = face.making(eyeBlinkRight=amount)
        assert at.ball_clearance_mm(points, triangles, face.center, face.radius) > 0.0


@pytest.mark.parametrize(
    "name", ["eyeSquintRight", "eyeWideRight", "cheekSquintRight", "browDownRight"]
)
def test_no_eyeball_comes_through_the_lids_in_other_shapes_of_the_eye(model, everyone, name):
    _, triangles = at.lid_skin(model)
    for face in everyone:
        points = face.making(**{name: 1.0})
        assert at.ball_clearance_mm(points, triangles, face.center, face.radius) > 0.0


def test_lashes_stay_on_the_lids(model, outsiders):
    lashes = np.unique(model.triangles[model.part_triangles("lashes")])
    rims = [*at.UPPER_RIM, *at.LOWER_RIM]
    for face in outsiders:
        right = lashes[face.neutral[lashes, 0] < 0]

        def from_rim(points, right=right):
            apart = points[right][:, None] - points[rims][None]
            return np.linalg.norm(apart, axis=-1).min(axis=1)

        for amount in (0.5, 1.0):
            shut = face.making(eyeBlinkRight=amount)
            assert np.abs(from_rim(shut) - from_rim(face.neutral)).max() < 2.0
        assert np.abs(face.deltas[number("eyeBlinkRight")][right, 1]).max() > 5.0


@pytest.mark.parametrize("name", ["neutral", *CLOSED])
def test_lips_are_sealed_in_every_shape_that_does_not_part_them(everyone, name):
    for face in everyone:
        points = face.neutral if name == "neutral" else face.making(**{name: 1.0})
        assert at.lip_gap_mm(points).max() < 0.3


def test_mouth_close_seals_the_lips_of_an_open_jaw(everyone):
    for face in everyone:
        assert at.lip_gap_mm(face.making(jawOpen=1, mouthClose=1)).max() < 0.3
        assert at.lip_gap_mm(face.making(jawOpen=0.5, mouthClose=0.5)).max() < 0.3


@pytest.mark.parametrize(
    "name, least_mm",
    [("mouthFunnel", 6), ("mouthLowerDownLeft", 3), ("mouthUpperUpLeft", 3), ("jawOpen", 25)],
)
def test_shapes_that_part_the_lips_do(everyone, name, least_mm):
    for face in everyone:
        assert at.lip_gap_mm(face.making(**{name: 1.0})).max() > least_mm


def test_jaws_open_and_swing_far_enough(everyone):
    for face in everyone:
        opened = face.deltas[number("jawOpen")] + face.neutral
        assert opened[at.LOWER_LIP_MIDDLE, 1] - opened[at.UPPER_LIP_MIDDLE, 1] > 30.0
    for face in everyone[:N_PEOPLE]:
        assert face.deltas[number("jawLeft")][at.CHIN, 0] > 8.0
        assert face.deltas[number("jawRight")][at.CHIN, 0] < -8.0
        assert face.deltas[number("jawForward")][at.CHIN, 2] < -5.0


def test_no_two_shapes_are_alike(mean_deltas):
    deltas = mean_deltas.reshape(len(EXPRESSION_NAMES), -1)
    deltas = deltas / np.linalg.norm(deltas, axis=1, keepdims=True)
    alike = deltas @ deltas.T - np.eye(len(deltas))
    assert alike.max() < 0.95


@pytest.mark.parametrize("name", EXPRESSION_NAMES)
def test_every_shape_can_be_seen(mean_deltas, name):
    moved = np.linalg.norm(mean_deltas[number(name)], axis=1)
    assert moved.max() > 3.0
    # Not a single spike: a patch of skin moves.
    assert np.sort(moved)[-60] > 1.2


@pytest.mark.parametrize("lip", ["Lower", "Upper"])
def test_rolling_a_lip_hides_most_of_its_red(faces, lip):
    border = at.LOWER_LIP_BORDER if lip == "Lower" else at.UPPER_LIP_BORDER
    middle = at.LOWER_LIP_MIDDLE if lip == "Lower" else at.UPPER_LIP_MIDDLE

    def red(points):
        return abs(points[border, 1] - points[middle, 1])

    shares = [red(f.making(**{f"mouthRoll{lip}": 1.0})) / red(f.neutral) for f in faces]
    assert np.mean(shares) < 0.55


def test_corners_of_the_mouth_go_where_the_names_say(faces):
    def corner(face, name):
        return face.deltas[number(name)][at.CORNER_LEFT]

    for face in faces:
        smile, frown = corner(face, "mouthSmileLeft"), corner(face, "mouthFrownLeft")
        assert smile[0] > 3 and smile[1] < -5
        assert frown[1] > 4
        assert corner(face, "mouthStretchLeft")[0] > 4
        assert corner(face, "mouthDimpleLeft")[2] > 4
        assert corner(face, "mouthPucker")[0] < -5
        assert corner(face, "mouthLeft")[0] > 4


def test_brows_go_where_the_names_say(model, faces):
    left = dict(zip(("outer", "arch", "inner"), model.landmark_vertices[[3, 5, 9]], strict=True))
    for face in faces:
        assert face.deltas[number("browDownLeft")][left["inner"], 1] > 2
        assert face.deltas[number("browInnerUpLeft")][left["inner"], 1] < -4
        assert face.deltas[number("browOuterUpLeft")][left["arch"], 1] < -3
        assert face.deltas[number("browOuterUpLeft")][left["outer"], 1] < -4


def test_people_have_human_measures(model, faces):
    between_eyes = [2 * abs(f.center[0]) for f in faces]
    assert 58 < np.mean(between_eyes) < 66
    assert min(between_eyes) > 50 and max(between_eyes) < 76
    to_chin = [f.neutral[at.CHIN, 1] for f in faces]
    assert min(to_chin) > 78 and max(to_chin) < 130


def test_people_outside_the_model_are_near_its_span_but_not_in_it(model, outsiders):
    ids = np.arange(4177)
    modes = model.identity_modes_mm[:, ids].reshape(model.n_identities, -1).astype(float)
    for face in outsiders:
        rest = (face.neutral[ids] - model.mean_mm[ids]).ravel()
        identity = np.linalg.lstsq(modes.T, rest, rcond=None)[0]
        error = np.linalg.norm((rest - identity @ modes).reshape(-1, 3), axis=1).mean()
        assert 0.2 < error < 1.2
        away = np.abs(face.deltas[:, ids] - deltas_mm(model, identity)[:, ids]).max(axis=(1, 2))
        assert np.median(away) > 0.5


def test_the_files_are_small():
    assert asset("face_model.npz").stat().st_size <= 6_000_000
    assert asset("people.npz").stat().st_size <= 3_000_000
