"""Facts about the training set and about what disturbs its grey levels."""

from dataclasses import replace

import numpy as np
import pytest

from core.augmentation import AugmentationSettings, draw_augmentation, face_circles, normal_maps
from core.camera import project
from core.geometry import register_rigid
from core.training_set import (
    TrainingSetSettings,
    make_training_set,
    similar_shapes,
    translations,
)
from core.turned_views import TurnSettings
from tests.synthetic_face import make_face

STILL = TrainingSetSettings(turn_rad=0.0, same_pose=False, turning=TurnSettings(further_deg=()))


@pytest.fixture(scope="module")
def face():
    return make_face(np.random.default_rng(1), (64, 48))


def make(face, n_pictures=8, settings=STILL, seed=3):
    shapes = face.random_shapes(n_pictures, np.random.default_rng(2))
    pictures = [face.background.astype(np.uint8)] * n_pictures
    rng = np.random.default_rng(seed)
    return make_training_set(pictures, face.camera, shapes, rng, settings, face.triangles)


def test_sixty_pictures_make_10800_samples_without_copying_a_picture(face):
    samples = make(face, 60)
    assert len(samples.image) == 10_800
    assert samples.images.shape == (60, 48, 64)
    assert np.all(np.bincount(samples.image) == 180)


def test_pictures_of_turned_heads_join_with_fewer_samples_each(face):
    settings = TrainingSetSettings(turning=TurnSettings((10.0,), from_deg=0.0, n_guesses=1))
    samples = make(face, settings=settings)
    assert samples.origin.tolist() == [*range(8), *range(8)]
    assert np.bincount(samples.image).tolist() == [9 * 5 * 4] * 8 + [9 * 5 * 1] * 8
    turned = samples.truth_mm + samples.shift_mm[:, None]
    assert np.allclose(turned, samples.shapes_mm[samples.image], atol=1e-3)


def test_the_shift_brings_the_truth_to_where_its_picture_shows_the_face(face):
    samples = make(face)
    moved = samples.truth_mm + samples.shift_mm[:, None]
    assert np.allclose(moved, samples.shapes_mm[samples.image], atol=1e-3)


def test_a_guess_is_one_of_the_most_similar_shapes_at_a_translation_from_the_truths_picture(face):
    samples = make(face)
    centroid = samples.shapes_mm.mean(axis=1)
    centred = samples.shapes_mm - centroid[:, None]
    similar = similar_shapes(samples.shapes_mm, 5)
    for image, guess in zip(samples.image[:200], samples.guess_mm[:200], strict=True):
        guess_centre = guess.mean(axis=0)
        gaps = np.abs(centred - (guess - guess_centre)).max(axis=(1, 2))
        assert gaps.min() < 1e-3
        assert gaps.argmin() in similar[image]
        offsets = np.abs(samples.translations_mm - (guess_centre - centroid[image])).max(axis=1)
        assert offsets.min() < 1e-3


def test_a_guess_is_turned_like_the_truth(face):
    still = TurnSettings(guess_turn_rad=0.0)
    samples = make(face, settings=TrainingSetSettings(turn_rad=0.0, turning=still))
    for truth, guess in zip(samples.truth_mm[:100], samples.guess_mm[:100], strict=True):
        rotation, _ = register_rigid(guess.astype(float), truth.astype(float))
        assert np.trace(rotation) == pytest.approx(3.0, abs=1e-5)


def test_the_guesses_from_one_picture_for_one_truth_all_differ(face):
    samples = make(face, 4, replace(STILL, n_similar=1))
    keys = {
        (image, *np.round(np.concatenate([shift, guess.mean(axis=0)]), 2))
        for image, shift, guess in zip(
            samples.image, samples.shift_mm, samples.guess_mm, strict=True
        )
    }
    assert len(keys) == len(samples.image) == 4 * 9 * 4


def test_a_shape_is_most_similar_to_itself_wherever_it_is_moved(face):
    shapes = face.random_shapes(10, np.random.default_rng(5))
    moved = shapes + np.random.default_rng(6).normal(0, 200, (10, 1, 3))
    assert np.array_equal(similar_shapes(shapes, 5)[:, 0], np.arange(10))
    assert np.array_equal(similar_shapes(shapes, 5), similar_shapes(moved, 5))


