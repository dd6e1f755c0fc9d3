"""How free the focal length is in the quick identity fit."""

import numpy as np
import pytest

from core.quick_problem import FocalPrior, FocalSettings
from tests.core.test_quick_frames import SETTINGS, frame

FREE = FocalPrior(640.0, False, FocalSettings())


def spread(prior, *yaws):
    return prior.spread(tuple(frame(yaw=yaw) for yaw in yaws), SETTINGS.angle_rad)


def test_frontal_faces_hardly_free_the_focal_length():
    assert spread(FREE, 0.0, 0.1) == pytest.approx(0.2 * 0.15)


def test_turned_heads_free_it():
    assert spread(FREE, -0.25, 0.25) == pytest.approx(0.1)
    assert spread(FREE, -0.6, 0.0, 0.6) == pytest.approx(0.2)


def test_known_focal_length_is_never_free():
    known = FocalPrior(640.0, True, FocalSettings())
    assert spread(known, -0.6, 0.6) <= 1e-4
    assert known.told(1.0, 1e-4) == 1e-4


def test_told_spread_counts_landmark_errors_that_agree():
    assert FREE.told(0.05, 0.2) == pytest.approx(0.1)
    assert FREE.told(np.inf, 0.2) == 0.2


def test_a_narrow_prior_is_not_told_as_knowledge():
    frontal = spread(FREE, 0.0, 0.1)
    assert FREE.told(frontal, frontal) == 0.2
