"""Estimates of what a cell model demands, against closed forms and simulated fronts."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np
import pytest

from pipeline.canonical import canonical
from stages.electrophysiology.cell_models.base import CellModel
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.events import UNWATCHED
from stages.electrophysiology.front import tissue_front
from stages.electrophysiology.limits import decay, excitation
from stages.electrophysiology.monodomain import build
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from tests.cells import cells
from tests.paper import CELL, electrophysiology_config
from workflows.request import Request


def test_the_upstroke_of_the_cubic_current_is_found() -> None:
    """Inward between a = 0.15 and 1: it is largest at ((1 + a) + sqrt(1 - a + a^2))/3 = 0.6938."""
    found = excitation(electrophysiology_config())
    assert found is not None
    # potentials are scanned in steps of 0.5 mV
    assert found.peak == pytest.approx(20.0, abs=0.51)
    assert found.steepest == pytest.approx(-80.0 + 69.38, abs=0.5)


def test_cells_without_inward_current_carry_no_front() -> None:
    silent = CELL.model_copy(update={"k_v": 0.0})
    config = electrophysiology_config(cell_model=silent)
    assert excitation(config) is None
    assert tissue_front(config) is None


def test_the_fastest_decay_of_the_cubic_current_is_the_one_at_its_peak() -> None:
    """d(I/C_m)/dv at v* = 1 is (k_v (1 - a) + w)/r_t, with w just above 0 there; zeta_inf = 1 per ms."""
    found = decay(electrophysiology_config())
    assert found.potential == pytest.approx(8.0 * 0.85 / 12.9, rel=0.01)
    assert found.stress == pytest.approx(1.0, rel=1e-6)


def test_tissues_of_the_same_cells_are_estimated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten thousand conductivities are checked before a sweep: their cells are followed once."""
    new = CELL.model_copy(update={"k_v": 7.9})
    asked = []
    constants = type(new).constants

    def counted(model: CellModel) -> NamedTuple:
        asked.append(model)
        return constants(model)

    monkeypatch.setattr(type(new), "constants", counted)
    for conductivity in (0.001, 0.002, 0.003):
        config = electrophysiology_config(cell_model=new, conductivity=conductivity)
        found = decay(config), excitation(config), tissue_front(config)
        assert None not in found
    assert len(asked) == 3  # one for each estimate


def plateau(tissue: ElectrophysiologyConfig, n_steps: int) -> Array:
    """Potential of uniform tissue, step by step over 100 ms from the steepest point of the upstroke."""
    config = tissue.model_copy(update={"n_steps": n_steps, "duration": 100.0, "stimuli": ()})
    stepper, state = build(config, Patch.rectangle(1.0, 1.0).refine(2, (2, 2)))
    found = excitation(config)
    assert found is not None
    state.potential[:] = found.steepest
    state.diffusion[:] = stepper.diffusion_state(state.potential)
    state.ionic[:] = -found.rate * (found.peak - found.start)
    values = []
    for _ in range(n_steps):
        stepper.advance(state, 1, UNWATCHED)
        values.append(state.potential[5])
    return np.array(values)


def check_alternation(tissue: ElectrophysiologyConfig) -> None:
    longest = tissue.scheme.longest_step(decay(tissue))
    for factor, alternates in ((0.98, False), (1.15, True)):
        change = np.diff(plateau(tissue, round(100.0 / (factor * longest))))
        turns = (change[1:] * change[:-1] < 0) & (np.abs(change[1:]) > 1.0)  # of more than 1 mV
        assert (turns.sum() > 4) == alternates


def test_potentials_alternate_beyond_the_longest_step_and_not_before() -> None:
    check_alternation(electrophysiology_config())


def tissue_of(cells: str, *settings: str) -> ElectrophysiologyConfig:
    """Tissue of planar-waves with a parameter set of cells.toml."""
    overrides = [f"electrophysiology.{s}" for s in (f"cell_model={cells}", *settings)]
    allowed = "electrophysiology.allow_coarse_mesh=true"
    found: Any = Request.read("planar-waves", overrides=[*overrides, allowed]).config
    tissue: ElectrophysiologyConfig = found.electrophysiology
    return tissue