def test_turned_guesses_turn_by_about_what_was_asked(face):
    straight, turned = make(face), make(face, settings=replace(STILL, turn_rad=0.07))
    source = straight.guess_mm - straight.guess_mm.mean(axis=1, keepdims=True)
    # Same seed: the same sources were drawn before any turn, but the order is drawn after it.
    sizes = np.sort(np.sqrt((source**2).sum(axis=(1, 2))))
    after = turned.guess_mm - turned.guess_mm.mean(axis=1, keepdims=True)
    assert np.allclose(np.sort(np.sqrt((after**2).sum(axis=(1, 2)))), sizes, rtol=1e-4)
    assert not np.allclose(turned.guess_mm, straight.guess_mm, atol=1.0)


def test_the_same_seed_makes_the_same_set(face):
    first, second, other = make(face), make(face), make(face, seed=4)
    assert np.array_equal(first.guess_mm, second.guess_mm)
    assert np.array_equal(first.augmentation.exposure, second.augmentation.exposure)
    assert not np.array_equal(first.guess_mm, other.guess_mm)


def test_fewer_pictures_than_similar_shapes_are_enough(face):
    assert len(make(face, 3).image) == 3 * 9 * 3 * 4


def test_the_first_translation_is_none_and_the_rest_cancel():
    moves = translations(TrainingSetSettings())
    assert moves.shape == (9, 3)
    assert np.all(moves[0] == 0)
    assert np.allclose(moves.sum(axis=0), 0)


def test_says_when_pictures_and_shapes_do_not_match(face):
    shapes = face.random_shapes(2, np.random.default_rng(2))
    picture = face.background.astype(np.uint8)
    rng = np.random.default_rng(1)
    with pytest.raises(ValueError, match="1 pictures but 2 shapes"):
        make_training_set([picture], face.camera, shapes, rng, STILL, face.triangles)
    with pytest.raises(ValueError, match="64x48"):
        make_training_set([picture, picture.T], face.camera, shapes, rng, STILL, face.triangles)


def test_disturbances_come_in_the_shares_asked_for(face):
    shapes = face.random_shapes(5, np.random.default_rng(2))
    settings = AugmentationSettings(lamp_share=0.25, occluded_share=0.4)
    rng = np.random.default_rng(8)
    drawn = draw_augmentation(face.camera, shapes, face.triangles, 20_000, rng, settings)
    assert np.mean(drawn.lamp[:, 4] > 0) == pytest.approx(0.25, abs=0.02)
    assert np.mean(drawn.occluder[:, 2] > 0) == pytest.approx(0.4, abs=0.02)
    assert np.median(drawn.exposure[:, 0]) == pytest.approx(1.0, abs=0.02)
    assert np.all(drawn.lamp[:, 2] <= 0), "lamps stand on the camera's side of the face"


def test_no_disturbance_leaves_grey_levels_alone(face):
    shapes = face.random_shapes(5, np.random.default_rng(2))
    settings = AugmentationSettings(0.0, 0.0, 0.0)
    rng = np.random.default_rng(8)
    drawn = draw_augmentation(face.camera, shapes, face.triangles, 100, rng, settings)
    assert np.all(drawn.exposure == [1, 1, 0, 0])
    assert np.all(drawn.lamp[:, 4] == 0)
    assert np.all(drawn.occluder[:, 2:4] == 0)


def test_normals_point_to_the_camera_and_aside_at_the_sides(face):
    shape = face.shape((0, 0, 0), (0, 0), (0, 0, 600.0))
    normals = normal_maps(face.camera, shape[None], face.triangles)[0]
    height, width, _ = normals.shape
    assert np.allclose(np.linalg.norm(normals, axis=2), 1, atol=0.15)
    assert normals[height // 2, width // 2] @ (0, 0, -1) > 0.95
    assert normals[height // 2, 0, 0] < -0.3
    assert normals[height // 2, -1, 0] > 0.3
    assert normals[0, width // 2, 1] < -0.3


def test_the_triangles_may_be_wound_either_way(face):
    shape = face.shape((0, 0, 0), (0, 0), (0, 0, 600.0))
    one_way = normal_maps(face.camera, shape[None], face.triangles)
    mixed = face.triangles.copy()
    mixed[::2] = mixed[::2, ::-1]
    assert np.allclose(one_way, normal_maps(face.camera, shape[None], mixed), atol=1e-5)


def test_the_circle_of_a_face_is_its_mean_and_mean_radius_in_the_picture(face):
    shape = face.shape((0.1, 0, 0), (1, 0), (10, 0, 600.0))
    points = project(face.camera, shape)
    circle = face_circles(face.camera, shape[None])[0]
    assert np.allclose(circle[:2], points.mean(axis=0))
    assert circle[2] == pytest.approx(np.sqrt(np.sum(points.var(axis=0))))
