"""What covers a drawn face, who else is there, and where it comes back."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.cover_watch import CoverSettings, CoverWatch
from core.face_keeper import FaceKeeper, KeeperSettings, Unwatched
from core.landmark_flow import FlowSettings, LandmarkFollower
from core.landmarks import N_INTERNAL, REGION_NAMES
from core.mean_face import load_mean_face
from core.records import Frame
from core.region_check import region_means
from tests.core.followed_face import (
    _MEAN_FACE,
    SIZE_PX,
    alignment_of,
    drawn_face,
    face_mesh,
    points_of,
)

MESH = face_mesh()
FPS = 30.0
NOISE = np.random.default_rng(5).integers(0, 5, (SIZE_PX[1], SIZE_PX[0], 3), dtype=np.uint8)
SKIN = np.array([1.05, 0.95, 0.85])


def picture_of(mesh, level=1.0, seed=3):
    """A coloured picture (H, W, 3) of the drawn face, under more or less light."""
    gray = drawn_face(points_of(mesh), seed=seed)[..., None].astype(float)
    return np.clip(gray * SKIN * level, 0, 255).astype(np.uint8)


def covered(picture, mesh, color=(70, 90, 160), low=0.55, high=1.2):
    """The same with something before the lower part of the face."""
    x, y = points_of(mesh)[:N_INTERNAL].T
    top, bottom = (int(y.min() + share * np.ptp(y)) for share in (low, high))
    out = picture.copy()
    out[top:bottom, int(x.min()) - 20 : int(x.max()) + 20] = color
    return out


def shifted(mesh, x_px, scale=1.0):
    out = mesh.copy()
    middle = mesh[:, :2].mean(axis=0)
    out[:, :2] = (mesh[:, :2] - middle) * scale + middle + [x_px, 0]
    return out


class Room:
    """An aligner before which faces are put: what the network sees, and what the detector finds."""

    def __init__(self, mesh=MESH):
        self.seen, self.others, self.scale, self.searches = mesh, [], 1.0, 0

    def _at(self, mesh):
        scale = float(np.ptp(mesh[:, 0]) / np.ptp(MESH[:, 0]))
        return replace(alignment_of(mesh), px_per_mm=scale)

    def follow(self, rgb, previous):
        return None if self.seen is None else self._at(self.seen)

    def check(self, rgb, landmarks_px):
        return self.follow(rgb, None)

    def faces(self, rgb, near_px):
        self.searches += 1
        for mesh in self.others:
            yield self._at(mesh)


class Scene:
    """A keeper that has watched a face for two seconds."""

    def __init__(self):
        self.room, self.index = Room(), 0
        watch = CoverWatch(load_mean_face(_MEAN_FACE), CoverSettings(patience_s=3.0))
        self.keeper = FaceKeeper(self.room, watch)
        self.film(picture_of(MESH), 45)

    def film(self, picture, n_frames=1):
        for _ in range(n_frames):
            rgb = cv2.add(picture, np.roll(NOISE, self.index, axis=0))
            frame = Frame(rgb, rgb[..., 1].copy(), self.index / FPS, self.index)
            self.index += 1
            found = self.keeper.follow(frame, None)
        return found


def regions(found):
    return dict(zip(REGION_NAMES, region_means(found.landmarks.confidence), strict=True))


@pytest.fixture
def scene():
    return Scene()


def test_a_face_that_is_seen_keeps_its_confidence(scene):
    found = scene.film(picture_of(MESH))
    assert scene.keeper.covered < 0.02
    assert min(regions(found).values()) > 0.5


def test_a_cup_before_the_mouth_takes_the_confidence_of_the_mouth_alone(scene):
    trust = regions(scene.film(covered(picture_of(MESH), MESH)))
    assert trust["mouth"] < 0.1
    assert min(trust["brows"], trust["eye_right"], trust["eye_left"]) > 0.8
    assert 0.1 < scene.keeper.covered < 0.6
    assert regions(scene.film(picture_of(MESH)))["mouth"] > 0.8


def test_what_stays_before_the_face_for_long_is_part_of_it(scene):
    bearded = covered(picture_of(MESH), MESH)
    assert regions(scene.film(bearded, 80))["mouth"] < 0.1
    assert regions(scene.film(bearded, 30))["mouth"] > 0.8


@pytest.mark.parametrize("level", [0.5, 0.75, 1.3])
def test_other_exposure_is_no_cover(scene, level):
    scene.film(picture_of(MESH, level))
    assert scene.keeper.covered < 0.05


def test_light_from_a_side_is_no_cover(scene):
    shade = np.exp(np.linspace(-0.5, 0.5, SIZE_PX[0]))[None, :, None]
    scene.film(np.clip(picture_of(MESH) * 0.8 * shade, 0, 255).astype(np.uint8))
    assert scene.keeper.covered < 0.1


def test_a_face_that_is_hidden_is_lost_and_found_at_once_when_it_shows(scene):
    hidden = covered(picture_of(MESH), MESH, low=-0.6, high=1.5)
    stripes = np.arange(SIZE_PX[1]) // 14 % 2 == 0
    hidden[stripes] = hidden[stripes] // 3
    assert scene.film(hidden, 20) is None
    assert scene.film(picture_of(MESH)) is not None


def test_somebody_larger_who_comes_before_the_face_is_not_followed(scene):
    scene.film(covered(picture_of(MESH), MESH), 3)
    passer = shifted(MESH, 40.0, 1.4)
    scene.room.seen, scene.room.others = passer, [passer]
    stranger = picture_of(passer, seed=8)
    assert scene.film(stranger, 30) is None
    # The face shows again beside the passer; the detector finds both.
    scene.room.others = [MESH, passer]
    both = scene.film(picture_of(MESH))
    assert both is not None and both.px_per_mm == pytest.approx(1.0)


def test_after_some_seconds_another_face_is_taken(scene):
    stranger = shifted(MESH, 40.0, 1.5)
    scene.room.seen, scene.room.others = stranger, [stranger]
    picture = covered(picture_of(stranger, seed=8), stranger, (40, 200, 40), -0.5, 0.6)
    waited = [scene.film(picture) is None for _ in range(100)]
    taken = waited.index(False)
    assert KeeperSettings().patience_s <= (taken + 1) / FPS < KeeperSettings().patience_s + 0.2
    assert not any(waited[taken:])


def test_a_face_that_left_is_known_again_on_the_other_side(scene):
    scene.room.seen = None
    assert scene.film(np.full_like(picture_of(MESH), 90), 15) is None
    there = shifted(MESH, -70.0)
    scene.room.others = [there]
    found = scene.film(picture_of(there))
    assert found is not None and found.mesh_px[0, 0] == pytest.approx(there[0, 0])


def test_a_quick_jump_of_the_face_is_followed(scene):
    there = shifted(MESH, 60.0)
    scene.room.seen = there
    assert scene.film(picture_of(there)) is not None and scene.room.searches == 0


def test_forgetting_takes_whoever_is_there(scene):
    scene.keeper.forget()
    assert not scene.keeper.knows and not scene.keeper.cover.any()
    scene.room.seen = shifted(MESH, 50.0, 1.6)
    assert scene.film(picture_of(scene.room.seen, seed=8)) is not None


def test_the_follower_gives_out_what_is_covered():
    room = Room()
    keeper = FaceKeeper(room, CoverWatch(load_mean_face(_MEAN_FACE)))
    follower = LandmarkFollower(room, FlowSettings("every"), keeper=keeper)
    picture, cup = picture_of(MESH), covered(picture_of(MESH), MESH)
    for index in range(65):
        rgb = cup if index == 64 else picture
        followed = follower.step(Frame(rgb, rgb[..., 1].copy(), index / FPS, index))
    trust = region_means(followed.landmarks.confidence)
    assert trust[REGION_NAMES.index("mouth")] < 0.1 < 0.8 < trust[REGION_NAMES.index("brows")]


def test_an_aligner_alone_sees_no_cover():
    seeing = Unwatched(Room())
    rgb = picture_of(MESH)
    frame = Frame(rgb, rgb[..., 1].copy(), 0.0, 0)
    assert seeing.knows and not seeing.cover.any()
    assert seeing.follow(frame, None) is not None
    assert seeing.check(frame, points_of(MESH)) is not None
