"""Pictures and their 3D shapes -> guess and truth pairs that the regressor learns from."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.augmentation import Augmentation, AugmentationSettings, draw_augmentation
from core.geometry import matrix_from_quaternion
from core.landmarks import SHAPE_TRIANGLES
from core.records import F32, I32, U8, Camera, FloatArray, freeze
from core.shape_space import pairwise_rotations
from core.turned_views import TurnSettings, turned_views


@dataclass(frozen=True, slots=True)
class TrainingSetSettings:
    """How a setup is multiplied into training samples [Cao13, training set construction].

    Attributes:
        n_translations: m, shapes made from each picture, itself included: 1 to 9.
        n_similar: G, pictures whose shapes serve as guesses for a picture.
        n_guesses: H, guesses taken from each of them.
        reach_mm: Translation along x and y, and along z.
        same_pose: Turn each guess like the truth; see make_training_set. False: the paper.
        turn_rad: Standard deviation of the rotation of a guess about each axis. Not in the
            paper; widens the range of head rotations from which the regressor recovers.
        turning: Which pictures are also used with the head turned further.
        augmentation: How strongly the grey levels are disturbed.
    """

    n_translations: int = 9
    n_similar: int = 5
    n_guesses: int = 4
    reach_mm: tuple[float, float] = (10.0, 25.0)
    same_pose: bool = True
    turn_rad: float = 0.07
    turning: TurnSettings = field(default_factory=TurnSettings)
    augmentation: AugmentationSettings = field(default_factory=AugmentationSettings)


@dataclass(frozen=True, slots=True, eq=False)
class TrainingSet:
    """N pictures and S training samples in random order; a sample only names its picture.

    Attributes:
        camera: The camera of the pictures.
        images: (N, H, W) uint8; the given ones, then those with the head turned further.
        shapes_mm: (N, Q, 3) the original shape of every picture, camera frame.
        origin: (N,) the given picture that each was made from; a given one is its own.
        translations_mm: (m, 3) of the augmented shapes, the first zero.
        triangles: (M, 3) triangulation of the shape points.
        image: (S,) picture of each sample.
        shift_mm: (S, 3) the matrix M^a of each sample, a translation: moves the sample's shapes
            to where its picture shows them.
        truth_mm: (S, Q, 3).
        guess_mm: (S, Q, 3).
        augmentation: How the grey levels of each sample are disturbed.
    """

    camera: Camera
    images: U8
    shapes_mm: FloatArray
    origin: I32
    translations_mm: FloatArray
    triangles: I32
    image: I32
    shift_mm: F32
    truth_mm: F32
    guess_mm: F32
    augmentation: Augmentation

    def __post_init__(self) -> None:
        freeze(
            self,
            images=(np.uint8, ("N", "H", "W")),
            shapes_mm=(np.float64, ("N", "Q", 3)),
            origin=(np.int32, ("N",)),
            translations_mm=(np.float64, ("m", 3)),
            triangles=(np.int32, ("M", 3)),
            image=(np.int32, ("S",)),
            shift_mm=(np.float32, ("S", 3)),
            truth_mm=(np.float32, ("S", "Q", 3)),
            guess_mm=(np.float32, ("S", "Q", 3)),
        )


def make_training_set(
    images_gray: Sequence[U8],
    camera: Camera,
    points_mm: FloatArray,
    rng: np.random.Generator,
    settings: TrainingSetSettings | None = None,
    triangles: I32 = SHAPE_TRIANGLES,
) -> TrainingSet:
    """Return the training set of N pictures: N * m * G * H samples, and some of turned heads.

    We differ from the paper in where a guess lies. It takes guesses from where, and as turned as,
    other pictures show the face, so a user who moved his chair between two pictures gets guesses
    beside his head, and the one picture at 60 degrees of yaw gets guesses at 30 degrees, further
    than ferns can bring them. We move the guess to the centroid of the truth, as the paper's
    measure of similarity does, and turn it like the truth; then it is moved and turned by known
    amounts. `Regression` places its starts in the same way.

    Args:
        images_gray: N pictures (H, W), all of the camera's size.
        camera: Their camera.
        points_mm: (N, Q, 3) shapes in the camera frame.
        rng: Source of guesses and disturbances.
        settings: How many, how far.
        triangles: (M, 3) triangulation of the shape points.

    Raises:
        ValueError: Pictures and shapes do not match.
    """
    settings = settings or TrainingSetSettings()
    if len(images_gray) != len(points_mm) or len(points_mm) == 0:
        raise ValueError(f"{len(images_gray)} pictures but {len(points_mm)} shapes")
    width, height = camera.size_px
    if any(image.shape != (height, width) for image in images_gray):
        raise ValueError(f"pictures must be {width}x{height}, the size of their camera")
    views = turned_views(images_gray, camera, points_mm, triangles, settings.turning)
    origin = np.concatenate([np.arange(len(points_mm)), views.origin])
    points_mm = np.concatenate([points_mm, views.points_mm])
    moves = translations(settings)
    image, move, guess = _draw_guesses(points_mm, len(images_gray), moves, rng, settings)
    augmentation = draw_augmentation(
        camera, points_mm, triangles, len(image), rng, settings.augmentation
    )
    return TrainingSet(
        camera=camera,
        images=np.stack([*images_gray, *views.images]),
        shapes_mm=points_mm,
        origin=origin.astype(np.int32),
        translations_mm=moves,
        triangles=triangles,
        image=image,
        shift_mm=-moves[move].astype(np.float32),
        truth_mm=(points_mm[image] + moves[move][:, None]).astype(np.float32),
        guess_mm=guess,
        augmentation=augmentation,
    )


def translations(settings: TrainingSetSettings) -> FloatArray:
    """Return the m translations (m, 3) in mm: none, both ways along each axis, two diagonals."""
    across, along = settings.reach_mm
    signs = [(0, 0, 0), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    signs += [(1, 1, 1), (-1, -1, -1)]
    return np.array(signs[: settings.n_translations], float) * (across, across, along)


def similar_shapes(points_mm: FloatArray, n_similar: int) -> I32:
    """Return the most similar shapes of every shape, itself first, (N, min(N, G)).

    Similarity is the sum of squared distances after the centroids are aligned.
    """
    centred = points_mm - points_mm.mean(axis=1, keepdims=True)
    squared = np.array([((centred - shape) ** 2).sum(axis=(1, 2)) for shape in centred])
    nearest = np.argsort(squared, axis=1, kind="stable")[:, :n_similar]
    return np.asarray(nearest, dtype=np.int32)


def _draw_guesses(
    points_mm: FloatArray,
    n_given: int,
    moves: FloatArray,
    rng: np.random.Generator,
    settings: TrainingSetSettings,
) -> tuple[I32, NDArray[np.intp], F32]:
    """Return picture (S,), translation (S,) and guess (S, Q, 3) of every sample.

    The first `n_given` shapes get H guesses each, those of turned heads fewer.
    """
    center = points_mm.mean(axis=1)
    similar = similar_shapes(points_mm, settings.n_similar)
    image, move, source = (
        grid.ravel()
        for grid in np.meshgrid(
            np.arange(len(points_mm)),
            np.arange(len(moves)),
            np.arange(similar.shape[1]),
            indexing="ij",
        )
    )
    quota = np.where(image < n_given, settings.n_guesses, settings.turning.n_guesses)
    chosen = rng.permuted(np.tile(np.arange(len(moves)), (len(image), 1)), axis=1)
    taken = np.arange(len(moves)) < quota[:, None]
    image, move, source = (np.repeat(a, taken.sum(axis=1)) for a in (image, move, source))
    like = similar[image, source]
    posed = points_mm[like] - center[like][:, None]
    if settings.same_pose:
        rotations = pairwise_rotations(points_mm)[image, like]
        posed = posed @ rotations.swapaxes(1, 2)
    turn_rad = np.where(image < n_given, settings.turn_rad, settings.turning.guess_turn_rad)
    turned = _turn(posed, turn_rad, rng)
    guess = turned + (center[image] + moves[chosen[taken]])[:, None]
    # The trainer takes any run of samples for a fair part of all.
    order = rng.permutation(len(image))
    return image[order].astype(np.int32), move[order], guess[order].astype(np.float32)


def _turn(centred_mm: FloatArray, turn_rad: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return shapes (S, Q, 3) turned about their centroids by random rotations of (S,) rad."""
    half_angles = rng.normal(0, 1, (len(centred_mm), 3)) * turn_rad[:, None] / 2
    rotations = matrix_from_quaternion(np.insert(half_angles, 0, 1.0, axis=1))
    return np.asarray(centred_mm @ rotations.swapaxes(1, 2))
