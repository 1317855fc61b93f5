"""Orders of convergence in space."""

from __future__ import annotations

import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.studies.mesh_convergence import orders


def test_cubic_splines_converge_on_coarse_meshes() -> None:
    found = orders(table_of("mesh-convergence", "degrees=[3]", "elements=[8, 12]"))
    # coarse meshes, not yet asymptotic: measured 4.5, 2.2 and 4.5
    assert found[3, "displacement"] > 3.9
    assert found[3, "energy_norm"] > 1.9
    assert found[3, "potential"] > 3.8


@pytest.mark.slow
def test_every_degree_converges_as_theory_says() -> None:
    table = table_of("mesh-convergence")
    assert broken_limits("mesh-convergence", table) == []
