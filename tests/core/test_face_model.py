import numpy as np
import pytest

from app.resources import asset
from core.arkit import EXPRESSION_NAMES, mirror_permutation
from core.face_model import (
    PART_NAMES,
    FaceModelFileError,
    deltas_mm,
    eye_centers_mm,
    load_face_model,
    neutral_mm,
    shape_vertices,
    subset,
    vertices_mm,
)  # fmt: skip

PATH = asset("face_model.npz")


@pytest.fixture(scope="module")
def model():
    return load_face_model(PATH)


@pytest.fixture
def person(model):
    rng = np.random.default_rng(1)
    return rng.normal(size=model.n_identities), rng.uniform(size=len(EXPRESSION_NAMES))


def test_a_face_is_its_neutral_face_plus_what_each_expression_adds(model, person):
    identity, expression = person
    expected = neutral_mm(model, identity) + np.tensordot(
        expression, deltas_mm(model, identity).astype(float), 1
    )
    np.testing.assert_allclose(vertices_mm(model, identity, expression), expected, atol=2e-3)


def test_expressions_depend_linearly_on_identity(model, person):
    identity, _ = person
    middle = deltas_mm(model, identity / 2)
    both = (deltas_mm(model, identity) + deltas_mm(model, identity * 0)) / 2
    np.testing.assert_allclose(middle, both, atol=2e-3)


def test_a_subset_agrees_with_the_whole_face(model, person):
    vertices = shape_vertices(model)
    part = subset(model, vertices)
    np.testing.assert_allclose(
        part.points(*person), vertices_mm(model, *person)[vertices], atol=2e-3
    )


@pytest.mark.parametrize("which", ["identity", "expression"])
def test_jacobians_agree_with_finite_differences(model, person, which):
    part = subset(model, shape_vertices(model)[::7])
    identity, expression = person
    if which == "identity":
        exact, at = part.identity_jacobian(expression), identity
    else:
        exact, at = part.expression_jacobian(identity), expression
    step = 1e-4
    for k in range(0, len(at), 9):
        moved = [np.array(at), np.array(at)]
        moved[0][k] += step
        moved[1][k] -= step
        ends = [
            part.points(m, expression) if which == "identity" else part.points(identity, m)
            for m in moved
        ]
        np.testing.assert_allclose(exact[..., k], (ends[0] - ends[1]) / (2 * step), atol=1e-6)


def test_the_mean_face_is_mirror_symmetric(model):
    mirrored = model.mean_mm[model.mirror_vertices] * [-1, 1, 1]
    np.testing.assert_array_equal(mirrored, model.mean_mm)


def test_left_shapes_are_exact_mirrors_of_right_shapes(model):
    deltas = deltas_mm(model, np.zeros(model.n_identities))
    mirrored = deltas[mirror_permutation()][:, model.mirror_vertices] * [-1, 1, 1]
    np.testing.assert_allclose(mirrored, deltas, atol=1e-5)


def test_mirroring_a_person_changes_signs_of_weights(model, person):
    identity, expression = person
    other = identity * model.identity_mirror
    swapped = expression[mirror_permutation()]
    mirrored = vertices_mm(model, identity, expression)[model.mirror_vertices] * [-1, 1, 1]
    np.testing.assert_allclose(vertices_mm(model, other, swapped), mirrored, atol=0.06)


def test_the_origin_is_between_the_eyeballs_which_are_round(model, person):
    neutral = neutral_mm(model, person[0])
    centers = eye_centers_mm(model, neutral)
    assert np.abs(centers.mean(axis=0)).max() < 0.1
    assert centers[0, 0] < 0 < centers[1, 0]
    for center, ball in zip(
        centers, (model.eyeball_vertices_right, model.eyeball_vertices_left), strict=True
    ):
        assert np.ptp(np.linalg.norm(neutral[ball] - center, axis=1)) < 0.15


def test_quads_are_what_the_triangles_were_cut_from(model):
    quads = model.quads
    np.testing.assert_array_equal(quads[:, :3], model.triangles[::2])
    np.testing.assert_array_equal(quads[:, [0, 2, 3]], model.triangles[1::2])
    assert (model.part[::2] == model.part[1::2]).all()


def test_every_part_has_triangles_and_texture_coordinates_inside_the_picture(model):
    assert all(len(model.part_triangles(name)) > 50 for name in PART_NAMES)
    assert model.uv.min() >= 0 and model.uv.max() <= 1
    skin = model.uv[model.part_triangles("skin")]
    (a, b), (c, d) = (skin[:, 1] - skin[:, 0]).T, (skin[:, 2] - skin[:, 0]).T
    assert (a * d != b * c).mean() > 0.99


def test_skin_faces_point_out_of_the_head(model):
    a, b, c = (model.mean_mm[model.triangles[model.part_triangles("skin"), k]] for k in range(3))
    outwards = np.einsum("tk,tk->t", np.cross(b - a, c - a), (a + b + c) / 3 - [0, 20, 70])
    # Ears and lips fold back; all else faces away from the middle of the head.
    assert np.sign(outwards).mean() > 0.65


def test_landmarks_lie_on_the_front_of_the_skin_in_their_places(model):
    right_brow, left_brow, nose_tip = (
        model.mean_mm[model.landmark_vertices[k]] for k in (4, 5, 32)
    )
    assert right_brow[0] < -20 and left_brow[0] > 20 and right_brow[1] < -5
    assert abs(nose_tip[0]) < 0.1 and nose_tip[2] < -35
    assert (model.mean_mm[shape_vertices(model), 2] < 20).all()


def test_strips_run_over_vertices_of_the_skin(model):
    used = model.contour_strips[model.contour_strips >= 0]
    assert np.isin(used, model.triangles[model.part_triangles("skin")]).all()
    assert ((model.contour_strips >= 0).sum(axis=1) >= 8).all()


def test_says_what_is_wrong_with_a_file(tmp_path, model):
    with pytest.raises(FaceModelFileError, match="build it again"):
        load_face_model(tmp_path / "missing.npz")
    broken = tmp_path / "broken.npz"
    broken.write_bytes(b"PK nonsense")
    with pytest.raises(FaceModelFileError):
        load_face_model(broken)
    with np.load(PATH) as data:
        arrays = dict(data)
    arrays["expression_names"] = arrays["expression_names"][::-1]
    np.savez(tmp_path / "other.npz", **arrays)
    with pytest.raises(FaceModelFileError, match="other expression names"):
        load_face_model(tmp_path / "other.npz")


def test_a_model_cannot_be_changed(model):
    with pytest.raises(ValueError):
        model.mean_mm[0] = 0
