"""Facts about telling the profile's person from others."""

from dataclasses import replace

import numpy as np
import pytest

from core.agreement import Look
from core.profile_match import MatchSettings, ProfileMatch, strangeness
from core.records import Landmarks2D, Shape3D

LANDMARKS = Landmarks2D(
    np.zeros((75, 2)), np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2)
)
#: Disagreement, residual and misfit as measured: medians on own and on other faces.
OWN = [(0.0072, 0.315, 0.0051), (0.0077, 0.362, 0.005), (0.0077, 0.56, 0.0065)]
OTHERS = [(0.0159, 0.84, 0.009), (0.0149, 0.72, 0.0088), (0.0442, 1.12, 0.0131)]


def look(disagreement, residual):
    return Look(LANDMARKS, Shape3D(np.zeros((77, 3)), 1.0, residual), disagreement, True)


def weigh(match, measured, times=1, turned=0.1):
    disagreement, residual, misfit = measured
    for _ in range(times):
        match.weigh(look(disagreement, residual), misfit, turned)


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
    weigh(match, OTHERS[2], 6)
    assert match.is_other


def test_one_odd_look_after_many_good_ones_changes_nothing():
    match = ProfileMatch()
    weigh(match, OWN[0], 20)
    weigh(match, OTHERS[0])
    assert match.is_own


def test_turned_heads_say_nothing():
    match = ProfileMatch()
    weigh(match, OWN[0], 10)
    before = match.evidence
    weigh(match, OTHERS[2], 50, turned=0.7)
    assert match.evidence == before


def test_a_new_lamp_alone_makes_no_stranger():
    settings = MatchSettings()
    dark = strangeness(look(0.0075, 5.0), 0.005, settings)
    assert dark < 0
    assert dark == strangeness(look(0.0075, 50.0), 0.005, settings)


def test_of_a_failing_regressor_only_the_landmarks_count():
    match = ProfileMatch()
    for _ in range(4):
        match.weigh(None, 0.005, 0.0)
    assert match.is_own
    for _ in range(6):
        match.weigh(None, 0.0131, 0.0)
    assert match.is_other


def test_each_measurement_counts():
    settings = MatchSettings()
    usual = strangeness(look(0.01, 0.5), 0.006, settings)
    assert strangeness(look(0.02, 0.5), 0.006, settings) == pytest.approx(usual + np.log(2))
    assert strangeness(look(0.01, 0.6), 0.006, settings) == pytest.approx(usual + np.log(1.2))
    assert strangeness(look(0.01, 0.5), 0.012, settings) == pytest.approx(usual + np.log(2))
    level = replace(settings, disagreement=0.01, residual=0.5, misfit=0.006)
    assert strangeness(look(0.01, 0.5), 0.006, level) == pytest.approx(0)
    assert np.isfinite(strangeness(look(0.0, 0.0), 0.0, settings))
