"""Pictures of a head turned further than in the setup, made from the setup's own pictures.

The prompts go from 30 degrees of yaw straight to 60, where the generic aligner already loses many
faces, and people who make a video seldom turn further than 30. A regressor knows how a face looks
only at the poses that it was shown: tracking then breaks down beyond them. The shape of a picture
is known in 3D, so the picture can be drawn as if the head had turned further the way it turned
already: all that is seen then was seen before. [Cao13] has none of this.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.camera import project
from core.geometry import matrix_from_rotation_vector
from core.kernels.turning import draw_moved
from core.records import I32, U8, Camera, FloatArray

#: What lies around a face moves with its rim, as far out as this many face radii.
RIM_RADII = 0.9


@dataclass(frozen=True, slots=True)
class TurnSettings:
    """Which pictures are drawn turned further, and how far.

    Attributes:
        further_deg: One more picture for each of these angles; none: the paper.
        from_deg: Angle between face and line of sight from which a picture is used.
        limit_deg: No face is turned beyond this angle.
        n_guesses: H of these pictures, fewer than of those that were taken.
        guess_turn_rad: Standard deviation of the rotation of a guess about each axis. Larger than
            for other pictures: with little to look at, a regressor that knows only small errors
            lets a turned head slip back towards the poses that it knows well.
    """

    further_deg: tuple[float, ...] = (12.0, 24.0, 36.0)
    from_deg: float = 20.0
    limit_deg: float = 72.0
    n_guesses: int = 2
    guess_turn_rad: float = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class TurnedViews:
    """Pictures that were never taken.

    Attributes:
        images: K pictures (H, W).
        points_mm: (K, Q, 3) their shapes.
        origin: (K,) the picture that each was made from.
    """

    images: tuple[U8, ...]
    points_mm: FloatArray
    origin: I32


def turned_views(
    images_gray: Sequence[U8],
    camera: Camera,
    points_mm: FloatArray,
    triangles: I32,
    settings: TurnSettings,
) -> TurnedViews:
    """Return the pictures in which heads are turned further the way they are turned already.

    Args:
        images_gray: N pictures (H, W).
        camera: Their camera.
        points_mm: (N, Q, 3) shapes in the camera frame.
        triangles: (M, 3) triangulation of the shape points.
        settings: Which, how far.
    """
    around = _with_rim(triangles, points_mm.shape[1])
    images, shapes, origin = [], [np.empty((0, *points_mm.shape[1:]))], []
    for n, (image, points) in enumerate(zip(images_gray, points_mm, strict=True)):
        axis, angle_deg = turn_of(points)
        for further_deg in settings.further_deg:
            if angle_deg < settings.from_deg or angle_deg + further_deg > settings.limit_deg:
                continue
            center = points.mean(axis=0)
            rotation = matrix_from_rotation_vector(np.deg2rad(further_deg) * axis)
            turned = (points - center) @ rotation.T + center
            images.append(_drawn(image, camera, points, turned, around))
            shapes.append(turned[None])
            origin.append(n)
    return TurnedViews(tuple(images), np.concatenate(shapes), np.array(origin, np.int32))


def turn_of(points_mm: FloatArray) -> tuple[FloatArray, float]:
    """Return how a face is turned from the line of sight: unit axis (3,) and angle in degrees.

    A face's own direction is that in which its points spread least.
    """
    center = points_mm.mean(axis=0)
    facing = np.linalg.svd(points_mm - center, full_matrices=False)[2][2]
    back = -center / np.linalg.norm(center)
    facing *= 1.0 if facing @ back >= 0 else -1.0
    axis = np.cross(back, facing)
    sine = float(np.linalg.norm(axis))
    return axis / max(sine, 1e-12), float(np.rad2deg(np.arctan2(sine, facing @ back)))


def _with_rim(triangles: I32, n_points: int) -> I32:
    """Return triangles over 3 Q points: a face, and the strip from its rim outwards.

    The points Q ... 2Q - 1 lie at the face's points, but behind all of the face; 2Q ... 3Q - 1
    are their counterparts further out.
    """
    edges = np.sort(np.concatenate([triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]))
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    i, j = edges[uses == 1].T
    inner, outer = n_points, 2 * n_points
    strip = [[i + inner, j + inner, i + outer], [j + inner, j + outer, i + outer]]
    corners = [np.stack(one, axis=1) for one in strip]
    return np.concatenate([*corners, triangles]).astype(np.int32)


def _drawn(
    image: U8, camera: Camera, points_mm: FloatArray, turned_mm: FloatArray, around: I32
) -> U8:
    """Return a picture with its face moved from one shape to another."""
    source, target = project(camera, points_mm), project(camera, turned_mm)
    from_middle = source - source.mean(axis=0)
    radius = np.sqrt(np.mean(np.sum(from_middle**2, axis=1)))
    lengths = np.linalg.norm(from_middle, axis=1, keepdims=True)
    outwards = RIM_RADII * radius * from_middle / np.maximum(lengths, 1e-9)
    behind = np.full(2 * len(points_mm), 2 * turned_mm[:, 2].max())
    out = image.copy()
    draw_moved(
        image,
        np.concatenate([source, source, source + outwards]).astype(np.float32),
        np.concatenate([target, target, target + outwards]).astype(np.float32),
        np.concatenate([turned_mm[:, 2], behind]).astype(np.float32),
        around,
        np.full(image.shape, np.inf, np.float32),
        out,
    )
    return out
