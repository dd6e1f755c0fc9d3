import json
import shutil

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, label

from app.avatars.complexion import skin_texture
from app.avatars.gallery import Gallery
from app.avatars.hair import CUTS
from app.avatars.hairline import above_hairline_mm
from app.avatars.head import holds, neck_loop
from app.avatars.looks import LOOKS, Looks
from app.avatars.painter import AvatarPainter, AvatarWish
from app.avatars.views import Framing, overlay, portrait
from app.avatars.wardrobe import AvatarFileError, load_wardrobe
from app.render.puppet import Puppet, body_below, lids_following
from app.render.renderer import Scene
from app.render.scene import View, placed, studio_lights
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.camera import camera_for, project
from core.face_model import deltas_mm, load_face_model, neutral_mm
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.landmarks import NAMES
from core.records import UserBlendshapes
from tests.app.avatar_pictures import POSES, default_gallery, draw, expression_of, stored
from tests.app.gl import renderer_or_skip, share_off, silhouette_overlap

ASSETS = asset("avatars").parent
UPRIGHT = np.array([1.0, 0, 0, 0])
AHEAD_MM = np.array([0.0, 0.0, 600.0])
NO_GAZE = np.zeros((2, 2))


@pytest.fixture(scope="module")
def model():
    return load_face_model(asset("face_model.npz"))


@pytest.fixture(scope="module")
def gallery():
    return default_gallery()


@pytest.fixture(scope="module")
def avatar(gallery):
    return gallery.built_in(gallery.names[0])


@pytest.fixture(scope="module")
def renderer():
    renderer = renderer_or_skip()
    yield renderer
    renderer.release()


@pytest.fixture(scope="module")
def painter(renderer):
    return AvatarPainter(renderer)


def wxyz(*angles_deg):
    return quaternion_from_matrix(matrix_from_head_angles(*np.deg2rad(angles_deg)))


@pytest.mark.gl
@pytest.mark.parametrize("name", POSES)
def test_an_avatar_looks_like_its_stored_picture(painter, avatar, name):
    picture, expected = draw(painter, avatar, *POSES[name]), stored(name)
    advice = "if this is meant, run python -m tests.app.avatar_pictures and look at the result"
    assert silhouette_overlap(picture, expected) > 0.985, advice
    assert share_off(picture, expected) < 0.06, advice


@pytest.mark.gl
def test_a_wrong_picture_does_not_pass_for_the_right_one(painter, avatar):
    rest = draw(painter, avatar, *POSES["rest"])
    nodded = draw(painter, avatar, (0, 6, 0), (0, 0), {})
    assert share_off(nodded, stored("rest")) > 0.12
    assert silhouette_overlap(rest, stored("surprise")) < 0.97
    assert share_off(rest[:, ::-1], stored("rest")) > 0.12
    # Small but grave: shut eyes are a few pixels of the picture.
    shut = draw(painter, avatar, (0, 0, 0), (0, 0), POSES["blink"][2])
    assert share_off(shut, stored("rest"), levels=24) > 2 * share_off(rest, stored("rest"), 24)


def eye_pixels(renderer, avatar, expression, gaze):
    """Return for the right and left eye which pixels change when it is not drawn."""
    puppet, out = Puppet(renderer, avatar), []
    framing = portrait(avatar, (320, 320), UPRIGHT, AHEAD_MM)
    places = framing.head_to_camera, framing.body_to_camera
    items = puppet.items(expression, gaze, *places)
    whole = renderer.draw(Scene(framing.view, studio_lights(), items)).astype(int)
    for eye in (-2, -1):
        without = [item for item in items if item is not items[eye]]
        other = renderer.draw(Scene(framing.view, studio_lights(), without))
        out.append((whole, np.abs(whole - other).max(axis=2) > 6))
    puppet.release()
    return out


