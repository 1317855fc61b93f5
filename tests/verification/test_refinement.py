"""How far the main job's numbers are from converged: one refinement in space, one in time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from pipeline.runner import Outcome, run
from pipeline.store import LocalStore
from workflows.request import Request

pytestmark = pytest.mark.paper
ONE_SECOND = ("electrophysiology.duration=1000.0", "mechanics.duration=1000.0")
STEPS = ("electrophysiology.n_steps=50000", "mechanics.n_steps=200")
BASE = (*ONE_SECOND, *STEPS)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> LocalStore:
    return LocalStore(tmp_path_factory.mktemp("refinement"))


def outcomes(store: LocalStore, *overrides: str) -> Mapping[str, Outcome]:
    request = Request.read("planar-waves", overrides=[*BASE, *overrides])
    return run(request.nodes(), store)


def measures(store: LocalStore, *overrides: str) -> Any:
    return outcomes(store, *overrides)["postprocessing"].load()


def test_activation_times_shift_by_less_than_half_a_millisecond_on_a_finer_mesh(
    store: LocalStore,
) -> None:
    """Measured: 0.16 and 0.30 ms at A, 0.26 and 0.43 ms at B, all later; speed -0.12 %."""
    coarse = measures(store)
    fine = measures(store, "electrophysiology.elements=[204, 120]")
    shift = fine.activation_times - coarse.activation_times
    assert np.all((shift > 0.0) & (shift < 0.5))
    np.testing.assert_allclose(fine.conduction_velocity, coarse.conduction_velocity, rtol=2e-3)
    # kPa; sampled every 5 ms, and the peak is flat
    np.testing.assert_allclose(fine.peak_active_stress, coarse.peak_active_stress, atol=0.01)


def test_activation_times_hardly_feel_half_the_time_step(store: LocalStore) -> None:
    """Measured: 0.005 ms, half of the step by which the flux pulse is late."""
    coarse = measures(store)
    fine = measures(store, "electrophysiology.n_steps=100000")
    shift = fine.activation_times - coarse.activation_times
    assert np.all(np.abs(shift) < 0.01)
    np.testing.assert_allclose(fine.peak_active_stress, coarse.peak_active_stress, atol=1e-3)


@pytest.mark.parametrize(
    ("override", "bound"),
    [
        # mm, at A, B and C; measured half of these or less
        ("mechanics.n_steps=400", (0.001, 0.002, 0.006)),
        ("mechanics.elements=[100, 20]", (0.002, 0.004, 0.012)),
    ],
    ids=["half the time step", "half the element size"],
)
def test_displacements_change_little_on_refinement(
    store: LocalStore, override: str, bound: tuple[float, float, float]
) -> None:
    coarse, fine = measures(store), measures(store, override)
    every = (fine.time.size - 1) // (coarse.time.size - 1)
    change = np.linalg.norm(fine.displacement[::every] - coarse.displacement, axis=-1).max(axis=0)
    assert np.all(change < bound)
