"""Facts about what a new profile's report says of the training-free mode."""

from types import SimpleNamespace

import numpy as np
import pytest

from app import setup_steps
from app.setup_steps import Pictures, make_profile
from core.records import SetupImages
from tests.core.held_out_person import face_model
from tests.core.synthetic_fit import result_of
from tests.core.test_free_comparison import film, pictures  # noqa: F401  fixtures

GUESSED = "pose_yaw+90"


@pytest.fixture
def built(film, pictures, monkeypatch):  # noqa: F811
    """What a build of the film's pictures returns, a guessed one among them; what it was given."""
    shapes = pictures.shapes
    n = len(pictures.names)
    rows = [*range(3), 0, *range(3, n)]
    names = (*pictures.names[:3], GUESSED, *pictures.names[3:])
    images = SetupImages(
        tuple(np.zeros((480, 640, 3), np.uint8) for _ in names), names, film.standard[rows]
    )
    with_guess = setup_steps.rows_of_shapes(shapes, rows)
    found = SimpleNamespace(
        images=images, landmarks=tuple(film.landmarks[row] for row in rows), camera=film.camera,
        fit=None, user=film.user, shapes=with_guess, regressor=None, eyes=None,
        report={"picture_names": list(pictures.names)}, given=[],
    )  # fmt: skip

    def build(model, images, landmarks, focal_px, rng, settings):
        found.given.append(settings)
        yield setup_steps.Progress(1, 1, "Training the regressor")
        return found

    monkeypatch.setattr(setup_steps, "build", build)
    return found


def test_the_report_has_the_training_free_mode_on_the_same_pictures(built):
    steps = make_profile(
        face_model(), Pictures(built.images, built.landmarks, ()), None, np.random.default_rng(0)
    )
    profile, _ = result_of(steps)
    later = profile.report["free"]["later"]
    assert later["lost"] == 0 and later["mean_rmse_px"] < 3
    assert profile.report["picture_names"] == built.report["picture_names"]


def test_it_gets_the_points_as_they_were_found_and_not_as_they_were_corrected(built):
    unseen = tuple(setup_steps.unseen() for _ in built.landmarks)
    before = object()
    pictures = Pictures(built.images, built.landmarks, (), unseen, before)  # noqa: F811
    profile, _ = result_of(make_profile(face_model(), pictures, None, np.random.default_rng(0)))
    later = profile.report["free"]["later"]
    assert later["lost"] == later["pictures"] > 0
    assert built.given[0].before is before


def test_its_progress_does_not_go_back(built):
    steps = make_profile(
        face_model(), Pictures(built.images, built.landmarks, ()), None, np.random.default_rng(0)
    )
    assert [step.done / step.total for step in steps] == [1, 1, 1]
