"""Cantilevers bent far: rolled up by a moment, and sheared at the end."""

from __future__ import annotations

import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.cantilever import finest, tip_errors

COARSE = ("degrees=[4]", "elements=[8]")


@pytest.mark.parametrize(
    ("name", "coarse_error"),
    [
        # mm; on eight quartic elements measured 0.051, over a full circle, and 0.000046
        ("roll-up", 0.06),
        ("end-shear", 0.00006),
    ],
)
def test_the_bent_strip_follows_the_exact_one(name: str, coarse_error: float) -> None:
    table = table_of(name, *COARSE)
    assert finest(table).all()
    assert tip_errors(table, "exact").max() < coarse_error
    # the published tips ignore that the strip stretches, or are computed on a coarse mesh
    assert tip_errors(table, "published").max() < 0.01 + coarse_error


@pytest.mark.slow
@pytest.mark.parametrize("name", ["roll-up", "end-shear"])
def test_the_strip_converges_to_the_exact_one(name: str) -> None:
    assert broken_limits(name, table_of(name)) == []
