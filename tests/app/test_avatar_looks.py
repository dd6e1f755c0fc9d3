"""What a look does to an avatar's picture: facts about pixels."""

import math
import os
from functools import cache

import cv2
import numpy as np
import pytest

from app.avatars.painter import AvatarPainter, AvatarWish
from app.avatars.views import portrait
from app.painting import Cast, LivePainter, LiveWish, resting
from app.picture_files import PictureFileError, PictureShelf, load_picture
from app.render.backdrop import blurred, covering
from app.render.lights import LIGHTS, lit
from app.render.look import BACKGROUNDS, FRAMINGS, AvatarLook, Background, look_from_json
from app.render.quality import IN_SOFTWARE, ON_CARD, Ladder, Quality
from app.resources import asset
from core.camera import project
from core.face_model import load_face_model
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    quaternion_from_matrix,
)
from core.records import Frame
from tests.app.avatar_pictures import default_gallery
from tests.app.gl import renderer_or_skip, silhouette_overlap

SIZE_PX = (160, 120)
AHEAD_MM = np.array([0.0, 0.0, 600.0])
STILL = np.zeros(46)
KEY = (0, 255, 0)


@pytest.fixture(scope="module")
def gallery():
    return default_gallery()


@pytest.fixture(scope="module")
def built_in(gallery):
    """Makes each avatar once."""
    return cache(gallery.built_in)


@pytest.fixture(scope="module")
def nora(built_in):
    return built_in("nora")


@pytest.fixture(scope="module")
def renderer():
    renderer = renderer_or_skip()
    yield renderer
    renderer.release()


@pytest.fixture(scope="module")
def painter(renderer):
    return AvatarPainter(renderer)


def framed(avatar, look, angles_deg=(0, 0, 0), translation_mm=AHEAD_MM, size_px=SIZE_PX):
    rotation = quaternion_from_matrix(matrix_from_head_angles(*np.deg2rad(angles_deg)))
    return portrait(avatar, size_px, rotation, np.array(translation_mm, float), AHEAD_MM, look)


def taken(painter, avatar, look, angles_deg=(0, 0, 0), behind=None):
    framing = framed(avatar, look, angles_deg)
    wish = AvatarWish(avatar, framing, STILL, np.zeros((2, 2)), look=look, behind=behind)
    return painter.draw(wish)


def backed(kind, **values):
    return AvatarLook(background=Background(kind, **values))


def light_of(picture):
    return picture[..., :3].astype(float) @ [0.3, 0.59, 0.11]


@pytest.mark.gl
def test_a_transparent_picture_shows_the_figure_and_nothing_else(painter, nora):
    picture = taken(painter, nora, backed("transparent"))
    assert picture[0, 0, 3] == picture[0, -1, 3] == 0
    assert picture[55, 80, 3] == 255
    assert (picture[..., :3] <= picture[..., 3:]).all()  # premultiplied


@pytest.mark.gl
@pytest.mark.parametrize("key", [KEY, (255, 0, 255), (0, 0, 254)])
def test_a_chroma_key_is_one_colour_up_to_the_figure_and_never_mixed_with_it(painter, nora, key):
    figure = taken(painter, nora, backed("transparent")).astype(int)
    picture = taken(painter, nora, backed("key", key=key)).astype(int)
    outside = figure[..., 3] < 128
    assert (picture[outside] == [*key, 255]).all()
    assert (picture[..., 3] == 255).all()
    edge = ~outside & (figure[..., 3] < 255)
    assert edge.sum() > 50
    own = figure[edge][:, :3] * 255 / figure[edge][:, 3:]
    np.testing.assert_allclose(picture[edge][:, :3], np.minimum(own, 255), atol=1)


@pytest.mark.gl
def test_a_colour_fills_all_that_the_figure_leaves(painter, nora):
    picture = taken(painter, nora, backed("color", color=(200, 40, 90)))
    assert tuple(picture[0, 0]) == tuple(picture[3, -2]) == (200, 40, 90, 255)
    assert (picture[..., 3] == 255).all()


