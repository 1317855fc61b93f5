"""A cell without diffusion: pulses, branching, and the published scheme."""

from __future__ import annotations

import numpy as np
import pytest

from stages.electrophysiology.single_cell import (
    Pulse,
    follow,
    follow_as_published,
    mean_rates,
    rest,
)
from tests.cells import cells, integrated

CELL = cells("aliev-panfilov")
PULSE = Pulse(start=10.0, duration=2.0, rate=20.0)


def test_orders_are_four_and_with_the_published_scheme_two_or_one() -> None:
    """One, because the levels of a step delay the pulse by half of it; two with its exact mean."""
    time = np.arange(0.0, 60.1, 0.4)
    exact = integrated(CELL, rest(CELL), PULSE, time, method="DOP853", rtol=1e-11, atol=1e-12)
    errors = []
    for step in (0.2, 0.1, 0.05):
        every, steps = slice(None, None, round(0.4 / step)), round(60.0 / step)
        traces = (
            follow(CELL, [PULSE], 60.0, step),
            follow_as_published(CELL, [PULSE], 60.0, steps, mean=True),
            follow_as_published(CELL, [PULSE], 60.0, steps),
        )
        errors.append([np.abs(t.potential[every] - exact.potential).max() for t in traces])
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(orders[-1], [4.0, 2.0, 1.0], atol=0.15)


def test_a_trace_goes_on_from_any_of_its_states() -> None:
    whole = follow(CELL, [PULSE], 80.0, 0.02)
    middle = int(np.argmin(np.abs(whole.time - 30.0)))
    rest_of_it = follow(CELL, [], 50.0, 0.02, start=whole.state(middle))
    # round-off: the lengths of the steps differ in their last digit
    np.testing.assert_allclose(rest_of_it.potential, whole.potential[middle:], rtol=0, atol=1e-9)
    np.testing.assert_allclose(rest_of_it.stress, whole.stress[middle:], rtol=0, atol=1e-9)
    np.testing.assert_allclose(rest_of_it.states, whole.states[:, middle:], rtol=0, atol=1e-9)


def test_no_step_sees_a_jump_of_the_current() -> None:
    pulses = [Pulse(0.1, 0.2, 5.0), Pulse(0.3, 0.2, 7.0), Pulse(4.0, 9.0, 1.0)]
    assert 0.1 + 0.2 != 0.3
    trace = follow(CELL, pulses, 5.0, 0.25)
    for edge in (0.1, 0.3, 0.5, 4.0, 5.0):
        assert np.abs(trace.time - edge).min() < 1e-12
    steps = np.diff(trace.time)
    assert steps.max() <= 0.25 + 1e-12
    assert steps.min() > 0.01
    means = mean_rates(pulses, trace.time)
    assert set(means.round(9)) == {0.0, 5.0, 7.0, 1.0}


def test_the_mean_of_a_pulse_keeps_its_charge() -> None:
    pulses = [Pulse(0.37, 1.9, 20.0), Pulse(1.1, 0.05, -3.0)]
    for time in (np.linspace(0.0, 4.0, 7), np.linspace(0.0, 4.0, 123)):
        charge = mean_rates(pulses, time) @ np.diff(time)
        assert charge == pytest.approx(1.9 * 20.0 - 0.05 * 3.0, rel=1e-12)


def test_a_weak_pulse_excites_nothing() -> None:
    weak = follow(CELL, [Pulse(10.0, 2.0, 5.0)], 60.0, 0.05)
    assert weak.potential.max() == pytest.approx(-70.0, abs=0.5)  # 10 mV, below a = 15 mV
    assert abs(weak.potential[-1] + 80.0) < 1.0
