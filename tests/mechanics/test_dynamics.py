"""Motion of the shell: rest, energy, damping, halved steps, failures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field, replace

import numpy as np
import pytest

from stages.mechanics.dynamics.dynamics import ShellDynamics
from stages.mechanics.dynamics.time_loop import Arrival, TimeLoop
from stages.mechanics.shell.shell import Shell
from stages.numerics.bsplines import Array
from stages.numerics.halving import UnsolvedStepError
from stages.numerics.integration import Integrator, Travel
from stages.numerics.newton import DivergenceError, NewtonControls, NewtonSolution
from stages.numerics.time_stepping import GeneralizedAlpha, Motion, MotionProblem
from tests.mechanics import films
from tests.mechanics.load_path import LoadPath


@pytest.fixture(scope="module")
def body() -> Shell:
    return films.shell(films.flat((8, 3)))


def loop(
    body: Shell,
    step: float,
    damping: float = 0.0,
    radius: float = 0.5,
    max_iterations: int = 15,
    max_halvings: int = 5,
    stiffness_damping: float = 0.0,
    tolerance: float | None = None,
) -> TimeLoop:
    dynamics = ShellDynamics.build(
        films.clamped(body),
        damping=damping,
        stiffness_damping=stiffness_damping,
    )
    controls = films.controls(body, max_iterations=max_iterations)
    integrator = Integrator(
        GeneralizedAlpha.damping_to(radius), controls, shifts=tolerance is not None
    )
    return TimeLoop(dynamics, integrator, step, max_halvings, tolerance, max_substeps=10**4)


def run(
    time_loop: TimeLoop, stress: Callable[[int], Array], start: Travel, first: int, last: int
) -> Iterator[Arrival]:
    """Steps under an activation alone."""
    under = time_loop.dynamics.body.under
    return time_loop.run(lambda i: under(stress(i)), start, first, last)


def at_rest(time_loop: TimeLoop) -> Travel:
    """Undeformed, under nothing."""
    return time_loop.dynamics.at_rest(time_loop.dynamics.body.nothing())


def with_scheme(time_loop: TimeLoop, scheme: GeneralizedAlpha) -> TimeLoop:
    return replace(time_loop, integrator=replace(time_loop.integrator, scheme=scheme))


def energy(time_loop: TimeLoop, travel: Travel) -> float:
    """Kinetic and passive strain energy."""
    return time_loop.dynamics.kinetic_energy(travel.motion) + travel.forces.strain_energy


def bent(body: Shell, stress: float) -> Array:
    held = films.clamped(body)
    target = held.under(np.full(body.points, stress))
    *_, last = LoadPath(held, target, 10, films.controls(body), 5).follow()
    return last.state.displacement


def test_a_film_at_rest_stays_at_rest_exactly(body: Shell) -> None:
    time_loop = loop(body, 5.0, damping=0.8)
    silent = np.zeros(body.points)
    for result in run(time_loop, lambda _: silent, at_rest(time_loop), 0, 3):
        assert not result.travel.motion.displacement.any()
        assert not result.travel.motion.velocity.any()
        assert not result.travel.motion.acceleration.any()
        assert result.iterations == 1


@pytest.mark.parametrize(("stress", "step", "damping"), [(0.5, 0.5, 0.0), (4.0, 5.0, 0.8)])
def test_the_energy_of_a_released_film_decays_and_never_grows(
    body: Shell, stress: float, step: float, damping: float
) -> None:
    """Bent in equilibrium, then let go at rho_inf = 0.5: by the method alone in steps that follow the
    motion, and with the paper's damping in the paper's steps."""
    time_loop = loop(body, step, damping=damping)
    start, silent = bent(body, stress), np.zeros(body.points)
    motion = Motion(start, np.zeros_like(start), np.zeros_like(start))
    steps = round(120.0 / step)
    begin = time_loop.dynamics.starting_from(motion, time_loop.dynamics.body.nothing())
    states = [begin, *(r.travel for r in run(time_loop, lambda _: silent, begin, 0, steps))]
    energies = np.array([energy(time_loop, state) for state in states])
    # the method dissipates every linear mode; round-off of the energy is 1e-13 of its start
    assert np.diff(energies).max() < 1e-12 * energies[0]
    assert energies[-1] < 0.7 * energies[0]


def test_the_film_settles_in_its_static_equilibrium(body: Shell) -> None:
    """A stress raised over 50 ms and then held, with damping: the motion ends where statics does."""
    time_loop = loop(body, 10.0, damping=0.05)
    stress = lambda i: np.full(body.points, 4.0 * min(i / 5, 1.0))  # noqa: E731
    *_, last = run(time_loop, stress, at_rest(time_loop), 0, 300)
    # 3 s are many times the relaxation time; what is left is exponentially small
    assert np.abs(last.travel.motion.displacement - bent(body, 4.0)).max() < 1e-7


def test_both_parts_of_rayleigh_damping_take_energy_out(body: Shell) -> None:
    stress = lambda i: np.full(body.points, 2.0 * min(i / 4, 1.0))  # noqa: E731
    speeds = []
    for mass_part, stiffness_part in ((0.0, 0.0), (0.05, 0.0), (0.0, 5.0)):
        time_loop = loop(body, 2.0, damping=mass_part, stiffness_damping=stiffness_part)
        *_, last = run(time_loop, stress, at_rest(time_loop), 0, 30)
        speeds.append(time_loop.dynamics.kinetic_energy(last.travel.motion))
    assert speeds[1] < 0.5 * speeds[0]
    assert speeds[2] < 0.5 * speeds[0]


def test_the_activation_acts_at_t_alpha_with_two_thirds_of_its_new_value(body: Shell) -> None:
    """sigma(t_alpha) = alpha_f sigma(t_{i+1}) + (1 - alpha_f) sigma(t_i); alpha_f = 2/3 at 0.5."""
    time_loop = loop(body, 5.0, damping=0.8)
    rest = at_rest(time_loop)
    fields = [np.full(body.points, 1.0), np.full(body.points, 4.0)]
    (result,) = run(time_loop, lambda i: fields[i], rest, 0, 1)
    acting = time_loop.dynamics.body.under(np.full(body.points, 2 / 3 * 4.0 + 1 / 3 * 1.0))
    blended = time_loop.dynamics.between(acting, acting, 1.0)
    by_hand, _ = time_loop.integrator.scheme.step(
        blended, rest.motion, 5.0, rest.motion.displacement, time_loop.integrator.controls
    )
    # Newton's tolerance: the fields agree to round-off only
    assert np.abs(result.travel.motion.displacement - by_hand.displacement).max() < 1e-12


def test_a_step_that_fails_is_halved_and_the_next_one_starts_on_the_grid(body: Shell) -> None:
    """Bit-equal to two steps of half the length, on the interpolated field, and one of full length."""
    jump = [np.zeros(body.points), np.full(body.points, 6.0), np.full(body.points, 6.0)]
    for limit in range(3, 15):
        coarse = loop(body, 5.0, damping=5.0, max_iterations=limit)
        results = list(run(coarse, lambda i: jump[i], at_rest(coarse), 0, 2))
        if [r.halvings for r in results] == [1, 0]:
            break
    assert [r.halvings for r in results] == [1, 0]
    fine = loop(body, 2.5, damping=5.0, max_iterations=limit)
    half = [jump[0], 0.5 * jump[1], jump[1]]
    *_, middle = run(fine, lambda i: half[i], at_rest(fine), 0, 2)
    (end,) = run(coarse, lambda i: jump[i], middle.travel, 1, 2)
    np.testing.assert_array_equal(
        results[0].travel.motion.displacement, middle.travel.motion.displacement
    )
    np.testing.assert_array_equal(
        results[1].travel.motion.displacement, end.travel.motion.displacement
    )


@dataclass(frozen=True)
class LedAstray(GeneralizedAlpha):
    """Generalized-alpha that diverges from any guess but the old displacement."""

    def step(
        self,
        problem: MotionProblem,
        old: Motion,
        step: float,
        guess: Array,
        controls: NewtonControls,
    ) -> tuple[Motion, NewtonSolution]:
        if not np.array_equal(guess, old.displacement):
            raise DivergenceError(())
        return super().step(problem, old, step, guess, controls)


def test_a_guess_that_leads_astray_is_replaced_before_the_step_is_halved(body: Shell) -> None:
    stress = lambda i: np.full(body.points, 0.5 * i)  # noqa: E731
    plain = loop(body, 5.0, damping=0.8)
    astray = with_scheme(plain, LedAstray(**asdict(plain.integrator.scheme)))
    *_, expected = run(plain, stress, at_rest(plain), 0, 4)
    *_, found = run(astray, stress, at_rest(astray), 0, 4)
    assert found.halvings == 0
    # another guess, the same equations: Newton's tolerance
    assert (
        np.abs(found.travel.motion.displacement - expected.travel.motion.displacement).max() < 1e-9
    )


@dataclass(frozen=True)
class NeverSolved(GeneralizedAlpha):
    """Generalized-alpha that diverges from every guess, and counts them."""

    guesses: list[Array] = field(default_factory=list)

    def step(
        self,
        problem: MotionProblem,
        old: Motion,
        step: float,
        guess: Array,
        controls: NewtonControls,
    ) -> tuple[Motion, NewtonSolution]:
        self.guesses.append(guess)
        raise DivergenceError(())


@pytest.mark.parametrize(("speed", "guesses"), [(0.0, 1), (1e-3, 2)])
def test_a_guess_is_not_tried_twice(body: Shell, speed: float, guesses: int) -> None:
    """At rest, going on at the old velocity and staying where one is are the same."""
    plain = loop(body, 5.0, max_halvings=0)
    scheme = NeverSolved(**asdict(plain.integrator.scheme))
    zero, silent = np.zeros(body.size), np.zeros(body.points)
    moving = Motion(zero, np.full(body.size, speed), zero)
    start = plain.dynamics.starting_from(moving, plain.dynamics.body.nothing())
    with pytest.raises(UnsolvedStepError, match="over 5 ms at once"):
        next(run(with_scheme(plain, scheme), lambda _: silent, start, 0, 1))
    assert len(scheme.guesses) == guesses


def test_a_hopeless_step_names_itself_and_keeps_what_was_computed(body: Shell) -> None:
    stress = lambda i: np.full(body.points, 1.0 if i < 3 else 1e5)  # noqa: E731
    time_loop = loop(body, 5.0, max_halvings=2)
    steps = run(time_loop, stress, at_rest(time_loop), 0, 5)
    kept = [next(steps), next(steps)]
    with pytest.raises(UnsolvedStepError, match=r"even in parts of 1\.25 ms") as failure:
        next(steps)
    assert [k.halvings for k in kept] == [0, 0]
    assert failure.value.place == "step 3, t = 10 ms"
    assert "max_halvings" in failure.value.remedy
    assert "max |R| by iteration" in str(failure.value)


def test_a_run_cut_in_two_is_bit_equal_to_one(body: Shell) -> None:
    stress = lambda i: np.full(body.points, 0.5 * i)  # noqa: E731
    time_loop = loop(body, 5.0, damping=0.8)
    *_, whole = run(time_loop, stress, at_rest(time_loop), 0, 6)
    *_, first = run(time_loop, stress, at_rest(time_loop), 0, 3)
    *_, second = run(time_loop, stress, first.travel, 3, 6)
    np.testing.assert_array_equal(
        whole.travel.motion.displacement, second.travel.motion.displacement
    )
    np.testing.assert_array_equal(
        whole.travel.motion.acceleration, second.travel.motion.acceleration
    )
