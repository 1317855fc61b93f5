"""Energy of a moving film: the active part of the force, the balance over time, moved supports."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.interpolate import interp1d

from stages.mechanics.body.body import Body
from stages.mechanics.body.imposed import Imposed
from stages.mechanics.dynamics.dynamics import ShellDynamics
from stages.mechanics.dynamics.time_loop import TimeLoop
from stages.mechanics.shell.active_part import active_force
from stages.mechanics.shell.shell import Shell, build_shell
from stages.mechanics.supports.base import Support
from stages.mechanics.supports.clamped import Clamped
from stages.mechanics.supports.displacement import Displacement
from stages.mechanics.tension_laws.base import TensionLaw
from stages.mechanics.tension_laws.length_dependent import LengthDependent
from stages.mechanics.tension_laws.prescribed import Prescribed
from stages.numerics.bsplines import Array
from stages.numerics.integration import Integrator, Travel
from stages.numerics.time_stepping import GeneralizedAlpha
from stages.time_laws.base import TimeLaw
from stages.time_laws.smooth_pulse import SmoothPulse
from tests.mechanics import films
from tests.problems import observed_orders

TABLE_2 = LengthDependent(optimal_stretch=1.24, min_stretch=0.86, max_stretch=1.34, prestretch=1.14)
CLAMP = {"clamp": Clamped(edge="X=0")}
DURATION = 40.0


@pytest.mark.parametrize("tension", [Prescribed(), TABLE_2])
@pytest.mark.parametrize("patch", [films.uneven(), films.arched()])
def test_the_active_force_is_what_the_activation_adds(tension: TensionLaw, patch: object) -> None:
    shell = build_shell(patch, films.two_layers(), films.MATERIALS, tension=tension)
    displacement, activation = films.random_state(shell, seed=1, size=0.02)
    whole = shell.respond(displacement, activation)
    silent = shell.respond(displacement, np.zeros(shell.points))
    found = active_force(shell, whole.frames, activation)
    # the passive force, which cancels, is hundreds of times larger
    scale = np.abs(whole.force).max()
    assert np.abs(found).max() > 1e-4 * scale
    assert np.abs(found - (whole.force - silent.force)).max() < 1e-13 * scale


def loop(
    shell: Shell,
    supports: dict[str, Support],
    steps: int,
    radius: float = 0.5,
    tolerance: float | None = None,
    **rayleigh: float,
) -> TimeLoop:
    dynamics = ShellDynamics.build(Body.held(shell, supports), **{"damping": 0.0, **rayleigh})
    scheme = GeneralizedAlpha.damping_to(radius)
    integrator = Integrator(scheme, films.controls(shell), shifts=tolerance is not None)
    return TimeLoop(dynamics, integrator, DURATION / steps, 5, tolerance, 10**4)


def states(time_loop: TimeLoop, imposed: Callable[[float], Imposed], steps: int) -> list[Travel]:
    at = lambda i: imposed(i * time_loop.step)  # noqa: E731
    start = time_loop.dynamics.at_rest(at(0))
    return [arrival.travel for arrival in time_loop.run(at, start, 0, steps)]


def imbalance(time_loop: TimeLoop, travel: Travel) -> float:
    kinetic = time_loop.dynamics.kinetic_energy(travel.motion)
    return travel.works.imbalance(kinetic, travel.forces.strain_energy)


@pytest.mark.parametrize("radius", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("rayleigh", [{}, {"damping": 0.1, "stiffness_damping": 0.5}])
def test_the_energy_of_a_twitching_film_balances_to_second_order(
    radius: float, rayleigh: dict[str, float]
) -> None:
    shell = build_shell(
        films.flat((6, 2)), films.two_layers(30.0), films.MATERIALS, tension=TABLE_2
    )
    found, last = [], None
    for steps in (40, 80):
        time_loop = loop(shell, CLAMP, steps, radius, **rayleigh)
        rise = lambda t: np.full(shell.points, 7.0 * np.sin(np.pi * t / 80.0) ** 2)  # noqa: E731
        under = time_loop.dynamics.body.under
        reached = states(time_loop, lambda t, rise=rise, under=under: under(rise(t)), steps)
        found.append(max(abs(imbalance(time_loop, travel)) for travel in reached))
        last = reached[-1]
    assert last is not None
    assert last.works.activation > 50 * found[-1]
    assert last.works.external == 0.0
    assert (last.works.dissipated > 0.0) == bool(rayleigh)
    assert observed_orders(np.array(found))[0] > 1.8


class Lift(TimeLaw):
    """Up and down again within the run, without a jump of the acceleration."""

    name: str = "lift"

    def at(self, time: float) -> float:
        return float(np.sin(np.pi * time / DURATION) ** 4)


def shaken(shell: Shell, supports: dict[str, Support], steps: int, radius: float) -> Array:
    """Work of supports, kinetic and strain energy, imbalance at every step."""
    time_loop = loop(shell, supports, steps, radius, damping=0.05)
    silent, body = np.zeros(shell.points), time_loop.dynamics.body
    rows = []
    for travel in states(time_loop, lambda t: body.imposed_at(t, silent), steps):
        kinetic = time_loop.dynamics.kinetic_energy(travel.motion)
        strain = travel.forces.strain_energy
        rows.append((travel.works.supports, kinetic, strain, imbalance(time_loop, travel)))
    return np.array(rows)


@pytest.mark.parametrize("radius", [0.0, 0.5, 1.0])
def test_the_work_of_a_moved_edge_is_the_energy_that_the_film_gains(radius: float) -> None:
    """The tip is lifted and let down again."""
    shell = films.shell(films.flat((6, 2)))
    lift = Displacement(edge="X=L1", z=0.4, time_law=Lift())
    sizes = [
        np.abs(shaken(shell, {**CLAMP, "lift": lift}, n, radius)).max(axis=0) for n in (80, 160)
    ]
    work, kinetic, strain, left = sizes[-1]
    assert work > max(kinetic, strain)
    assert left < 0.06 * work
    assert observed_orders(np.array([size[3] for size in sizes]))[0] > 1.8


def test_supports_hold_at_the_end_of_each_step() -> None:
    """Not at t_alpha, where the balance holds."""
    shell = films.shell(films.flat((6, 2)))
    law = SmoothPulse(time_to_peak=25.0)
    supports = {**CLAMP, "lift": Displacement(edge="X=L1", x=-0.05, z=0.4, time_law=law)}
    time_loop = loop(shell, supports, 20)
    silent, body = np.zeros(shell.points), time_loop.dynamics.body
    for i, travel in enumerate(states(time_loop, lambda t: body.imposed_at(t, silent), 20)):
        edge = travel.motion.displacement.reshape(8, 4, 3)[-1]
        q = law.at((i + 1) * time_loop.step)
        # round-off of displacements of 0.4 mm
        np.testing.assert_allclose(edge[:, 0], -0.05 * q, rtol=0, atol=1e-15)
        np.testing.assert_allclose(edge[:, 2], 0.4 * q, rtol=0, atol=1e-15)


def test_a_support_that_starts_out_of_its_place_is_refused() -> None:
    shell = films.shell(films.flat((6, 2)))
    lift = Displacement(edge="X=L1", z=0.4, time_law=SmoothPulse(time_to_peak=25.0))
    body = Body.held(shell, {**CLAMP, "lift": lift})
    dynamics = ShellDynamics.build(body, damping=0.0)
    with pytest.raises(ValueError, match=r"support 'lift' is 1 times its motion away at t = 0"):
        dynamics.at_rest(body.imposed_at(25.0, np.zeros(shell.points)))


def twitch(shell: Shell, steps: int, tolerance: float | None, frames: int) -> tuple[Array, int]:
    """Tip displacement at equal frames, and the number of steps that it took."""
    time_loop = loop(shell, CLAMP, steps, tolerance=tolerance)
    under = time_loop.dynamics.body.under
    law, times = SmoothPulse(time_to_peak=25.0), np.linspace(0.0, DURATION, frames + 1)
    field = [np.full(shell.points, 8.0 * law.at(t)) for t in times]
    linear = interp1d(times, field, axis=0)
    reached = states(time_loop, lambda t: under(linear(min(t, DURATION))), steps)
    tips = [travel.motion.displacement[-1] for travel in reached]
    return np.array(tips[steps // frames - 1 :: steps // frames]), sum(
        travel.tally.steps for travel in reached
    )


def test_steps_that_follow_their_error_meet_the_frames_and_the_motion() -> None:
    """Undamped; the activation is linear between 20 frames in all runs but the reference.

    The tolerance is per step: the sum over the run is a multiple of it.
    """
    shell = films.shell(films.flat((6, 2)))
    reference, _ = twitch(shell, 640, None, 20)
    errors, counts = [], []
    for tolerance in (1e-3, 1e-5):
        found, count = twitch(shell, 20, tolerance, 20)
        errors.append(np.abs(found - reference).max() / shell.extent)
        counts.append(count)
    # the cube root of 100 is 4.6, in steps that divide a frame
    assert 3.0 < counts[1] / counts[0] < 8.0
    assert errors[1] < 0.2 * errors[0]
    # 20 equal steps are off by 0.01, 160 by 0.0003
    assert errors[1] < 3e-4
