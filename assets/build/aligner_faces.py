"""Renders people and says what the landmark network sees in them, for aligner_bias.

Everything is drawn at random that changes what the network sees: head, skin and hair, light,
room, lens, distance, pose, gaze and expression; and a webcam spoils the pictures.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.avatars.build import Head, dressed
from app.avatars.looks import LOOKS
from app.avatars.wardrobe import load_wardrobe
from app.performer.lights import LIGHTS
from app.performer.room import paint_room
from app.performer.sensor import Sensor, SensorSettings
from app.render.puppet import Puppet, body_below, lids_following
from app.render.renderer import Renderer, Scene
from app.render.scene import View, placed
from app.resources import asset
from core.alignment import FaceAligner
from core.arkit import EXPRESSION_NAMES
from core.camera import camera_for, project
from core.face_model import FaceModel, deltas_mm, neutral_mm
from core.geometry import matrix_from_head_angles
from core.records import U8, Camera
from core.setup_plan import STANDARD_WEIGHTS, coefficients

#: People of one roll of the dice, pictures of each, and the spread of their identity weights.
N_PEOPLE, N_PICTURES, SPREAD = 20, 34, 0.9
SIZE_PX = (640, 480)
CAMERAS = [camera_for(SIZE_PX, focal_px) for focal_px in (480.0, 540.0, 620.0, 700.0, 800.0)]
#: The face is so large in the picture: distance over focal length, in mm per px.
MM_PER_PX = (0.6375, 1.275)
#: Pictures are taken so far apart in time, which drives exposure and focus.
INTERVAL_S = 0.37


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """What is to be seen in one picture: camera, pose, gaze, and expression as drawn."""

    camera: Camera
    pose: np.ndarray
    gaze_rad: np.ndarray
    expression: np.ndarray


class Studio:
    """Owns the renderer and all that people share; the seed decides everything."""

    def __init__(self, model: FaceModel, seed: int) -> None:
        self._model, self._rng = model, np.random.default_rng(seed)
        self._wardrobe, self._renderer = load_wardrobe(asset("."), model), Renderer()
        self._looks, self._lights = list(LOOKS.values()), list(LIGHTS.values())
        self._rooms = [paint_room(SIZE_PX, room) for room in range(4)]
        self._sensor = Sensor(SIZE_PX, SensorSettings(), seed)

    def samples(self, aligner: FaceAligner) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield the network's points (478, 3) and the true landmarks (60, 2) of each picture."""
        for person in range(N_PEOPLE):
            identity = self._rng.normal(0, SPREAD, self._model.n_identities)
            model = self._model
            head = Head(model, neutral_mm(model, identity), deltas_mm(model, identity))
            looks = self._looks[self._rng.integers(len(self._looks))]
            avatar = dressed(head, looks, self._wardrobe, str(person))
            puppet = Puppet(self._renderer, avatar)
            for number in range(N_PICTURES):
                shot = draw_shot(self._rng)
                body = body_below(avatar, shot.pose, np.eye(3))
                items = puppet.items(shot.expression, shot.gaze_rad, shot.pose, body)
                clean = self._picture(shot, items)
                taken = person * N_PICTURES + number
                rgb = self._sensor.develop(clean, number * INTERVAL_S, taken)
                found = aligner.first(rgb)
                if found is not None:
                    mesh = np.column_stack([found.mesh_px, found.mesh_depth_px])
                    yield mesh.astype(np.float32), true_px(head, shot).astype(np.float32)
            puppet.release()

    def release(self) -> None:
        """Free the renderer."""
        self._renderer.release()

    def _picture(self, shot: Shot, items: list) -> U8:
        light = self._lights[self._rng.integers(len(self._lights))]
        room = self._rooms[self._rng.integers(len(self._rooms))]
        drawn = self._renderer.draw(Scene(View(shot.camera), light, items, room))
        return np.ascontiguousarray(drawn[..., :3])


def draw_shot(rng: np.random.Generator) -> Shot:
    """Return a random picture to take."""
    camera = CAMERAS[rng.integers(len(CAMERAS))]
    angles_deg = rng.uniform(-68, 68), rng.normal(0, 14), rng.normal(0, 8)
    distance_mm = rng.uniform(*MM_PER_PX) * camera.focal_px
    place = np.array([rng.normal(0, 40), rng.normal(-10, 30), distance_mm])
    pose = placed(matrix_from_head_angles(*np.deg2rad(angles_deg)), place)
    gaze_rad = np.tile(rng.normal(0, 0.15, 2), (2, 1))
    return Shot(camera, pose, gaze_rad, draw_expression(rng))


def draw_expression(rng: np.random.Generator) -> np.ndarray:
    """Return coefficients (46,): nothing, some of the prompted expressions, and single shapes."""
    out, prompted = np.zeros(len(EXPRESSION_NAMES)), list(STANDARD_WEIGHTS.values())
    kind = rng.integers(4)
    if kind >= 1:
        for _ in range(rng.integers(1, 3)):
            strength = rng.uniform(0.2, 1.0)
            out += strength * coefficients(prompted[rng.integers(len(prompted))])
    if kind >= 2:
        for single in rng.integers(0, len(out), rng.integers(1, 4)):
            out[single] += rng.uniform(0.1, 0.7)
    blinks, lids = rng.random() < 0.15, rng.uniform(0.2, 1)
    out[:2] += blinks * lids
    return np.clip(out, 0, 1)


def true_px(head: Head, shot: Shot) -> np.ndarray:
    """Return where the 60 internal landmarks of a head really are in a picture."""
    rotation, place = shot.pose[:3, :3], shot.pose[:3, 3]
    rows = head.model.landmark_vertices
    expression = lids_following(shot.expression, shot.gaze_rad)
    points = head.neutral_mm[rows] + np.tensordot(expression, head.deltas_mm[:, rows], 1)
    return project(shot.camera, points @ rotation.T + place)