@pytest.mark.gl
def test_a_blink_hides_the_eyeball(renderer, avatar):
    opened = eye_pixels(renderer, avatar, expression_of({}), NO_GAZE)
    shut = eye_pixels(renderer, avatar, expression_of(POSES["blink"][2]), NO_GAZE)
    for (_, seen), (_, hidden) in zip(opened, shut, strict=True):
        assert seen.sum() > 120
        assert hidden.sum() < 0.03 * seen.sum()


@pytest.mark.gl
@pytest.mark.parametrize(("gaze_deg", "axis", "sign"), [((20, 0), 1, 1), ((-20, 0), 1, -1)])
def test_the_pupil_moves_to_the_side_that_the_gaze_names(renderer, avatar, gaze_deg, axis, sign):
    def darkness_center(gaze):
        centers = []
        for picture, mask in eye_pixels(renderer, avatar, expression_of({}), gaze):
            weight = np.where(mask, 255 - picture[..., :3].max(axis=2), 0) ** 4.0
            grid = np.indices(weight.shape)[axis]
            centers.append((weight * grid).sum() / weight.sum())
        return np.array(centers)

    gaze = np.deg2rad(np.array([gaze_deg, gaze_deg], float))
    moved = darkness_center(gaze) - darkness_center(NO_GAZE)
    assert (sign * moved > 1.5).all()


@pytest.mark.gl
@pytest.mark.parametrize(
    "angles_deg", [(0, 0, 0), (45, 0, 0), (-60, 10, 0), (0, 30, 0), (20, -30, 15)]
)
def test_no_hole_and_no_open_end_shows(painter, avatar, angles_deg):
    picture = draw(painter, avatar, angles_deg, (0, 0), {"jawOpen": 1.0}, size_px=(240, 240))
    figure = picture[..., 3] > 127
    regions, count = label(~figure)
    touching = {*regions[0], *regions[:, 0], *regions[:, -1], *regions[-1]} - {0}
    holes = sum((regions == k).sum() for k in range(1, count + 1) if k not in touching)
    # Sky may show through frayed hair, not through a neck.
    assert holes <= 12
    assert figure[-1, 60:180].all()


@pytest.mark.gl
def test_the_overlay_lies_exactly_over_the_source(renderer, model, avatar):
    camera = camera_for((320, 240), 320.0)
    rotation, translation = wxyz(15, -10, 5), np.array([40.0, -20.0, 520.0])
    framing = overlay(avatar, camera, rotation, translation)
    puppet = Puppet(renderer, avatar)
    items = puppet.items(expression_of({}), NO_GAZE, framing.head_to_camera, framing.body_to_camera)
    depth = renderer.depth_mm(Scene(framing.view, studio_lights(), items))
    puppet.release()
    for name in ("nose_tip", "lip_lo_mid", "R_brow_3", "L_brow_3"):
        point = avatar.neutral_mm[model.landmark_vertices[NAMES.index(name)]]
        seen = framing.head_to_camera[:3, :3] @ point + translation
        column, row = np.round(project(camera, seen)).astype(int)
        # A brow lies on a slope: a pixel is 1.6 mm wide here.
        assert abs(depth[row, column] - seen[2]) < 2.5, name


def test_a_head_at_the_side_that_faces_the_camera_is_seen_from_the_front(avatar):
    ahead = portrait(avatar, (200, 200), UPRIGHT, AHEAD_MM)
    facing = wxyz(-np.rad2deg(np.arctan2(250, 600)), 0, 0)
    aside = portrait(avatar, (200, 200), facing, np.array([250.0, 0, 600]))
    np.testing.assert_allclose(aside.head_to_camera, ahead.head_to_camera, atol=1e-9)


def test_a_portrait_follows_a_step_aside_a_little_and_not_out_of_the_picture(avatar):
    def place(x_mm):
        moved = AHEAD_MM + [x_mm, 0, 0]
        head = portrait(avatar, (200, 200), UPRIGHT, moved, AHEAD_MM).head_to_camera
        return (head @ np.append(avatar.pivot_mm, 1))[0]

    assert 0 < place(40) - place(0) < 40
    assert abs(place(2000) - place(0)) < 120


