"""Uniaxial tension: exact whatever the elements."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.studies import broken_limits, table_of


@pytest.mark.parametrize("settings", [("degree=2", "elements=2"), ("degree=3", "elements=1")])
def test_the_stretched_sheet_is_exact(settings: tuple[str, ...]) -> None:
    table = table_of("tension", "increments=3", *settings)
    assert broken_limits("tension", table) == []
    np.testing.assert_allclose(table.column("stretch"), [5 / 3, 7 / 3, 3.0])
    # uniform states are in every spline space: only round-off is left, some 10 units of it
    np.testing.assert_allclose(table.column("stress"), table.column("stress_exact"), rtol=1e-13)
    np.testing.assert_allclose(
        table.column("thinning"), np.array([5 / 3, 7 / 3, 3.0]) ** -0.5, rtol=1e-14
    )
