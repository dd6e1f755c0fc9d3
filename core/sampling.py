"""Reads the appearance of training samples: many pictures, one shape in each."""

from dataclasses import replace

import numpy as np

from core.appearance import AppearancePoints
from core.kernels.disturbance import sample_training
from core.records import F32
from core.training_set import TrainingSet


def sample(
    training_set: TrainingSet, shapes_mm: F32, points: AppearancePoints, softening: float
) -> F32:
    """Return the appearance (S, P) of every sample at shapes (S, Q, 3)."""
    augmentation = training_set.augmentation
    camera = training_set.camera
    out = np.empty((len(shapes_mm), len(points.corners)), np.float32)
    sample_training(
        training_set.images,
        training_set.image,
        training_set.shift_mm,
        shapes_mm,
        points.corners,
        points.weights,
        points.offsets,
        points.members,
        points.cell,
        softening,
        np.array([camera.focal_px, *camera.center_px], np.float32),
        augmentation.normals,
        augmentation.faces,
        augmentation.exposure,
        augmentation.lamp,
        augmentation.occluder,
        out,
    )
    return out


def undisturbed(training_set: TrainingSet) -> TrainingSet:
    """Return a set with every picture once, at its true shape and in its own light."""
    n_images = len(training_set.images)
    shapes = training_set.shapes_mm.astype(np.float32)
    augmentation = replace(
        training_set.augmentation,
        exposure=np.tile(np.array([1, 1, 0, 0], np.float32), (n_images, 1)),
        lamp=np.zeros((n_images, 5), np.float32),
        occluder=np.zeros((n_images, 10), np.float32),
    )
    return replace(
        training_set,
        image=np.arange(n_images, dtype=np.int32),
        shift_mm=np.zeros((n_images, 3), np.float32),
        truth_mm=shapes,
        guess_mm=shapes,
        augmentation=augmentation,
    )


def uncovered(training_set: TrainingSet, n_samples: int) -> TrainingSet:
    """Return the first samples of a set, with nothing in front of the face."""
    augmentation, kept = training_set.augmentation, slice(n_samples)
    return replace(
        training_set,
        image=training_set.image[kept],
        shift_mm=training_set.shift_mm[kept],
        truth_mm=training_set.truth_mm[kept],
        guess_mm=training_set.guess_mm[kept],
        augmentation=replace(
            augmentation,
            exposure=augmentation.exposure[kept],
            lamp=augmentation.lamp[kept],
            occluder=np.zeros_like(augmentation.occluder[kept]),
        ),
    )
