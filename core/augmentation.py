"""What happens to the grey levels while training: other exposure, a lamp, something in the way.

The pictures of a setup show one light. Instead of copying them under other lights, each training
sample carries a few numbers, by which the sampler changes the grey levels that it reads. [Cao13]
has none of this and names light and occlusion as its limits.
"""

from dataclasses import dataclass

import numpy as np

from core.camera import project
from core.kernels.shading import draw_normals
from core.records import F32, I32, Camera, FloatArray, freeze

#: The normal maps have one pixel for so many of the picture.
NORMAL_STEP = 4


@dataclass(frozen=True, slots=True)
class AugmentationSettings:
    """How strongly training samples are disturbed.

    Attributes:
        exposure: Scale of the random gain, gamma and brightness gradient; 0: none.
        lamp_share: Share of the samples that are lit again by a lamp from the side.
        occluded_share: Share of the samples with something in front of the face.
    """

    exposure: float = 1.0
    lamp_share: float = 0.5
    occluded_share: float = 0.4


@dataclass(frozen=True, slots=True, eq=False)
class Augmentation:
    """The disturbance of every training sample; the columns are listed in kernels.disturbance.

    Attributes:
        normals: (N, h, w, 3) unit normals of the face in every picture, coarse.
        faces: (N, 3) centre and radius of the face in every picture, px.
        exposure: (S, 4) gain, gamma, gradient in x and y per face radius.
        lamp: (S, 5) direction to the lamp, ambient light, strength (0: no lamp).
        occluder: (S, 10) centre, half axes (0: none), cosine, sine of the turn, picture that it
            is cut from, shift in that picture, brightness.
    """

    normals: F32
    faces: F32
    exposure: F32
    lamp: F32
    occluder: F32

    def __post_init__(self) -> None:
        freeze(
            self,
            normals=(np.float32, ("N", "h", "w", 3)),
            faces=(np.float32, ("N", 3)),
            exposure=(np.float32, ("S", 4)),
            lamp=(np.float32, ("S", 5)),
            occluder=(np.float32, ("S", 10)),
        )


def draw_augmentation(
    camera: Camera,
    points_mm: FloatArray,
    triangles: I32,
    n_samples: int,
    rng: np.random.Generator,
    settings: AugmentationSettings,
) -> Augmentation:
    """Draw a disturbance for every training sample.

    Args:
        camera: The camera of the pictures.
        points_mm: (N, Q, 3) shape of every picture.
        triangles: (M, 3) triangulation of the shape points.
        n_samples: S.
        rng: Source of the draw.
        settings: How strong.
    """
    return Augmentation(
        normal_maps(camera, points_mm, triangles),
        face_circles(camera, points_mm).astype(np.float32),
        _exposures(n_samples, rng, settings.exposure),
        _lamps(n_samples, rng, settings.lamp_share),
        _occluders(n_samples, len(points_mm), camera.size_px, rng, settings.occluded_share),
    )


def face_circles(camera: Camera, points_mm: FloatArray) -> FloatArray:
    """Return the centre and the mean radius of faces (N, Q, 3) in their pictures, (N, 3) px."""
    points = project(camera, points_mm)
    center = points.mean(axis=1)
    radius = np.sqrt(((points - center[:, None]) ** 2).sum(axis=2).mean(axis=1))
    return np.concatenate([center, radius[:, None]], axis=1)


def normal_maps(camera: Camera, points_mm: FloatArray, triangles: I32) -> F32:
    """Return the surface normals seen in every picture, (N, h, w, 3), pointing to the camera."""
    width, height = camera.size_px
    normals = _vertex_normals(points_mm, triangles)
    size = (len(points_mm), -(-height // NORMAL_STEP), -(-width // NORMAL_STEP))
    maps = np.zeros((*size, 3), np.float32)
    places = (project(camera, points_mm) / NORMAL_STEP).astype(np.float32)
    draw_normals(places, normals.astype(np.float32), triangles, maps)
    return maps


def _vertex_normals(points_mm: FloatArray, triangles: I32) -> FloatArray:
    """Return unit normals (N, Q, 3) that point to the camera's side of the face."""
    a, b, c = (points_mm[:, triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    # The triangulation need not be wound the same way all over: z grows away from the camera.
    faces *= -np.sign(faces[..., 2:].mean(axis=0, keepdims=True))
    touches = np.zeros((points_mm.shape[1], len(triangles)))
    touches[triangles.T, np.arange(len(triangles))] = 1
    normals = np.einsum("qm,nmc->nqc", touches, faces, optimize=True)
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    return np.asarray(normals / np.maximum(lengths, 1e-9))


def _exposures(n_samples: int, rng: np.random.Generator, strength: float) -> F32:
    gain = np.exp(rng.normal(0, 0.3 * strength, n_samples))
    gamma = np.exp(rng.normal(0, 0.2 * strength, n_samples))
    gradient = rng.normal(0, 0.2 * strength, (n_samples, 2))
    return np.column_stack([gain, gamma, gradient]).astype(np.float32)


def _lamps(n_samples: int, rng: np.random.Generator, share: float) -> F32:
    # From anywhere on the camera's half of the sphere; the camera looks along +z.
    direction = rng.normal(size=(n_samples, 3))
    direction[:, 2] = -0.7 * np.abs(direction[:, 2])
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    ambient = rng.uniform(0.3, 0.8, n_samples)
    strength = (1.3 - ambient) * (rng.random(n_samples) < share)
    return np.column_stack([direction, ambient, strength]).astype(np.float32)


def _occluders(
    n_samples: int, n_images: int, size_px: tuple[int, int], rng: np.random.Generator, share: float
) -> F32:
    """Cut pieces out of the pictures themselves: they have skin, hair, cloth and walls."""
    there = rng.random(n_samples) < share
    center = rng.uniform(-1.6, 1.6, (n_samples, 2))
    axes = rng.uniform(0.25, 0.9, (n_samples, 2)) * there[:, None]
    turn = rng.uniform(0, np.pi, n_samples)
    image = rng.integers(0, n_images, n_samples)
    shift = rng.uniform(-0.5, 0.5, (n_samples, 2)) * size_px
    brightness = rng.uniform(0.3, 1.4, n_samples)
    columns = [center, axes, np.cos(turn), np.sin(turn), image, shift, brightness]
    return np.column_stack(columns).astype(np.float32)