@pytest.mark.gl
def test_from_the_side_one_sees_the_profile_and_from_behind_no_face(painter, nora):
    def seen(yaw_deg):
        look = backed("transparent").changed(yaw_rad=math.radians(yaw_deg))
        return taken(painter, nora, look)

    front, left, right, back = (seen(yaw) for yaw in (0, 90, -90, 180))
    assert silhouette_overlap(front, front[:, ::-1]) > 0.97
    assert silhouette_overlap(left, left[:, ::-1]) < 0.92
    assert silhouette_overlap(left, right[:, ::-1]) > 0.97
    # Shoulders are wide from the front and narrow from the side.
    width = [(picture[-3, :, 3] > 127).sum() for picture in (front, left)]
    assert width[1] < 0.75 * width[0]
    # From her left the nose points to the left of the picture.
    head = np.nonzero((left[:70, :, 3] > 127).any(axis=0))[0]
    nose_row = np.argmin([np.argmax(row[:, 3] > 127) or 999 for row in left[40:75]])
    assert left[40 + nose_row, head[0] : head[0] + 8, 3].any()
    assert light_of(back[40:60, 70:90]).mean() < 0.75 * light_of(front[40:60, 70:90]).mean()


@pytest.mark.gl
def test_from_above_one_sees_more_hair_and_from_below_less(painter, nora):
    def forehead_row(pitch_rad):
        picture = taken(painter, nora, backed("transparent").changed(pitch_rad=pitch_rad))
        skin = (picture[..., 0] > 170) & (picture[..., 2] > 110)
        return np.nonzero(skin[:, 75:85].sum(axis=1) > 5)[0][0]

    assert forehead_row(0.5) > forehead_row(0.0) + 5 > forehead_row(-0.4) + 5


@pytest.mark.gl
def test_a_mirror_turns_the_figure_over_and_leaves_light_and_picture(painter, nora, rng):
    wall = rng.integers(0, 256, (120, 160, 3)).astype(np.uint8)
    look = backed("picture", picture="wall").changed(lights="dramatic")
    plain = taken(painter, nora, look, (25, 5, 10), wall)
    mirror = taken(painter, nora, look.changed(mirrored=True), (25, 5, 10), wall)
    np.testing.assert_array_equal(plain[:8], mirror[:8])
    see = {"background": Background("transparent")}
    figure = taken(painter, nora, look.changed(**see), (25, 5, 10))
    turned = taken(painter, nora, look.changed(**see, mirrored=True), (25, 5, 10))
    assert silhouette_overlap(figure[:, ::-1], turned) > 0.99
    assert silhouette_overlap(figure, turned) < 0.95
    # The lamp stands on the left of the picture in both.
    for mirrored in (False, True):
        bright = light_of(taken(painter, nora, look.changed(**see, mirrored=mirrored)))[50:75]
        assert bright[:, 62:78].mean() > 1.15 * bright[:, 82:98].mean()


@pytest.mark.gl
def test_what_is_done_to_the_view_is_undone_exactly(painter, nora):
    look = AvatarLook()
    before = taken(painter, nora, look)
    moved = look.turned(0.7, 0.3).zoomed(1.8, 0.1, 0.2).panned(0.1, -0.2)
    assert np.abs(taken(painter, nora, moved).astype(int) - before).max() > 60
    np.testing.assert_array_equal(taken(painter, nora, moved.seen_as_at_first()), before)


