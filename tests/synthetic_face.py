"""A face of 77 points with a painted skin, drawn by interpolation: pictures with known shapes."""

from collections.abc import Generator
from dataclasses import dataclass
from functools import cache
from typing import TypeVar

import numpy as np
from scipy.interpolate import LinearNDInterpolator
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.spatial import Delaunay

from core.augmentation import AugmentationSettings
from core.camera import camera_for, project
from core.geometry import matrix_from_head_angles
from core.point_drawing import PointSettings
from core.records import U8, Camera, FloatArray, Progress
from core.regressor import FernRegressor
from core.regressor_trainer import TrainSettings, train
from core.training_set import TrainingSet, TrainingSetSettings, make_training_set

N_POINTS = 77
TEXTURE_PX = 256
SMALL = TrainSettings(
    n_stages=4,
    n_ferns=60,
    n_numbers=12,
    shrinkage=50.0,
    points=PointSettings(n_points=60, n_cells=12, cell_size=16),
)

T = TypeVar("T")


@dataclass(frozen=True)
class SyntheticFace:
    camera: Camera
    flat: FloatArray  # (Q, 2) points in the texture, within the unit disc
    texture: FloatArray  # (TEXTURE_PX, TEXTURE_PX)
    background: FloatArray  # (H, W)

    @property
    def triangles(self):
        return Delaunay(self.flat).simplices.astype(np.int32)

    def shape(self, angles_rad, expression, translation_mm) -> FloatArray:
        """Two expressions: the lower part drops, the upper part rises."""
        u, v = self.flat.T
        drop = 14 * expression[0] * np.clip(v, 0, None) - 8 * expression[1] * np.clip(-v, 0, None)
        points = np.stack([62 * u, 75 * v + drop, 45 * (u * u + v * v)], axis=1)
        return points @ matrix_from_head_angles(*angles_rad).T + translation_mm

    def picture(self, points_mm: FloatArray) -> U8:
        width, height = self.camera.size_px
        grid = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1)
        flat = LinearNDInterpolator(project(self.camera, points_mm), self.flat)(grid)
        place = (flat[..., ::-1] + 1) / 2 * (TEXTURE_PX - 1)
        skin = map_coordinates(self.texture, np.nan_to_num(np.moveaxis(place, -1, 0)), order=1)
        seen = np.where(np.isfinite(flat[..., 0]), skin, self.background)
        return np.clip(seen, 0, 255).astype(np.uint8)

    def random_shapes(self, n: int, rng: np.random.Generator) -> FloatArray:
        angles = rng.uniform(-0.2, 0.2, (n, 3))
        expressions = rng.uniform(0, 1, (n, 2))
        places = rng.uniform([-25, -20, 560], [25, 20, 640], (n, 3))
        return np.array([self.shape(*row) for row in zip(angles, expressions, places, strict=True)])


@dataclass(frozen=True)
class SmallWorld:
    """A face, a few pictures of it, and a small regressor trained on them."""

    face: SyntheticFace
    training_set: TrainingSet
    regressor: FernRegressor
    progress: list[Progress]


@cache
def small_world() -> SmallWorld:
    rng = np.random.default_rng(7)
    face = make_face(rng)
    shapes = face.random_shapes(20, rng)
    pictures = [face.picture(shape) for shape in shapes]
    calm = TrainingSetSettings(augmentation=AugmentationSettings(0.0, 0.0, 0.0))
    samples = make_training_set(pictures, face.camera, shapes, rng, calm, face.triangles)
    regressor, progress = finish(train(samples, rng, SMALL))
    return SmallWorld(face, samples, regressor, progress)


def finish(steps: Generator[Progress, None, T]) -> tuple[T, list[Progress]]:
    """Return what a generator returns and all that it yielded."""
    yielded = []
    while True:
        try:
            yielded.append(next(steps))
        except StopIteration as end:
            return end.value, yielded


def make_face(rng: np.random.Generator, size_px: tuple[int, int] = (240, 180)) -> SyntheticFace:
    turn = np.arange(N_POINTS) * np.pi * (3 - np.sqrt(5))
    radius = np.sqrt((np.arange(N_POINTS) + 0.5) / N_POINTS)
    flat = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)
    texture = _noise(rng, (TEXTURE_PX, TEXTURE_PX), 14)
    background = _noise(rng, size_px[::-1], 5)
    camera = camera_for(size_px, 600 * size_px[0] / 640)
    return SyntheticFace(camera, flat, texture, background)


def _noise(rng: np.random.Generator, shape: tuple[int, int], blur_px: float) -> FloatArray:
    smooth = gaussian_filter(rng.normal(size=shape), blur_px)
    return np.clip(128 + 55 * smooth / smooth.std(), 0, 255)
