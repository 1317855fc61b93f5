"""The monodomain solver: front speed, orders, symmetry, and one result from both steppers."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from pipeline.running.memory import MemoryRun
from stages.artefacts import ExcitableSurface
from stages.electrophysiology.general_stepper import GeneralStepper
from stages.electrophysiology.monodomain import build
from stages.electrophysiology.recording import BeatRecorder
from stages.electrophysiology.separable import is_separable
from stages.electrophysiology.separable_stepper import SeparableStepper
from stages.electrophysiology.stage import electrophysiology
from stages.electrophysiology.stimuli.edge_flux import EdgeFlux
from stages.electrophysiology.stimuli.patch_current import PatchCurrent
from stages.electrophysiology.tissue import TissueState, UnstableSolutionError
from stages.numerics.bsplines import Array
from stages.numerics.collocation import collocate
from stages.numerics.patches import Patch
from tests.paper import CELL, S1, electrophysiology_config
from tests.problems import CubicFront, observed_orders, parabolic_sheet, skewed_square

FROZEN = CELL.model_copy(update={"e_0": 0.0, "mu_1": 0.0})  # dw/dt = 0: w stays at 0


def film(elements: tuple[int, int] = (12, 6), degree: int = 2) -> Patch:
    return Patch.rectangle(3.5, 2.0).refine(degree, elements)


def advance(patch: Patch, steps: int, general: bool = False, **changes: object) -> TissueState:
    stepper, state = build(electrophysiology_config(**changes), patch, general)
    stepper.advance(state, steps)
    return state


def front_after(elements: int, step: float, duration: float, degree: int = 2) -> float:
    """Error of the front's position (mm) after a run along a narrow strip, started on the profile."""
    front, start, length = CubicFront(), 0.9, 3.5
    patch = Patch.rectangle(length, 0.1).refine(degree, (elements, 1))
    steps = round(duration / step)
    config = electrophysiology_config(
        n_steps=steps, duration=duration, output_interval=duration, cell_model=FROZEN, stimuli=()
    )
    stepper, state = build(config, patch)
    x = patch.evaluate(patch.first.greville(), patch.second.greville())[:, 0]
    state.potential[:] = 100.0 * front(x, 0.0, start) - 80.0
    state.diffusion[:] = stepper.diffusion_state(state.potential)
    v = (state.potential + 80.0) / 100.0
    state.ionic[:] = 100.0 * front.rate * v * (v - front.threshold) * (v - 1.0)
    stepper.advance(state, steps)
    found = state.potential.reshape(patch.first.size, -1)[:, 1]
    v = (found + 80.0) / 100.0
    # where the logistic profile is one half, from all points on the flank at once
    xs = patch.evaluate(patch.first.greville(), [0.5])[:, 0]
    flank = (v > 0.2) & (v < 0.8)
    position = np.mean(xs[flank] + front.width * np.log(v[flank] / (1 - v[flank])))
    return float(position - start - front.speed * duration)


def test_the_front_runs_at_the_closed_form_speed_and_converges_at_second_order() -> None:
    """c = sqrt(k_v D / (2 r_t)) (1 - 2a) = 0.017432 mm/ms (w frozen at 0), degree 2 in space."""
    assert CubicFront().speed == pytest.approx(0.017432, abs=5e-7)  # its digits
    errors = np.array([abs(front_after(n, 0.01, 40.0)) for n in (102, 204, 408)])
    # 1e-3 mm on 102 spans, falling by 4 with each halving; the time error 1e-5 mm is still small
    assert errors[-1] < 1e-4
    assert observed_orders(errors)[-1] > 1.9


def test_the_front_keeps_its_tanh_profile() -> None:
    front, patch = CubicFront(), Patch.rectangle(3.5, 0.1).refine(2, (408, 1))
    config = electrophysiology_config(
        n_steps=2000, duration=20.0, output_interval=20.0, cell_model=FROZEN, stimuli=()
    )
    stepper, state = build(config, patch)
    x = patch.evaluate(patch.first.greville(), patch.second.greville())[:, 0]
    state.potential[:] = 100.0 * front(x, 0.0, 1.0) - 80.0
    state.diffusion[:] = stepper.diffusion_state(state.potential)
    stepper.advance(state, 2000)
    exact = 100.0 * front(x, 20.0, 1.0) - 80.0
    # spatial error: h/l = 0.11, relative speed error 1e-3, that is 0.4 mV on the flank
    assert np.abs(state.potential - exact).max() < 0.5