@pytest.mark.slow
@pytest.mark.parametrize(
    "cells", ["aliev-panfilov-low-threshold", "bueno-orovio", "mitchell-schaeffer"]
)
def test_they_do_so_for_other_cells(cells: str) -> None:
    check_alternation(tissue_of(cells))


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.5, 4.0])
@pytest.mark.parametrize(
    "cells", ["aliev-panfilov", "bueno-orovio-mid", "fitzhugh-nagumo", "mitchell-schaeffer"]
)
def test_the_splitting_stays_in_the_range_of_the_cells_with_any_step(
    cells: str, step: float
) -> None:
    tissue = tissue_of(cells, "scheme=strang")
    found, front = excitation(tissue), tissue_front(tissue)
    assert found is not None
    assert front is not None
    width = front.width
    steps = round(200.0 / step)
    patch = Patch.rectangle(12 * width, 0.1).refine(4, (48, 1))
    x = patch.evaluate(patch.first.greville(), patch.second.greville())[:, 0]
    changes = {"n_steps": steps, "duration": 200.0, "stimuli": ()}
    stepper, state = build(tissue.model_copy(update=changes), patch)
    state.potential[:] = np.where(x < 2 * width, found.steepest, found.start)
    for _ in range(steps):
        stepper.advance(state, 1, UNWATCHED)
        # 2 mV: splines ring a little about the jump at the start
        assert state.potential.min() > found.start - 2.0
        assert state.potential.max() < found.peak + 2.0


def test_an_unstable_step_is_refused_with_the_number_that_would_do() -> None:
    with pytest.raises(
        ValueError, match=r"steps of 2.5 ms are beyond .* (\d+) steps would do"
    ) as caught:
        electrophysiology_config(n_steps=200, duration=500.0)
    found = re.search(r"(\d+) steps would do", str(caught.value))
    assert found
    needed = int(found.group(1))
    electrophysiology_config(n_steps=needed, duration=500.0)
    with pytest.raises(ValueError, match="would do"):
        electrophysiology_config(n_steps=needed - 1, duration=500.0)
    for way_out in ({"scheme": "strang"}, {"allow_unstable_step": True}):
        electrophysiology_config(n_steps=200, duration=500.0, **way_out)


def test_going_on_with_an_unstable_step_changes_no_key() -> None:
    plain, allowed = (electrophysiology_config(allow_unstable_step=way) for way in (False, True))
    assert canonical(plain) == canonical(allowed)


def test_a_jump_of_the_current_is_no_decay() -> None:
    """Cells that start where the outward current of the minimal model sets in, as a jump in v."""
    start = -84.0 + 85.7 * 0.13
    found = decay(cells("bueno-orovio", "goektepe-kuhl", f"initial_potential={start}"))
    # 8.7 per ms along the action potential; the jump over 1e-3 mV would be some hundreds
    assert found.potential == pytest.approx(8.7, rel=0.05)


class Bistable(CellModel):
    """Cells without gates: the functions below."""

    name: str = "bistable"

    def constants(self) -> NamedTuple:
        return CELL.constants()

    def initial_states(self) -> tuple[float, ...]:
        return ()


def ionic_current(v: float, s: tuple[float, ...], p: object) -> float:
    return 0.62e-4 * (v + 80.0) * (v + 65.0) * (v - 20.0)


def state_rates(v: float, s: tuple[float, ...], p: object) -> tuple[float, ...]:
    return ()


def test_cells_without_gates_may_be_excitable() -> None:
    """They stay at the peak, where the current's slope is 0.62e-4 * 100 * 85."""
    config = electrophysiology_config(cell_model=Bistable())
    assert decay(config).potential == pytest.approx(0.62e-4 * 100.0 * 85.0, rel=1e-3)
    assert decay(config).states == 0.0
