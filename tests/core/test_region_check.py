import numpy as np
import pytest

from core.landmarks import N_LANDMARKS, NAMES, REGION_LANDMARKS, REGION_NAMES, SHAPE_NAMES
from core.region_check import region_means, region_shares


def test_every_landmark_lies_in_one_region():
    members = sorted(k for region in REGION_LANDMARKS for k in region)
    assert len(REGION_NAMES) == len(REGION_LANDMARKS)
    assert members == list(range(N_LANDMARKS))


def test_mean_of_a_region_is_that_of_its_landmarks():
    values = np.zeros(N_LANDMARKS)
    values[NAMES.index("nose_tip")] = 12.0
    assert region_means(values) == pytest.approx([0, 0, 0, 1, 0, 0])


def test_point_belongs_to_the_region_of_its_nearest_corner():
    lip, nose, chin = (SHAPE_NAMES.index(n) for n in ("lip_lo_mid", "nose_tip", "chin_front"))
    corners = np.array([[lip, chin, nose], [lip, chin, nose], [chin, lip, nose]], np.int32)
    weights = np.array([[0.8, 0.1, 0.1], [1.4, 0.1, -0.5], [0.1, 0.1, 0.8]], np.float32)
    shares = region_shares(corners, weights)
    assert shares[REGION_NAMES.index("mouth")].tolist() == [0.5, 0.5, 0]
    assert shares[REGION_NAMES.index("nose")].tolist() == [0, 0, 1]
    assert shares[REGION_NAMES.index("brows")].tolist() == [0, 0, 0]