def test_the_scheme_is_second_order_in_time() -> None:
    """CN, AB2 and RK4 together, on a smooth start: differences of successive halvings."""
    patch = film((24, 12))
    x, y = patch.evaluate(patch.first.greville(), patch.second.greville())[:, :2].T
    ends = []
    for steps in (100, 200, 400, 800):
        config = electrophysiology_config(n_steps=steps, stimuli=())
        stepper, state = build(config, patch)
        state.potential[:] = -80.0 + 60.0 * np.exp(-(((x - 1.5) / 0.6) ** 2) - y**2)
        state.diffusion[:] = stepper.diffusion_state(state.potential)
        cell, _ = stepper.problem.constants
        v = (state.potential + 80.0) / 100.0
        state.ionic[:] = 100.0 / 12.9 * cell.k_v * v * (v - cell.a) * (v - 1.0)
        stepper.advance(state, steps)
        ends.append(np.concatenate((state.potential, state.active_stress)))
    changes = np.array([np.abs(b - a).max() for a, b in itertools.pairwise(ends)])
    # AB1 at the first step costs one local second-order error, which keeps order two
    assert observed_orders(changes)[-1] > 1.8


@pytest.mark.parametrize(
    "stimuli",
    [
        (S1,),
        (EdgeFlux(edge="Y=L2", start=1.0, duration=3.0, flux=-1.5), S1),
        (
            PatchCurrent(
                x=(1.0, 2.5),
                y=(0.5, 1.2),
                start=0.5,
                duration=2.0,
                current=20.0,
            ),
            S1,
        ),
        (),
    ],
    ids=["one edge", "two edges that share a corner", "interior patch and edge", "none"],
)
@pytest.mark.parametrize("degree", [2, 3, 4])
def test_the_fast_solver_equals_the_general_one(degree: int, stimuli: tuple) -> None:
    patch = film(degree=degree)
    fast = advance(patch, 200, stimuli=stimuli, degree=degree)
    general = advance(patch, 200, general=True, stimuli=stimuli, degree=degree)
    # 200 steps of round-off 1e-14 relative to 100 mV
    np.testing.assert_allclose(fast.potential, general.potential, rtol=0, atol=1e-10)
    np.testing.assert_allclose(fast.active_stress, general.active_stress, rtol=0, atol=1e-10)


def test_flat_films_take_the_fast_solver_and_others_the_general_one() -> None:
    config = electrophysiology_config()
    assert isinstance(build(config, film())[0], SeparableStepper)
    assert isinstance(build(config, film(), general=True)[0], GeneralStepper)
    for patch in (parabolic_sheet(0.5, 3.5, 2.0), skewed_square()):
        assert isinstance(build(config, patch.refine(2, (6, 6)))[0], GeneralStepper)


@pytest.mark.parametrize(("degree", "elements"), [(2, (408, 2)), (3, (102, 60)), (3, (204, 2))])
def test_round_off_does_not_cost_a_flat_film_its_fast_solver(
    degree: int, elements: tuple[int, int]
) -> None:
    assert is_separable(collocate(film(elements, degree)))


def test_a_slightly_bent_film_is_not_taken_for_a_flat_one() -> None:
    """A sag of 1 um over 3.5 mm already counts."""
    bend = 2 * 0.001 / 3.5**2
    assert not is_separable(collocate(parabolic_sheet(bend, 3.5, 2.0).refine(2, (102, 60))))


def test_a_bent_film_carries_the_same_wave_as_a_flat_one() -> None:
    """Bending without stretch changes nothing: arrival along the arc equals arrival on the flat film."""
    from tests.problems import sheet_arc_length

    bend, x_end = 0.8, 1.6
    length = float(sheet_arc_length(bend, np.array(x_end)))
    arrivals = []
    for patch in (
        Patch.rectangle(length, 0.3).refine(4, (60, 1)),
        parabolic_sheet(bend, x_end, 0.3).refine(4, (60, 1)),
    ):
        config = electrophysiology_config(n_steps=2800, duration=140.0)
        stepper, state = build(config, patch)
        beats = BeatRecorder(state.potential, -30.0, -80.0)
        stepper.advance(state, 2800, beats.watch)
        first = beats.tables()["activation_times"][:, 0]
        arrivals.append(first.reshape(patch.first.size, -1)[-1, 0])
    # both converged to well below the time that the front takes for one span (2 ms)
    assert arrivals[0] == pytest.approx(arrivals[1], abs=0.05)


