"""Mouths of avatars: lips that meet at rest, teeth that look like teeth."""

from dataclasses import replace

import numpy as np
import pytest

from app.avatars.mouth import bright_teeth, lip_seal
from app.avatars.painter import AvatarPainter
from app.avatars.wardrobe import load_wardrobe
from app.render.lip_seal import closing_mm
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.face_model import load_face_model
from core.response import lips_rested
from tests.app.avatar_pictures import default_gallery, draw, expression_of
from tests.app.gl import renderer_or_skip

ASSETS = asset("avatars").parent


@pytest.fixture(scope="module")
def gallery():
    return default_gallery()


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


@pytest.fixture(scope="module")
def mouth(model):
    return load_wardrobe(ASSETS, model).mouth


def posed(avatar, expression):
    dense = avatar.neutral_mm.copy()
    for shape, weight in enumerate(expression):
        entries = slice(*avatar.delta_starts[shape : shape + 2])
        np.add.at(dense, avatar.delta_rows[entries], weight * avatar.deltas_mm[entries])
    return dense


def gap_mm(avatar, vertices):
    """Return how far the lips are apart, in the middle of the mouth."""
    middle = np.abs(avatar.neutral_mm[avatar.seal.upper, 0]) < 2
    gap = vertices[avatar.seal.lower, 1] - vertices[avatar.seal.upper, 1]
    return gap[middle]


def test_lips_at_rest_meet_in_every_avatar(gallery):
    rng = np.random.default_rng(1)
    for name in gallery.names:
        avatar = gallery.built_in(name)
        for _ in range(6):
            vertices = posed(avatar, lips_rested(rng.uniform(0, 0.04, len(EXPRESSION_NAMES))))
            avatar.seal.close(vertices)
            assert gap_mm(avatar, vertices).max() < 0.35, name


def test_a_mouth_that_is_open_is_left_as_it_is_and_opens_without_a_jump(gallery):
    avatar = gallery.built_in("kofi")
    opened = posed(avatar, expression_of({"jawOpen": 1.0}))
    sealed = opened.copy()
    avatar.seal.close(sealed)
    np.testing.assert_array_equal(sealed, opened)
    gaps = []
    for jaw in np.linspace(0, 0.4, 401):
        vertices = posed(avatar, expression_of({"jawOpen": jaw}))
        avatar.seal.close(vertices)
        gaps.append(gap_mm(avatar, vertices).max())
    steps = np.diff(gaps)
    assert steps.min() > -1e-3
    assert steps.max() < 0.15


def test_small_gaps_close_wide_ones_stay_and_overlapping_lips_are_left_alone():
    np.testing.assert_allclose(closing_mm(np.array([0.6, 0.3])), [0.8, 0.5], atol=1e-6)
    assert not closing_mm(np.array([-0.5, -2.0])).any()
    assert not closing_mm(np.array([0.5, 7.0])).any()


@pytest.mark.gl
def test_no_dark_is_seen_between_lips_at_rest(gallery):
    renderer = renderer_or_skip()
    painter = AvatarPainter(renderer)
    noise = np.random.default_rng(2).uniform(0, 0.04, len(EXPRESSION_NAMES))
    for name in ("leo", "mei", "kofi", "amara", "juno", "fennec"):
        avatar = gallery.built_in(name)
        rest = blackest(painter, avatar, lips_rested(noise))
        assert rest > 1.25 * blackest(painter, replace(avatar, seal=None), noise), name
        assert rest > 1.25 * blackest(painter, avatar, expression_of({"jawOpen": 0.5})), name
    renderer.release()


def blackest(painter, avatar, expression):
    """Return how bright the darkest pixels around the middle of the mouth are."""
    shapes = dict(zip(EXPRESSION_NAMES, expression, strict=True))
    picture = draw(painter, avatar, (0, 0, 0), (0, 0), shapes, size_px=(480, 480))
    return float(np.percentile(picture[300:400, 215:265, :3].mean(axis=2), 0.5))


def test_teeth_of_avatars_are_brighter_with_fainter_gaps(mouth):
    bright = bright_teeth(mouth)
    # Four upper incisors of the square of teeth.
    before, after = (
        picture[580:608, 520:600].astype(float).mean(axis=2) for picture in (mouth, bright)
    )
    assert np.percentile(after, 50) > np.percentile(before, 50) + 12
    assert np.percentile(after, 1) > np.percentile(before, 1) + 60
    assert np.ptp(after[14]) > 6
    # The tongue is as it was.
    np.testing.assert_allclose(bright[100:200, 60:130], mouth[100:200, 60:130], atol=2)


def test_the_virtual_performer_keeps_its_own_mouth(model):
    plain = load_wardrobe(ASSETS, model)
    assert plain.seal is None
    assert len(lip_seal(model).upper) > 12
