"""Panels that snap through: limit points by arc length, against published ones."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.studies.snap_through import LIMIT, of_thickness


def test_a_coarse_thick_panel_passes_both_of_its_limit_loads() -> None:
    table = table_of("snap-through", "thicknesses=[12.7]", "elements=3")
    deflection, load, kind = of_thickness(table, 12.7)
    limits = load[kind == LIMIT]
    # three cubic elements are a few per cent too stiff; 2216 and 515 on fine meshes
    np.testing.assert_allclose(limits, [2216.0, 515.0], rtol=0.06)
    assert deflection[-1] == 30.0
    unstable = table.column("unstable_directions")
    assert (unstable[0], unstable.max(), unstable[-1]) == (0.0, 1.0, 0.0)


@pytest.mark.slow
def test_the_limit_loads_are_those_published() -> None:
    table = table_of("snap-through")
    assert broken_limits("snap-through", table) == []
    deflection, _, _ = of_thickness(table, 6.35)
    assert np.diff(deflection).min() < 0.0  # the thin panel snaps back


@pytest.mark.slow
def test_the_limit_loads_settle_under_refinement() -> None:
    loads = []
    for elements in (4, 8, 12):
        table = table_of("snap-through", "thicknesses=[12.7]", f"elements={elements}")
        _, load, kind = of_thickness(table, 12.7)
        loads.append(load[kind == LIMIT][0])
    # a point load: deflections converge like h^2 at best
    assert abs(loads[2] - loads[1]) < 0.5 * abs(loads[1] - loads[0])
    assert loads[2] == pytest.approx(loads[1], rel=2e-3)
