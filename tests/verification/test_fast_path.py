"""The fast solver, the general one, and any number of threads: one result."""

from __future__ import annotations

import pytest

from tests.verification.studies import broken_limits, table_of

SHORT = (
    "degrees=[2, 4]",
    "samples=2",
    "electrophysiology.elements=[24, 12]",
    "thread_elements=[36, 18]",
    "electrophysiology.duration=60",
    "electrophysiology.n_steps=300",
)


def test_both_solvers_and_any_threads_give_one_result() -> None:
    table = table_of("fast-path", *SHORT)
    assert broken_limits("fast-path", table) == []
    # rounding differs, or one solver was compared with itself
    assert (table.column("potential_difference") > 0.0).all()


@pytest.mark.slow
def test_they_do_for_every_degree_and_scheme_over_a_longer_time() -> None:
    assert broken_limits("fast-path", table_of("fast-path")) == []
