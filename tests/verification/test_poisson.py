"""Orders of collocation on the distorted square of Table C.1."""

from __future__ import annotations

import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.studies.poisson import orders


def test_coarse_meshes_converge_at_the_orders_of_greville_collocation() -> None:
    found = orders(table_of("poisson", "degrees=[2, 4]", "elements=[8, 16]"))
    # not yet asymptotic: 0.35 less at most
    assert found[2] > 1.65
    assert found[4] > 3.65


@pytest.mark.slow
def test_every_degree_converges_as_theory_says() -> None:
    assert broken_limits("poisson", table_of("poisson")) == []
