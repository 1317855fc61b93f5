"""The travelling front of the cubic reaction, against its closed form."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.collocated import observed_order
from workflows.verification.orders import space_errors, time_errors, ways

SHORT = (
    "degrees=[2, 3, 4]",
    "elements=[51, 102]",
    "time_mesh=[4, 51]",
    "steps=[60, 120]",
    "electrophysiology.n_steps=300",
)


def test_speed_and_profile_of_the_front_converge_in_space_and_time() -> None:
    table = table_of("front", *SHORT)
    for column in ("speed_error", "profile_error"):
        for degree, order in ((2, 2), (3, 2), (4, 4)):
            # h is 0.4 to 0.9 of the front's length l: within a quarter of the order
            n, error = space_errors(table, column, degree)
            assert observed_order(n, error, 0.0) == pytest.approx(order, abs=0.3)
        for way in ways(table):
            assert observed_order(*time_errors(table, column, *way), 0.0) == pytest.approx(
                2.0, abs=0.1
            )


def test_the_splitting_is_ten_times_as_accurate_as_the_published_scheme() -> None:
    """With steps of 0.5 ms, 1e-3 and 1e-4 of the speed; and degree 3 is worse than degree 2."""
    table = table_of("front", *SHORT)
    published, splitting = (
        time_errors(table, "speed_error", scheme, False)[1] for scheme in (0, 1)
    )
    assert np.all(published > 8.0 * splitting)
    errors = {degree: space_errors(table, "speed_error", degree)[1] for degree in (2, 3)}
    assert np.all(errors[3] > 1.9 * errors[2])


@pytest.mark.slow
def test_every_degree_and_scheme_converges_as_theory_says() -> None:
    assert broken_limits("front", table_of("front")) == []
