"""The single cell of Fig. C.2."""

from __future__ import annotations

import numpy as np
import pytest

from pipeline.errors import InputError
from tests.verification.studies import broken_limits, table_of
from workflows.request import Request
from workflows.verification.catalogue import find
from workflows.verification.studies.single_cell import errors, orders


def test_a_short_trace_converges_at_the_orders_of_theory() -> None:
    table = table_of("single-cell", "duration=80", "pulse_start=10", "steps=[400, 800, 1600]")
    found = [orders(table, method)[-1] for method in (1, 2, 3)]
    np.testing.assert_allclose(found, [4.0, 1.0, 2.0], atol=0.1)
    # the pulse is late by half a step: 0.025 ms at the largest slope, 20 mV/ms and more
    assert errors(table, "potential", 2)[-1] > 0.4
    assert np.isnan(table.column("apd90")).all()  # not repolarised yet: no number


def test_a_stimulus_between_time_steps_is_refused() -> None:
    with pytest.raises(InputError, match="pulse_start must be a whole number of time steps"):
        Request.read("verification", overrides=["single_cell.pulse_start=50.01"])


@pytest.mark.slow
def test_the_whole_beat_is_that_of_scipy() -> None:
    table = table_of("single-cell")
    assert broken_limits("single-cell", table) == []
    found = find("single-cell").quantities(table)
    assert found["peak"].value == pytest.approx(19.9, abs=0.05)
    assert found["apd90"].value == pytest.approx(341.0, abs=0.5)
    # k_sigma (peak - v_r), which the fast rate nearly reaches
    assert found["peak_stress"].value == pytest.approx(0.122 * 99.9, abs=0.02)