def test_an_isolated_tissue_at_rest_stays_at_rest() -> None:
    for general in (False, True):
        state = advance(film(), 50, general=general, stimuli=())
        # 50 steps, each rounds 80 mV by 1e-14 and solves with that
        np.testing.assert_allclose(state.potential, -80.0, rtol=0, atol=1e-11)


def test_a_plane_wave_does_not_depend_on_y() -> None:
    state = advance(film((24, 6)), 200)
    grid = state.potential.reshape(26, 8)
    assert np.ptp(grid[:, 0]) > 50.0  # mV: the wave is there
    # 200 steps of round-off 1e-14 relative to 100 mV
    np.testing.assert_allclose(grid, np.broadcast_to(grid[:, :1], grid.shape), rtol=0, atol=1e-10)


def test_turning_the_film_turns_the_solution() -> None:
    """S1 on X = 0 of a film equals S1 on Y = 0 of the film with its sides exchanged."""
    along_x = advance(Patch.rectangle(3.5, 2.0).refine(2, (12, 6)), 200)
    stimulus = (S1.model_copy(update={"edge": "Y=0"}),)
    along_y = advance(Patch.rectangle(2.0, 3.5).refine(2, (6, 12)), 200, stimuli=stimulus)
    turned = along_y.potential.reshape(8, 14).T
    # the same sums in another order, 200 times, on 100 mV
    np.testing.assert_allclose(along_x.potential.reshape(14, 8), turned, rtol=0, atol=1e-10)


def test_the_flux_sets_the_slope_at_the_edge() -> None:
    """n . D grad v = I_n: while S1 is on, v falls from the edge by 1000 mV/mm."""
    patch = film((48, 6))
    state = advance(patch, 50, general=True)
    slope = patch.first.evaluate(np.array([0.0]), 1) / 3.5
    profile = (slope @ state.diffusion.reshape(50, 8)).ravel()
    # the condition holds in every step: round-off of slopes of 1e3 mV/mm
    np.testing.assert_allclose(profile[1:-1], -2.0 / 0.002, rtol=1e-12)


def test_a_pulse_is_on_after_its_start_up_to_its_end() -> None:
    """On for 0 < t <= 5 at the new time level, in exact step counts."""
    stepper, _ = build(electrophysiology_config(n_steps=500), film())
    on: Array = stepper.problem.amplitudes(0, 500)[:, 0]
    assert on[0] == 0.0
    assert on.sum() == 250  # 5 ms of steps of 0.02 ms
    assert on[250] == 1.0
    assert on[251] == 0.0


def test_an_explosion_is_reported_with_its_time_and_place() -> None:
    """The paper's 2 s in steps of 5 ms: the explicit ionic current is far beyond its stability limit."""
    config = electrophysiology_config(
        elements=(20, 6),
        n_steps=400,
        duration=2000.0,
        output_interval=25.0,
        allow_unstable_step=True,
    )
    with pytest.raises(UnstableSolutionError, match="no longer finite; there is no ch") as caught:
        electrophysiology.compute(config, ExcitableSurface(film((20, 6))))
    found = re.fullmatch(r"step (\d+), t = (\d+) ms, X = 0, Y = .*, Z = 0 mm", caught.value.place)
    assert found
    step, time = map(int, found.groups())
    assert time == 5 * step
    assert time < 200  # soon after the stimulus, and not after 400 steps of nonsense
    assert "n_steps" in caught.value.remedy


class SavesEveryFrame(MemoryRun):
    """A run that takes a checkpoint after every frame."""

    def checkpoint(self, state: Callable[[], Mapping[str, Any]]) -> None:
        state()


def test_an_explosion_after_a_checkpoint_says_from_when_that_is() -> None:
    """A second pulse, so strong that it makes the cells explode."""
    strong = EdgeFlux(edge="X=0", start=6.0, duration=3.0, flux=1e9)
    config = electrophysiology_config(n_steps=100, stimuli=(strong,))
    with pytest.raises(UnstableSolutionError, match=r"the last checkpoint is of t = 6 ms"):
        electrophysiology.compute(config, ExcitableSurface(film()), run=SavesEveryFrame())


def test_a_rectangle_beside_the_film_is_refused() -> None:
    nowhere = PatchCurrent(x=(9.0, 9.5), y=(0, 1), start=0, duration=1, current=1)
    with pytest.raises(ValueError, match="lies beside the film"):
        build(electrophysiology_config(stimuli=(nowhere,)), film())
