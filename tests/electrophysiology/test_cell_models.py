"""Every cell model with every tension law: compiled loops against plain twins and SciPy's integrator."""

from __future__ import annotations

import numpy as np
import pytest

from stages.artefacts import ExcitableSurface
from stages.electrophysiology.cell_config import CellConfig
from stages.electrophysiology.reaction import Cells, compile_reaction
from stages.electrophysiology.single_cell import Pulse, follow, rest
from stages.electrophysiology.stage import electrophysiology
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from tests.cells import CELL_MODELS, TENSION_LAWS, cells, integrated, slope
from tests.paper import electrophysiology_config

ONE_SET_A_MODEL = ("aliev-panfilov", "fitzhugh-nagumo", "mitchell-schaeffer", "bueno-orovio")
SWITCHING = ("mitchell-schaeffer", "bueno-orovio")

every_pair = pytest.mark.parametrize(
    "config",
    [
        pytest.param(cells(model, law), id=f"{model}, {law}")
        for model in ONE_SET_A_MODEL
        for law in TENSION_LAWS
    ],
)


def anywhere(config: CellConfig, count: int) -> Array:
    """Random potentials, states and stresses, shape ``(variable, point)``."""
    random = np.random.default_rng(5)
    states = random.uniform(0.0, 1.0, (len(config.cell_model.initial_states()), count))
    v, stress = random.uniform(-90.0, 40.0, count), random.uniform(0.0, 12.0, count)
    return np.vstack((v, states, stress))


def arrays(y: Array) -> Cells:
    """The same as the compiled loops take it."""
    points = y.shape[1]
    return Cells(y[0].copy(), y[1:-1].copy(), y[-1].copy(), np.zeros(points))


@every_pair
def test_react_equals_its_plain_twin(config: CellConfig) -> None:
    y, step = anywhere(config, 101), 0.05
    applied = np.random.default_rng(6).normal(0.0, 10.0, 101)
    ends = []
    for start, on in zip(y.T, applied, strict=True):
        k1 = slope(config, start, on)
        k2 = slope(config, start + 0.5 * step * k1, on)
        k3 = slope(config, start + 0.5 * step * k2, on)
        k4 = slope(config, start + step * k3, on)
        ends.append(start + step / 6.0 * (k1 + 2 * (k2 + k3) + k4))
    found = arrays(y)
    constants = config.cell_model.constants(), config.tension_law.constants()
    compile_reaction(config.cell_model, config.tension_law).react(
        found, applied, step, 1, *constants
    )
    # round-off, which the steep switches enlarge a hundredfold
    np.testing.assert_allclose(
        np.vstack((found.potential, found.states, found.stress)),
        np.transpose(ends),
        rtol=1e-12,
        atol=1e-12,
    )