def test_the_neck_joins_skull_and_body_in_every_pose(avatar):
    for angles_deg in ((60, 0, 0), (0, 35, 20), (-30, -30, 0)):
        head = placed(matrix_from_head_angles(*np.deg2rad(angles_deg)), np.array([5.0, 8, 700]))
        body = body_below(avatar, head, np.eye(3))
        joint = np.append(avatar.pivot_mm, 1)
        np.testing.assert_allclose(head @ joint, body @ joint, atol=1e-9)


def test_the_body_holds_the_neck_and_no_landmark(model):
    share = holds(model)
    assert share[neck_loop(model)].min() > 0.5
    assert share[model.landmark_vertices].max() == 0
    assert share[model.contour_strips[model.contour_strips >= 0]].max() == 0


def test_lids_follow_the_gaze_down_and_up():
    def lids(pitch, blink=0.0):
        gaze = np.array([[0, pitch], [0, pitch]])
        shapes = {"eyeBlinkLeft": blink, "eyeBlinkRight": blink}
        out = lids_following(expression_of(shapes), gaze)
        names = ("eyeBlinkLeft", "eyeBlinkRight", "eyeWideLeft", "eyeWideRight")
        return [out[EXPRESSION_NAMES.index(name)] for name in names]

    assert lids(0.0) == [0, 0, 0, 0]
    assert min(lids(-0.4)[:2]) > 0.2
    assert min(lids(0.4)[2:]) > 0.1
    # A tracked blink contains the follow already; a shut eye does not widen.
    assert lids(-0.4, blink=0.8)[:2] == [0.8, 0.8]
    assert lids(0.4, blink=1.0)[2:] == [0, 0]


def test_the_users_avatar_has_the_users_head_and_shapes(model, gallery):
    identity = np.zeros(model.n_identities)
    identity[:4] = 1.2
    user = UserBlendshapes(identity, neutral_mm(model, identity), deltas_mm(model, identity))
    mine = gallery.of_user(user, Looks(hair_style="bald"))
    n = len(user.neutral_mm)
    np.testing.assert_allclose(mine.neutral_mm[:n], user.neutral_mm, atol=1e-4)
    jaw = EXPRESSION_NAMES.index("jawOpen")
    entries = slice(*mine.delta_starts[jaw : jaw + 2])
    dense = np.zeros_like(mine.neutral_mm)
    dense[mine.delta_rows[entries]] = mine.deltas_mm[entries]
    np.testing.assert_allclose(dense[:n], user.deltas_mm[jaw], atol=0.01)


@pytest.mark.parametrize("style", ["bald", *CUTS])
def test_every_hair_style_makes_a_whole_avatar(model, gallery, style):
    looks = Looks(hair_style=style)
    avatar = gallery.of_identity(np.zeros(model.n_identities), looks, style)
    strands = [part for part in avatar.parts if part.material.repeated and part.extra[0, 0] == 0]
    assert len(strands) == {"bald": 0, "bob": 2}.get(style, 1)
    for part in avatar.parts:
        assert np.isfinite(avatar.neutral_mm[part.rows]).all()
        assert part.material.repeated or (part.uv.min() >= 0 and part.uv.max() <= 1)
        assert (part.extra[:, :2] >= 0).all()
        assert (part.extra[:, :2] <= 1).all()


def test_hair_lies_over_the_skull_and_not_over_the_face(model):
    spots = dict(zip(NAMES, model.mean_mm[model.landmark_vertices], strict=False))
    assert above_hairline_mm(spots["R_brow_3"]) < -20
    assert above_hairline_mm(np.array([0, -100.0, 70])) > 20
    left, right = np.array([[40.0, -60, 20], [-40, -60, 20]])
    assert above_hairline_mm(left) == above_hairline_mm(right)


@pytest.fixture(scope="module")
def skins():
    folder = ASSETS / "textures" / "skin"
    names = ("porcelain", "deep", "light", "light old")
    return {name: skin_texture(folder, LOOKS[name], 1024) for name in names}