@pytest.mark.parametrize("mirrored", [False, True])
def test_zooming_leaves_the_place_under_the_cursor_where_it_is(nora, mirrored):
    def place(look, point):
        framing = framed(nora, look)
        spot = framing.head_to_camera[:3, :3] @ point + framing.head_to_camera[:3, 3]
        seen = project(framing.view.camera, spot)
        return np.array([159 - seen[0], seen[1]]) if mirrored else seen

    look = AvatarLook(mirrored=mirrored).turned(0.2, 0.1).panned(0.05, 0.1)
    nose = np.array([5.0, 25.0, -25.0])
    before = place(look, nose)
    away = (before - [79.5, 59.5]) / 120
    after = place(look.zoomed(1.7, *away), nose)
    np.testing.assert_allclose(after, before, atol=1e-6)
    # Dragging to the right takes the front to the right, in a mirror as well.
    assert place(look.turned(0.2, 0), nose)[0] > before[0] + 3


@pytest.mark.gl
@pytest.mark.parametrize("framing", FRAMINGS)
def test_every_avatar_fits_into_every_framing(painter, gallery, built_in, framing):
    look = backed("transparent").changed(framing=framing)
    for name in gallery.names[::2]:
        picture = taken(painter, built_in(name), look)
        assert (picture[0, :, 3] == 0).all(), f"{name} is cut off above"
        assert (picture[-1, 60:100, 3] == 255).all(), f"{name} hangs in the air"
        if framing != "close":
            assert (picture[:, 0, 3] == 0).all(), f"{name} is cut off at the side"


@pytest.mark.gl
@pytest.mark.parametrize("name", LIGHTS)
def test_in_every_light_faces_are_neither_dark_nor_blown_out_and_tones_stay_apart(
    painter, built_in, name
):
    look = backed("transparent").changed(lights=name)
    levels = []
    for avatar in ("nora", "amara", "kofi"):
        face = taken(painter, built_in(avatar), look)[42:80, 66:94]
        level = light_of(face)
        levels.append(level.mean())
        assert (face[..., :3].min(axis=2) > 250).mean() < 0.02
        # Colours of skin: red before green before blue, or nearly so in coloured light.
        red, green, blue = face[..., :3].reshape(-1, 3).mean(axis=0)
        assert red > green and red > 0.93 * blue
    assert 95 < levels[0] < 225
    assert levels[2] > 35
    assert levels[0] > levels[1] + 15 > levels[2] + 22


def test_brightness_is_a_factor_on_all_light():
    base, brighter = lit("ring"), lit("ring", 1.5)
    np.testing.assert_allclose(brighter.colors, 1.5 * base.colors)
    np.testing.assert_allclose(brighter.ambient_below, 1.5 * base.ambient_below)


@pytest.mark.gl
def test_the_blurred_webcam_is_its_frame_out_of_focus(painter, nora, rng):
    small = rng.uniform(0, 255, (3, 4, 3)).astype(np.float32)
    frame = cv2.resize(small, (320, 180), interpolation=cv2.INTER_CUBIC).clip(0, 255)
    frame = (0.7 * frame + rng.uniform(0, 70, frame.shape)).astype(np.uint8)
    soft = blurred(frame, SIZE_PX, False)
    sharp = covering(frame, SIZE_PX)
    likeness = np.corrcoef(cv2.blur(sharp, (15, 15)).ravel(), soft.ravel())[0, 1]
    assert likeness > 0.95
    assert np.abs(np.diff(soft.astype(int), axis=1)).max() < 12
    np.testing.assert_array_equal(blurred(frame, SIZE_PX, True)[:, ::-1], soft)
    picture = taken(painter, nora, backed("blurred"), behind=frame)
    np.testing.assert_array_equal(picture[:5, :, :3], soft[:5])


def test_a_picture_fills_the_size_undistorted():
    ys, xs = np.mgrid[0:200, 0:600]
    disk = np.repeat((np.hypot(xs - 300, ys - 100) < 60)[..., None] * 255, 3, axis=2)
    fitted = covering(disk.astype(np.uint8), SIZE_PX) > 127
    rows, columns = np.nonzero(fitted[..., 0])
    assert fitted.shape == (120, 160, 3)
    assert abs(np.ptp(rows) - np.ptp(columns)) <= 1
    assert abs(np.ptp(rows) - 72) <= 2


