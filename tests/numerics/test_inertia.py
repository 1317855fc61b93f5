"""Negative pivots against the eigenvalues of the dense matrix."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.numerics.inertia import negative_pivots
from stages.numerics.sparse import SymmetricBand


@settings(deadline=None)  # the first call compiles
@given(
    size=st.integers(1, 30),
    width=st.integers(0, 12),
    shift=st.floats(-5.0, 5.0),
    seed=st.integers(0, 2**31),
)
def test_pivots_have_the_signs_of_the_eigenvalues(
    size: int, width: int, shift: float, seed: int
) -> None:
    bands = np.random.default_rng(seed).uniform(-1, 1, (size, width + 1))
    for offset in range(1, width + 1):
        bands[max(size - offset, 0) :, offset] = 0.0
    bands[:, 0] += shift
    matrix = SymmetricBand(bands)
    assert negative_pivots(matrix) == int((np.linalg.eigvalsh(matrix.dense()) < 0).sum())


def test_the_matrix_is_left_as_it_was() -> None:
    bands = np.array([[2.0, -1.0], [-2.0, -1.0], [1.0, 0.0]])
    before = bands.copy()
    negative_pivots(SymmetricBand(bands))
    np.testing.assert_array_equal(bands, before)


@pytest.mark.parametrize("size", [1, 4])
def test_a_zero_matrix_has_no_negative_pivot(size: int) -> None:
    assert negative_pivots(SymmetricBand.zeros(size, 2)) == 0
