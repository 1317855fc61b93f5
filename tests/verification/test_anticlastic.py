"""Curvature against width, between two closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.studies import broken_limits, table_of


def test_films_of_some_width_lie_between_the_closed_forms() -> None:
    table = table_of("anticlastic", "widths=[0.2, 0.5]", "degree=3", "elements=[6, 4]", "length=2")
    narrow, wide = table.column("shell")
    assert table.column("strip")[0] > narrow > wide > table.column("cylinder")[0]
    # the section of the theory is linear: 0.14 % on narrow films; measured here 0.17 %
    np.testing.assert_allclose(table.column("shell"), table.column("theory"), rtol=2e-3)
    # the clamp holds the film flat across, but not at mid-length; measured 0.6 %, mostly the mesh
    np.testing.assert_allclose(table.column("clamped"), table.column("shell"), rtol=8e-3)


@pytest.mark.slow
def test_films_tend_to_both_closed_forms_and_follow_the_theory_in_between() -> None:
    assert broken_limits("anticlastic", table_of("anticlastic")) == []