def test_a_file_that_is_no_picture_says_so_and_the_one_before_stays(tmp_path):
    good, bad = tmp_path / "good.png", tmp_path / "bad.png"
    cv2.imwrite(str(good), np.full((4, 6, 3), (10, 20, 30), np.uint8))
    bad.write_bytes(b"")
    assert tuple(load_picture(str(good))[0, 0]) == (30, 20, 10)
    for path, found in ((bad, "empty"), (tmp_path / "none.png", "No such file"), ("", "nothing")):
        with pytest.raises(PictureFileError, match=found):
            load_picture(str(path))
    shelf = PictureShelf()
    kept = shelf.get(str(good))
    assert shelf.get(str(bad)) is kept
    assert PictureShelf().get(str(bad)) is None
    cv2.imwrite(str(good), np.full((6, 8, 3), 200, np.uint8))
    os.utime(good, ns=(1, 1))
    assert shelf.get(str(good)).shape == (6, 8, 3)
    large = tmp_path / "large.png"
    cv2.imwrite(str(large), np.zeros((2000, 3000, 3), np.uint8))
    assert load_picture(str(large)).shape == (1280, 1920, 3)


@pytest.mark.gl
def test_the_live_painter_takes_pictures_as_the_wish_says(renderer, tmp_path):
    painter = LivePainter(renderer, load_face_model(asset("face_model.npz")), SIZE_PX)
    cast = Cast("nora", None)
    path = tmp_path / "wall.png"
    cv2.imwrite(str(path), np.full((30, 40, 3), (200, 100, 50), np.uint8))
    rgb = np.full((48, 64, 3), (50, 150, 250), np.uint8)
    frame = Frame(rgb, rgb[..., 0].copy(), 0.0, 0)

    def corner(look, frame=frame):
        return painter.draw(LiveWish(cast, resting(), None, frame, None, look))[0, 0].astype(int)

    studio = corner(AvatarLook())
    assert tuple(corner(backed("picture", picture=str(path)))) == (50, 100, 200, 255)
    shade = corner(backed("blurred"))
    np.testing.assert_allclose(shade[:3] / shade[2], [0.2, 0.6, 1.0], atol=0.02)
    # Before the first frame there is nothing to blur.
    np.testing.assert_array_equal(corner(backed("blurred"), None), studio)
    night = corner(AvatarLook(lights="night"))
    assert night[:3].sum() < 0.9 * studio[:3].sum()
    assert painter.drawn.scale == 1.0
    assert painter.drawn.samples == renderer.samples(4)


@pytest.mark.gl
def test_a_picture_drawn_smaller_is_as_large_and_nearly_the_same(painter, nora):
    look = backed("color", color=(90, 90, 90))
    framing = framed(nora, look, size_px=(320, 240))
    wish = AvatarWish(nora, framing, STILL, np.zeros((2, 2)), look=look)
    full, quick = painter.draw(wish).astype(int), painter.draw(wish, 0.65).astype(int)
    assert quick.shape == full.shape
    off = np.abs(full - quick)[..., :3].max(axis=2)
    assert 0 < (off > 40).mean() < 0.02


@pytest.mark.gl
def test_samples_are_what_the_driver_can(renderer):
    assert renderer.samples(0) == 0
    assert renderer.samples(4) == (0 if renderer.software else 4)


# -- posture ---------------------------------------------------------------------------


def body_angles_deg(framing):
    return np.rad2deg(head_angles_from_matrix(framing.body_to_camera[:3, :3]))


def test_the_shoulders_make_a_small_share_of_the_heads_turn(nora):
    yaw, pitch, roll = (
        abs(body_angles_deg(framed(nora, AvatarLook(), angles))[k])
        for k, angles in enumerate(((40, 0, 0), (0, 25, 0), (0, 0, 25)))
    )
    assert 5 < yaw < 12
    assert 0 < pitch < 3
    assert 1 < roll < 5


