"""Order of convergence in time."""

from __future__ import annotations

import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.studies.dynamics import orders


def test_a_small_film_follows_its_path_at_second_order() -> None:
    found = orders(table_of("dynamics", "elements=[3, 2]", "radii=[0.5]", "steps=[80, 160]"))
    # steps not yet short enough for the last tenths
    assert all(order > 1.7 for order in found.values())


@pytest.mark.slow
def test_every_spectral_radius_is_of_second_order() -> None:
    assert broken_limits("dynamics", table_of("dynamics")) == []
