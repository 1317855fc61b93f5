"""Ties and band matrices against dense algebra."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.numerics.bands import Band, GeneralBand
from stages.numerics.sparse import SingularMatrixError, SymmetricBand
from stages.numerics.ties import ContradictionError, Relation, Ties, eliminate


def symmetric(size: int, width: int, seed: int) -> SymmetricBand:
    bands = np.random.default_rng(seed).uniform(-1, 1, (size, width + 1))
    for offset in range(1, width + 1):
        bands[max(size - offset, 0) :, offset] = 0.0
    bands[:, 0] += 2.0 * width + 2.0
    return SymmetricBand(bands)


def general(size: int, width: int, seed: int) -> GeneralBand:
    matrix = GeneralBand.of(symmetric(size, width, seed))
    inside = matrix.bands != 0.0
    matrix.bands[inside] += 0.3 * np.random.default_rng(seed + 1).normal(size=inside.sum())
    return matrix


def random_ties(size: int, seed: int) -> tuple[Ties, np.ndarray, np.ndarray]:
    """Ties of one or several unknowns, two of them driven; and their dense A u = B d."""
    random = np.random.default_rng(seed)
    relations = []
    for number in range(min(size // 2, 5)):
        unknowns = random.choice(size, size=min(int(random.integers(1, 4)), size), replace=False)
        factors = random.uniform(0.5, 2.0, unknowns.size) * random.choice([-1.0, 1.0])
        value = float(random.normal()) if number < 2 else 0.0
        relations.append((Relation(tuple(map(int, unknowns)), tuple(factors), value), number % 2))
    a, b = np.zeros((len(relations), size)), np.zeros((len(relations), 2))
    for row, (relation, drive) in enumerate(relations):
        a[row, list(relation.unknowns)] = relation.factors
        b[row, drive] = relation.value
    ties, _ = eliminate(size, relations, 2)
    return ties, a, b


def transformation(ties: Ties) -> np.ndarray:
    """T over the independent unknowns, dense."""
    return np.stack([ties.expand(row) for row in np.eye(ties.dependent.size)[~ties.dependent]], 1)


@settings(deadline=None)
@given(size=st.integers(4, 20), seed=st.integers(0, 10**6))
def test_every_relation_holds_for_any_values_of_the_independent_unknowns(
    size: int, seed: int
) -> None:
    try:
        ties, a, b = random_ties(size, seed)
    except ContradictionError:
        return  # two drives of one unknown
    random = np.random.default_rng(seed)
    drives = random.normal(size=2)
    u = ties.admissible(random.normal(size=size), drives)
    # elimination multiplies round-off by the growth of a few small pivots
    assert np.abs(a @ u - b @ drives).max(initial=0.0) < 1e-9
    assert np.linalg.matrix_rank(a) == ties.dependent.sum()


@settings(deadline=None)
@given(
    size=st.integers(4, 20),
    width=st.integers(0, 6),
    seed=st.integers(0, 10**6),
    unsymmetric=st.booleans(),
)
def test_a_reduced_matrix_is_the_dense_one(
    size: int, width: int, seed: int, unsymmetric: bool
) -> None:
    try:
        ties, _, _ = random_ties(size, seed)
    except ContradictionError:
        return
    matrix: Band = (general if unsymmetric else symmetric)(size, width, seed)
    t = transformation(ties)
    free = ~ties.dependent
    found = ties.reduce(matrix).dense()
    expected = t.T @ matrix.dense() @ t
    np.testing.assert_allclose(found[np.ix_(free, free)], expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(found[~free], np.eye(size)[~free])
    r = np.random.default_rng(seed).normal(size=size)
    np.testing.assert_allclose(ties.collect(r)[free], t.T @ r, rtol=1e-9, atol=1e-9)
    assert not ties.collect(r)[~free].any()


def test_a_contradiction_names_the_relations() -> None:
    relations = [
        (Relation((0,), (1.0,), 0.5), 0),
        (Relation((1,), (1.0,)), 0),
        (Relation((0, 1), (1.0, -1.0)), 0),
    ]
    with pytest.raises(ContradictionError) as failure:
        eliminate(3, relations, 1)
    assert failure.value.relation == 2
    assert failure.value.others == (0, 1)


def test_what_was_said_before_is_told() -> None:
    relations = [(Relation((0, 1), (1.0, -1.0)), 0), (Relation((1, 0), (2.0, -2.0)), 0)]
    _, repeated = eliminate(2, relations, 0)
    assert repeated == (1,)


@pytest.mark.parametrize(("size", "width"), [(12, 3), (5, 4), (4, 0), (40, 17)])
def test_a_general_band_multiplies_and_solves_as_the_dense_matrix(size: int, width: int) -> None:
    matrix = general(size, width, 0)
    x = np.random.default_rng(1).normal(size=size)
    dense = matrix.dense()
    np.testing.assert_allclose(matrix @ x, dense @ x, rtol=1e-13, atol=1e-13)
    # condition numbers are below 1e2
    np.testing.assert_allclose(matrix.factorise().solve(dense @ x), x, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(
        matrix.symmetric_part().dense(), 0.5 * (dense + dense.T), rtol=1e-14, atol=1e-14
    )
    np.testing.assert_array_equal(matrix.widened(width + 2).dense(), dense)
    fixed = np.zeros(size, dtype=bool)
    fixed[::3] = True
    held = matrix.supported(fixed).dense()
    np.testing.assert_array_equal(held[fixed], np.eye(size)[fixed])
    np.testing.assert_array_equal(held[:, fixed], np.eye(size)[:, fixed])
    np.testing.assert_array_equal(held[np.ix_(~fixed, ~fixed)], dense[np.ix_(~fixed, ~fixed)])


def test_a_singular_general_band_is_named() -> None:
    with pytest.raises(SingularMatrixError, match="pivot 1 of 4 is zero"):
        GeneralBand(np.zeros((4, 3))).factorise()
    with pytest.raises(SingularMatrixError, match="not finite"):
        GeneralBand(np.full((4, 3), np.nan)).factorise()