def test_a_nod_takes_the_head_forward_and_a_tilt_takes_it_aside(nora):
    def joint(angles):
        head = framed(nora, AvatarLook(), angles).head_to_camera
        return head[:3, :3] @ nora.pivot_mm + head[:3, 3]

    rest, down, aside = joint((0, 0, 0)), joint((0, -25, 0)), joint((0, 0, 20))
    assert rest[2] - down[2] > 5  # nearer to the camera
    assert abs(aside[0] - rest[0]) > 4
    assert abs(down[0] - rest[0]) < 0.5


def test_who_leans_aside_takes_the_shoulders_along(nora):
    still, aside = (framed(nora, AvatarLook(), (0, 0, 0), t) for t in (AHEAD_MM, (100, 0, 600)))
    shoulder, hip = (np.array([0.0, y, 80.0]) for y in (130.0, 560.0))
    moved = [
        (f.body_to_camera[:3, :3] @ point + f.body_to_camera[:3, 3])[0]
        for point in (shoulder, hip)
        for f in (still, aside)
    ]
    assert moved[1] - moved[0] > 15
    assert abs(moved[3] - moved[2]) < 0.35 * (moved[1] - moved[0])


# -- looks and quality -----------------------------------------------------------------


def test_a_look_comes_back_from_json_as_it_was():
    look = AvatarLook(0.1, -0.2, 1.5, (0.3, -0.4), "bust", Background("key", key=(1, 2, 3)), "ring",
                      1.2, True, 8)  # fmt: skip
    assert look_from_json(look.to_json(), LIGHTS) == look
    assert look_from_json("rubbish", LIGHTS) == AvatarLook()
    assert set(BACKGROUNDS) >= {Background().kind, "transparent", "key"}


def test_turning_on_and_on_comes_round_and_the_height_has_ends():
    look = AvatarLook()
    for _ in range(100):
        look = look.turned(0.5, 0.5)
        assert abs(look.yaw_rad) <= math.pi + 1e-9
    assert look.pitch_rad == 1.2
    assert look.zoomed(1e9).zoom == 6.0


def count(ladder, took_ms, pictures):
    for _ in range(pictures):
        ladder.count(took_ms)
    return ladder.quality


def test_slow_pictures_are_soon_drawn_smaller_and_quick_ones_better_much_later():
    ladder = Ladder(IN_SOFTWARE)
    assert count(ladder, 17.0, 500) == Quality()  # in time
    assert count(ladder, 30.0, 16) == IN_SOFTWARE[1]
    assert count(ladder, 30.0, 200) == IN_SOFTWARE[-1]
    assert count(ladder, 12.0, 2000) == IN_SOFTWARE[-1]  # good as it is
    assert count(ladder, 5.0, 60) == IN_SOFTWARE[-1]
    assert count(ladder, 5.0, 60) == IN_SOFTWARE[-2]
    assert count(ladder, 5.0, 400) == Quality()


def test_one_slow_picture_changes_nothing():
    ladder = Ladder(ON_CARD)
    for _ in range(30):
        count(ladder, 5.0, 10)
        assert count(ladder, 200.0, 1) == Quality()


def test_a_step_up_that_was_too_much_is_tried_less_and_less_often():
    def pictures_until_up(ladder):
        for k in range(10_000):
            ladder.count(5.0)
            if ladder.quality == Quality():
                return k

    ladder, waits = Ladder(ON_CARD), []
    for _ in range(4):
        count(ladder, 40.0, 15)
        assert ladder.quality == ON_CARD[1]
        waits.append(pictures_until_up(ladder))
    assert waits[0] < 0.7 * waits[1] < 0.49 * waits[2] < 0.35 * waits[3]
