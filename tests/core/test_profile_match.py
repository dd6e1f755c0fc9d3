"""Facts about telling the profile's person from others."""

from dataclasses import replace

import numpy as np
import pytest

from core.agreement import Look, Misfits
from core.profile_match import MatchSettings, ProfileMatch, strangeness
from core.records import Landmarks2D, Shape3D

LANDMARKS = Landmarks2D(
    np.zeros((75, 2)), np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2)
)
#: Disagreement, residual and misfits as measured: medians on own and on other faces.
OWN = [
    (0.0072, 0.315, Misfits(0.0047, 0.0105)),
    (0.0071, 0.33, Misfits(0.0043, 0.0093)),
    (0.0093, 0.56, Misfits(0.0068, 0.0128)),
]
OTHERS = [
    (0.0158, 0.77, Misfits(0.009, 0.0093)),
    (0.0128, 0.86, Misfits(0.0067, 0.0096)),
    (0.0442, 1.12, Misfits(0.0131, 0.0135)),
]


def look(disagreement, residual):
    return Look(LANDMARKS, Shape3D(np.zeros((77, 3)), 1.0, residual), disagreement, True)


def weigh(match, measured, times=1, turned=0.1):
    disagreement, residual, misfits = measured
    for _ in range(times):
        match.weigh(look(disagreement, residual), misfits, turned)


@pytest.mark.parametrize("measured", OWN)
def test_own_faces_are_known_after_a_few_looks(measured):
    match = ProfileMatch()
    weigh(match, measured, 3)
    assert match.is_own and not match.is_other


@pytest.mark.parametrize("measured", OTHERS)
def test_other_faces_are_known_after_a_few_looks(measured):
    match = ProfileMatch()
    weigh(match, measured, 3)
    assert match.is_other and not match.is_own


def test_nothing_is_known_before_a_look_and_after_a_reset():
    match = ProfileMatch()
    assert not match.is_own and not match.is_other and match.evidence == 0
    weigh(match, OWN[0], 5)
    match.reset()
    assert not match.is_own and match.evidence == 0


def test_another_person_is_noticed_after_long_tracking():
    match = ProfileMatch()
    weigh(match, OWN[0], 200)
    weigh(match, OTHERS[2], 8)
    assert match.is_other


def test_one_odd_look_after_many_good_ones_changes_nothing():
    match = ProfileMatch()
    weigh(match, OWN[0], 20)
    weigh(match, OTHERS[0])
    # It asks for another look, though.
    assert match.is_own and match.is_unsure
    weigh(match, OWN[0])
    assert not match.is_unsure


def test_turned_heads_say_nothing():
    match = ProfileMatch()
    weigh(match, OWN[0], 10)
    before = match.evidence
    weigh(match, OTHERS[2], 50, turned=0.7)
    assert match.evidence == before


def test_a_new_lamp_alone_makes_no_stranger():
    settings = MatchSettings()
    dark = strangeness(look(0.0072, 5.0), OWN[0][2], settings)
    assert dark < 0
    assert dark == strangeness(look(0.0072, 50.0), OWN[0][2], settings)


def test_of_a_failing_regressor_only_the_landmarks_count():
    match = ProfileMatch()
    for _ in range(4):
        match.weigh(None, OWN[0][2], 0.0)
    assert match.is_own
    for _ in range(12):
        match.weigh(None, OTHERS[2][2], 0.0)
    assert match.is_other


def test_each_measurement_counts():
    settings = MatchSettings()
    usual = strangeness(look(0.01, 0.5), Misfits(0.006, 0.01), settings)
    apart = strangeness(look(0.02, 0.5), Misfits(0.006, 0.01), settings)
    unlike = strangeness(look(0.01, 0.6), Misfits(0.006, 0.01), settings)
    unfit = strangeness(look(0.01, 0.5), Misfits(0.012, 0.01), settings)
    assert apart - usual == pytest.approx(np.log(2)) == unfit - usual
    assert unlike - usual == pytest.approx(np.log(1.2))
    level = replace(settings, disagreement=0.5, residual=0.5, misfit=0.4)
    assert strangeness(look(0.01, 0.5), Misfits(0.008, 0.02), level) == pytest.approx(0)
    assert np.isfinite(strangeness(look(0.0, 0.0), Misfits(0.0, 0.0), settings))


def test_people_who_look_like_the_mean_face_are_known_too():
    match = ProfileMatch()
    weigh(match, (0.006, 0.4, Misfits(0.0045, 0.0047)), 3)
    assert match.is_own


def test_a_blurred_picture_says_nothing_against_anybody():
    settings = MatchSettings()
    sharp = strangeness(look(0.007, 0.4), Misfits(0.005, 0.0105), settings)
    blurred = strangeness(look(0.014, 0.4), Misfits(0.01, 0.021), settings)
    assert blurred == pytest.approx(sharp)