def test_skin_has_the_tone_that_was_asked_for(skins):
    forehead = (slice(225, 250), slice(490, 535))
    for name in ("porcelain", "deep"):
        mean = skins[name][forehead][..., :3].mean(axis=(0, 1))
        np.testing.assert_allclose(mean, LOOKS[name].skin, atol=14)


def test_age_makes_the_skin_less_even(skins):
    def roughness(name):
        cheeks = skins[name][350:410, 400:620, 1].astype(np.float32)
        return (cheeks - gaussian_filter(cheeks, 8)).std()

    assert roughness("light old") > 1.2 * roughness("light")


def test_the_skin_has_no_seam(model, skins):
    """Both sides of a cut in the texture show the same colour."""
    skin = model.part_triangles("skin")
    corner, uv = model.triangles[skin].reshape(-1), model.uv[skin].reshape(-1, 2)
    order = np.argsort(corner, kind="stable")
    corner, uv = corner[order], uv[order]
    split = (corner[1:] == corner[:-1]) & (np.abs(uv[1:] - uv[:-1]).max(axis=1) > 0.05)
    # Only what can be seen: not the sockets behind the eyes and the throat.
    outside = (model.mean_mm[corner[1:], 2] > 60) | (np.abs(model.mean_mm[corner[1:], 0]) > 60)
    pairs = np.flatnonzero(split & outside)
    assert len(pairs) > 10
    pixels = np.clip((uv * 1024).astype(int), 1, 1022)
    values = skins["light"][pixels[:, 1], pixels[:, 0], :3].astype(int)
    apart = np.abs(values[pairs] - values[pairs + 1]).max(axis=1)
    assert np.median(apart) < 14


def test_there_are_five_tones_young_and_old():
    tones = {name for name in LOOKS if not name.endswith(" old")}
    assert len(tones) == 5
    assert {f"{name} old" for name in tones} <= set(LOOKS)
    for name in tones:
        assert LOOKS[f"{name} old"].age > LOOKS[name].age + 0.5


def test_the_painted_files_are_small():
    files = [path for path in (ASSETS / "textures").rglob("*") if path.is_file()]
    assert len(files) >= 12
    assert sum(path.stat().st_size for path in files) < 4_000_000


def copied_assets(folder):
    for name in ("avatars", "textures", "performer"):
        shutil.copytree(ASSETS / name, folder / name)
    return folder


def test_files_of_another_face_model_are_refused(model, tmp_path):
    folder = copied_assets(tmp_path / "assets")
    np.savez(folder / "avatars" / "openness.npz", openness=np.zeros(7, np.uint8))
    with pytest.raises(AvatarFileError, match=r"7 vertices where the face model has \d+"):
        load_wardrobe(folder, model)
    (folder / "avatars" / "people.json").write_text(json.dumps({"ann": [1.0, 2.0]}))
    with pytest.raises(AvatarFileError, match="2 weights for ann"):
        _ = Gallery(folder, model).names


def test_a_missing_texture_is_named(model, tmp_path):
    folder = copied_assets(tmp_path / "assets")
    (folder / "textures" / "mouth.jpg").write_bytes(b"not a picture")
    with pytest.raises(AvatarFileError, match=r"mouth\.jpg: found no picture"):
        load_wardrobe(folder, model)


@pytest.mark.gl
def test_the_painter_draws_over_its_studio_or_over_nothing(painter, avatar):
    framing = portrait(avatar, (120, 120), UPRIGHT, AHEAD_MM)
    framing = Framing(View(framing.view.camera), framing.head_to_camera, framing.body_to_camera)
    wishes = [
        AvatarWish(avatar, framing, expression_of({}), NO_GAZE, transparent=transparent)
        for transparent in (False, True)
    ]
    studio, alone = (painter.draw(wish) for wish in wishes)
    assert (studio[..., 3] == 255).all()
    assert alone[2, 2, 3] == 0
    inside = alone[..., 3] == 255
    np.testing.assert_array_equal(studio[inside], alone[inside])
