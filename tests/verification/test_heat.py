"""Diffusion alone, against the closed form of its modes."""

from __future__ import annotations

import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.collocated import observed_order
from workflows.verification.orders import space_errors, time_errors, ways


def test_diffusion_converges_in_space_and_time_with_every_scheme_and_solver() -> None:
    table = table_of("heat", "degrees=[2, 4]", "elements=[8, 16]", "steps=[10, 20]")
    # not yet asymptotic: 0.4 less at most
    assert observed_order(*space_errors(table, "error", 2), 0.0) > 1.9
    assert observed_order(*space_errors(table, "error", 4), 0.0) > 3.6
    assert len(ways(table)) == 4
    for way in ways(table):
        n, error = time_errors(table, "error", *way)
        # the error in space, 3e-4, shifts those in time, 4e-3 and 1e-3
        assert observed_order(n, error, 0.0) > 1.5


@pytest.mark.slow
def test_every_degree_and_scheme_converges_as_theory_says() -> None:
    assert broken_limits("heat", table_of("heat")) == []
