import pytest

from core.detection_policy import DetectionPolicy, PolicySettings

CALM, RESTLESS, BLINK = 0.002, 0.02, 0.03


def looks_of(detection, budget_ms, errors, costs=(None, None)):
    """Return in which frames the network looks at flow with these errors, 0.1 s after a look."""
    policy, looks = DetectionPolicy(detection, budget_ms), []
    for error in errors:
        looks.append(policy.wants_look(error, 0.1))
        policy.spent(costs[0], costs[1] if looks[-1] else None, looked=looks[-1])
    return looks


def test_every_frame_and_every_third():
    assert all(looks_of("every", 9.0, [0.0] * 5))
    assert looks_of(3, 9.0, [1.0] * 7) == [False, False, True] * 2 + [False]


@pytest.mark.parametrize("detection", ["often", 0, -1, True, 2.5])
def test_says_what_detection_may_be(detection):
    with pytest.raises(ValueError, match="'every', 'adaptive' or a number"):
        DetectionPolicy(detection, 9.0)


def test_says_that_a_budget_must_be_positive():
    with pytest.raises(ValueError, match="above 0"):
        DetectionPolicy("adaptive", 0.0)


def test_a_calm_face_is_left_to_flow_until_the_look_is_old():
    policy = DetectionPolicy("adaptive", 9.0)
    longest_s = PolicySettings().longest_s
    assert not policy.wants_look(CALM, 0.9 * longest_s)
    assert policy.wants_look(CALM, longest_s)
    assert policy.wants_look(CALM, -0.1)


@pytest.mark.parametrize("budget_ms", [3.0, 6.0, 10.0])
def test_restless_faces_cost_the_budget_on_average(budget_ms):
    settings = PolicySettings()
    looks = looks_of("adaptive", budget_ms, [RESTLESS] * 600)
    cost_ms = settings.flow_ms + settings.network_ms * sum(looks[100:]) / 500
    assert cost_ms == pytest.approx(budget_ms, abs=0.5)


def test_a_slower_machine_looks_less_often():
    errors = [RESTLESS] * 600
    fast = looks_of("adaptive", 8.0, errors, (1.0, 10.0))
    slow = looks_of("adaptive", 8.0, errors, (3.0, 40.0))
    assert sum(fast) > 3 * sum(slow)
    assert sum(slow[100:]) / 500 * 40 + 3 == pytest.approx(8.0, abs=0.6)


def test_a_blink_is_looked_at_through_and_through_after_calm():
    assert all(looks_of("adaptive", 5.0, [CALM] * 60 + [BLINK] * 6)[-6:])


def test_a_lost_face_is_looked_at_whatever_it_costs():
    assert all(looks_of("adaptive", 1.0, [PolicySettings().alarm] * 50))


def test_reset_forgets_what_was_owed_and_measured():
    policy = DetectionPolicy("adaptive", 8.0)
    for _ in range(100):
        policy.spent(30.0, 300.0, looked=True)
    assert not policy.wants_look(BLINK, 0.1)
    policy.reset()
    assert policy.wants_look(BLINK, 0.1)


def test_one_slow_frame_is_no_slow_machine():
    policy = DetectionPolicy("adaptive", 8.0)
    policy.spent(2000.0, 5000.0, looked=True)
    looks = []
    for _ in range(200):
        looks.append(policy.wants_look(RESTLESS, 0.1))
        policy.spent(1.5, 16.0 if looks[-1] else None, looked=looks[-1])
    assert sum(looks) > 60
