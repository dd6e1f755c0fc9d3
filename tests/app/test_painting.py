import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from app import painting
from app.avatars.gallery import Gallery
from app.painting import (
    AVATARS,
    OWN,
    AvatarPainter,
    Cast,
    LivePainter,
    LiveWish,
    PortraitView,
    avatar_from,
    make_avatar,
    resting,
)
from app.render.quality import Ladder, Quality
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.camera import camera_for
from core.face_model import deltas_mm, load_face_model, neutral_mm
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.records import FaceState, UserBlendshapes
from tests.app.gl import renderer_or_skip

CAMERA = camera_for((160, 120), 160.0)


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


@pytest.fixture(scope="module")
def avatar(model):
    return make_avatar(AVATARS[1], model)


def make_state(yaw=0.0, **expression):
    weights = np.zeros(46)
    for name, weight in expression.items():
        weights[EXPRESSION_NAMES.index(name)] = weight
    return FaceState(
        0.0, quaternion_from_matrix(matrix_from_head_angles(yaw, 0, 0)), [0, 0, 600], weights,
        np.zeros((2, 2)), np.zeros((75, 3)), np.zeros((75, 2)), 1.0, "trained", False,
    )  # fmt: skip


def test_the_list_of_avatars_is_that_of_the_gallery(model):
    assert (OWN, *Gallery(asset("."), model).names) == AVATARS


def test_the_own_head_has_the_users_shape(model, avatar):
    identity = np.zeros(model.n_identities)
    identity[:3] = 1.5
    user = UserBlendshapes(identity, neutral_mm(model, identity), deltas_mm(model, identity))
    own = make_avatar(OWN, model, user)
    n_vertices = len(user.neutral_mm)
    np.testing.assert_allclose(own.neutral_mm[:n_vertices], user.neutral_mm, atol=1e-4)
    assert make_avatar(OWN, model).name == avatar.name


@pytest.mark.gl
@pytest.mark.parametrize("as_portrait", [True, False])
def test_the_picture_follows_expression_and_head(avatar, as_portrait):
    painter = AvatarPainter(avatar, CAMERA, as_portrait=as_portrait)
    try:
        rest = painter.paint(make_state()).astype(int)
        open_mouth = painter.paint(make_state(jawOpen=1.0)).astype(int)
        turned = painter.paint(make_state(yaw=0.6)).astype(int)
        again = painter.paint(make_state()).astype(int)
    finally:
        painter.release()
    assert rest.shape == (120, 160, 4)
    np.testing.assert_array_equal(rest, again)
    changed = [
        (np.abs(other - rest)[..., :3].max(axis=2) > 16).mean() for other in (open_mouth, turned)
    ]
    assert 0 < changed[0] < changed[1]


def test_the_portrait_is_centred_where_the_face_first_was_seen(avatar):
    def head_x(view, x_mm):
        state = replace(make_state(), translation_mm=[x_mm, 0, 600])
        return view.framing(avatar, state).head_to_camera[0, 3]

    view = PortraitView((160, 120))
    view.framing(avatar, resting())
    first = head_x(view, 80.0)
    # Seen for the first time elsewhere, the head is in the middle there; here it has moved.
    assert first == head_x(PortraitView((160, 120)), 80.0)
    assert head_x(view, 100.0) > 2 + head_x(PortraitView((160, 120)), 100.0)


def test_a_user_who_looks_as_usual_and_one_not_yet_seen_look_straight_ahead(avatar, model):
    usual = quaternion_from_matrix(matrix_from_head_angles(0.1, -0.2, 0.05))
    nobody = np.zeros(model.n_identities)
    user = UserBlendshapes(
        nobody, neutral_mm(model, nobody), deltas_mm(model, nobody), rest_wxyz=usual
    )
    view = PortraitView((160, 120), user)
    straight = PortraitView((160, 120)).framing(avatar, resting()).head_to_camera[:3, :3]
    unseen = view.framing(avatar, resting())
    seen = view.framing(avatar, replace(make_state(), rotation_wxyz=usual))
    turned = view.framing(avatar, make_state())
    np.testing.assert_allclose(unseen.head_to_camera[:3, :3], straight, atol=1e-9)
    np.testing.assert_allclose(seen.head_to_camera[:3, :3], straight, atol=1e-9)
    assert np.abs(turned.head_to_camera[:3, :3] - straight).max() > 0.1


@pytest.mark.gl
def test_the_avatar_before_plays_on_and_only_the_last_of_quick_choices_is_seen(model, monkeypatch):
    made, gate = [], threading.Event()

    def gated(gallery, name, *rest):
        made.append(name)
        if name != "nora":
            assert gate.wait(20)
        return avatar_from(gallery, name, *rest)

    monkeypatch.setattr(painting, "avatar_from", gated)
    renderer = renderer_or_skip()
    try:
        painter = LivePainter(renderer, model, (160, 120), Ladder((Quality(),)), meanwhile=True)
        nora, leo, mei = (LiveWish(Cast(name, None), resting()) for name in ("nora", "leo", "mei"))
        first = painter.draw(nora)
        assert not painter.drawn.making
        for wish in (leo, mei, mei):
            np.testing.assert_array_equal(painter.draw(wish), first)
            assert painter.drawn.making
        moved = painter.draw(LiveWish(mei.cast, make_state(jawOpen=1.0)))
        assert np.abs(moved.astype(int) - first).max() > 50
        gate.set()
        ends_s = time.monotonic() + 60
        while painter.drawn.making and time.monotonic() < ends_s:
            seen = painter.draw(mei)
            assert painter.drawn.making == bool(np.array_equal(seen, first))
            time.sleep(0.05)
    finally:
        gate.set()
        renderer.release()
    assert made in (["nora", "leo", "mei"], ["nora", "mei"])
    assert np.abs(seen.astype(int) - first).max() > 50


@pytest.mark.gl
def test_the_live_painter_changes_avatars_and_keeps_the_last_ones(model, monkeypatch):
    made = []

    def counted(gallery, name, *rest):
        made.append(name)
        return avatar_from(gallery, name, *rest)

    monkeypatch.setattr(painting, "avatar_from", counted)
    renderer = renderer_or_skip()
    try:
        painter = LivePainter(renderer, model, (160, 120))
        casts = [Cast(name, None) for name in ("nora", "leo", "nora")]
        nora, leo, again = (painter.draw(LiveWish(cast, resting())) for cast in casts)
        open_mouth = painter.draw(LiveWish(casts[2], make_state(jawOpen=1.0)))
    finally:
        renderer.release()
    assert made == ["nora", "leo"]
    np.testing.assert_array_equal(nora, again)
    assert np.abs(nora.astype(int) - leo).max() > 50
    assert np.abs(nora.astype(int) - open_mouth).max() > 50