@every_pair
def test_advance_equals_its_plain_twin(config: CellConfig) -> None:
    y, step = anywhere(config, 101), 0.05
    new = y[0] + np.random.default_rng(7).normal(0.0, 1.0, 101)
    ends, currents = [], []
    for start, v1 in zip(y.T, new, strict=True):

        def rates(z: Array, fraction: float, v0: float = start[0], v1: float = v1) -> Array:
            return slope(config, np.array([v0 + fraction * (v1 - v0), *z]), 0.0)[1:]

        z = start[1:]
        k1 = rates(z, 0.0)
        k2 = rates(z + 0.5 * step * k1, 0.5)
        k3 = rates(z + 0.5 * step * k2, 0.5)
        k4 = rates(z + step * k3, 1.0)
        ends.append(z + step / 6.0 * (k1 + 2 * (k2 + k3) + k4))
        currents.append(-slope(config, np.array([v1, *ends[-1]]), 0.0)[0])
    found = arrays(y)
    constants = config.cell_model.constants(), config.tension_law.constants()
    compile_reaction(config.cell_model, config.tension_law).advance(found, new, step, *constants)
    np.testing.assert_allclose(  # round-off, as above; currents are differences of large terms
        np.vstack((found.states, found.stress)), np.transpose(ends), rtol=1e-12, atol=1e-12
    )
    np.testing.assert_allclose(found.ionic, currents, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("tension_law", TENSION_LAWS)
@pytest.mark.parametrize("cell_model", CELL_MODELS)
def test_an_action_potential_agrees_with_an_independent_integrator(
    cell_model: str, tension_law: str
) -> None:
    config = cells(cell_model, tension_law)
    pulse = Pulse(start=5.0, duration=2.0, rate=25.0)
    trace = follow(config, [pulse], duration=500.0, step=0.01)
    every = slice(None, None, 10)
    exact = integrated(
        config, rest(config), pulse, trace.time[every], method="DOP853", rtol=1e-9, atol=1e-10
    )
    # Fourth order where the equations are smooth. Where they jump (gates that turn at a threshold, the
    # stress of Nash and Panfilov), a step loses up to step * jump: some hundredths of 1 mV or 1 kPa.
    smooth = not cell_model.startswith(SWITCHING)
    np.testing.assert_allclose(
        trace.potential[every], exact.potential, rtol=0.0, atol=2e-6 if smooth else 0.05
    )
    np.testing.assert_allclose(
        trace.stress[every],
        exact.stress,
        rtol=0.0,
        atol=2e-5 if smooth and tension_law == "goektepe-kuhl" else 0.02,
    )
    assert trace.potential.max() > 10.0  # excited
    assert abs(trace.potential[-1] - config.initial_potential) < 15.0  # and back, or nearly


@pytest.mark.parametrize("cell_model", CELL_MODELS)
def test_cells_start_at_a_rest_without_stress(cell_model: str) -> None:
    for law in TENSION_LAWS:
        config = cells(cell_model, law)
        assert config.initial_potential == config.cell_model.rest_potential()
        start = rest(config)
        assert slope(config, np.array([start.potential, *start.states, start.stress]), 0.0)[0] == 0
        quiet = follow(config, [], duration=50.0, step=0.05)
        np.testing.assert_array_equal(quiet.potential, start.potential)
        np.testing.assert_array_equal(quiet.stress, 0.0)


def test_the_resting_potential_moves_with_the_cells() -> None:
    """A shift of the scale of the potential shifts everything; the stress sees no difference."""
    pulse = [Pulse(5.0, 2.0, 25.0)]
    trace = follow(cells("mitchell-schaeffer", "nash-panfilov"), pulse, 100.0, 0.02)
    shifted = cells("mitchell-schaeffer", "nash-panfilov", "cell_model.potential_rest=-60")
    moved = follow(shifted, pulse, 100.0, 0.02)
    # to round-off, but for what it does to the time step in which a gate turns
    np.testing.assert_allclose(moved.potential - 20.0, trace.potential, atol=1e-3)
    np.testing.assert_allclose(moved.stress, trace.stress, atol=1e-3)


def test_a_tension_law_without_cells_asks_for_its_resting_potential() -> None:
    law = cells("aliev-panfilov").tension_law
    assert law.model_copy(update={"v_r": -60.0}).constants()[1] == -60.0
    with pytest.raises(ValueError, match="goektepe-kuhl needs a resting potential v_r"):
        law.model_copy(update={"v_r": None}).constants()


def test_mitchell_and_schaeffer_s_formula_gives_the_duration() -> None:
    """With a slow gate the plateau lasts while it closes from 1 to h_min = 4 tau_in/tau_out."""
    config = cells("mitchell-schaeffer", "goektepe-kuhl", "cell_model.tau_close=3000")
    p = config.cell_model.constants()
    trace = follow(config, [Pulse(5.0, 2.0, 25.0)], duration=6000.0, step=0.05)
    plateau = np.flatnonzero(trace.potential > -30.0)
    lasted = trace.time[plateau[-1]] - trace.time[plateau[0]]
    # the fall takes longer by some (tau_out^2 tau_close)^(1/3) = 48 ms, as at any fold
    formula = p.tau_close * np.log(p.tau_out / (4.0 * p.tau_in))
    assert lasted - formula == pytest.approx(0.0, abs=150.0)
    assert formula > 4800.0


def test_gates_of_the_minimal_model_stay_between_their_targets() -> None:
    for name in CELL_MODELS:
        if name.startswith("bueno-orovio"):
            trace = follow(cells(name), [Pulse(5.0, 2.0, 25.0)], duration=800.0, step=0.02)
            assert trace.states.min() >= 0.0
            assert trace.states.max() <= 1.0


@pytest.mark.slow
@pytest.mark.parametrize("cell_model", CELL_MODELS)
def test_a_wave_crosses_a_film_of_every_cell(cell_model: str) -> None:
    """Tissue that conducts 25 times as well, as in the small test runs: the front is wide."""
    config = cells(cell_model)
    chosen = {
        name: getattr(config, name) for name in ("cell_model", "tension_law", "initial_potential")
    }
    stimulus = electrophysiology_config().stimuli[0].model_copy(update={"flux": 12.0})
    film = electrophysiology_config(
        elements=(40, 4),
        n_steps=4000,
        duration=80.0,
        conductivity=0.05,
        stimuli=(stimulus,),
        **chosen,
    )
    surface = ExcitableSurface(Patch.rectangle(3.5, 0.4).refine(2, (40, 4)))
    history = electrophysiology.compute(film, surface)
    arrivals = history.activation_times[:, 0].reshape(42, 6)
    assert np.isfinite(arrivals).all()
    inner = arrivals[8:34]
    assert np.all(np.diff(inner, axis=0) > 0.0)
    np.testing.assert_allclose(inner, inner[:, :1].repeat(6, axis=1), rtol=1e-6)  # a plane wave
