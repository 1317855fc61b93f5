"""Why a stress that depends on the stretch is implicit in the step: a film of muscle alone.

The variant that lags, for this comparison only, takes the stress at the stretch of the step before, as codes do
that exchange stretch and stress between two solvers. On the ascending side of eq. 96 the active
stiffness, 3.5 kPa per kPa of activation, soon exceeds half of what the muscle itself resists with.
"""

from __future__ import annotations

import numpy as np

from stages.artefacts import Laminate, Layer
from stages.mechanics.body.body import Body
from stages.mechanics.dynamics.dynamics import ShellDynamics
from stages.mechanics.shell.shell import build_shell
from stages.mechanics.supports.clamped import Clamped
from stages.mechanics.tension_laws.length_dependent import LengthDependent
from stages.mechanics.tension_laws.prescribed import Prescribed
from stages.numerics.bsplines import Array
from stages.numerics.integration import Integrator
from stages.numerics.time_stepping import GeneralizedAlpha
from tests.mechanics import films
from tests.problems import observed_orders

MUSCLE = Laminate((Layer("muscle", "active", 0.022, 0.0, 1.0),))
LAW = LengthDependent(optimal_stretch=1.24, min_stretch=0.86, max_stretch=1.34, prestretch=1.14)
PATCH = films.flat((4, 2))
FOLLOWING = build_shell(PATCH, MUSCLE, films.MATERIALS, tension=LAW)
LAGGING = build_shell(PATCH, MUSCLE, films.MATERIALS, tension=Prescribed())
DURATION, PEAK = 20.0, 3.0


def shortening(steps: int, *, lags: bool, damping: float) -> Array:
    """X displacement of a corner after every step, mm; the activation rises from 0 to 3 kPa."""
    shell = LAGGING if lags else FOLLOWING
    dynamics = ShellDynamics.build(
        Body.held(shell, {"clamp": Clamped(edge="X=0")}), damping=damping
    )
    scheme = GeneralizedAlpha.damping_to(0.5)
    integrator = Integrator(scheme, films.controls(shell), shifts=False)
    travel, dt = dynamics.at_rest(dynamics.body.nothing()), DURATION / steps
    found = []
    for i in range(steps):
        motion = travel.motion
        ends = [np.full(shell.points, PEAK * rise(j / steps)) for j in (i, i + 1)]
        if lags:
            stretch = shell.fibre_stretch(motion.displacement)
            ends = [FOLLOWING.fibres.stress(field, stretch) for field in ends]
        old, new = (dynamics.body.under(field) for field in ends)
        step = dynamics.between(old, new, scheme.alpha_f)
        onward = motion.displacement + dt * motion.velocity
        travel = integrator.step(step, travel, dt, onward)
        found.append(travel.motion.displacement.reshape(-1, 3)[-1, 0])
    return np.array(found)


def rise(fraction: float) -> float:
    return float(np.sin(0.5 * np.pi * fraction) ** 2)


def test_a_stress_that_lags_oscillates_and_shorter_steps_make_it_worse() -> None:
    right = shortening(160, lags=False, damping=0.8)[-1]
    wrong = [abs(shortening(n, lags=True, damping=0.8)[-1] - right) for n in (40, 80, 160)]
    # measured: 2e-5, 4e-4 and 2e-2 mm of 0.248 mm
    assert wrong[1] > 5 * wrong[0]
    assert wrong[2] > 20 * wrong[1]
    late = np.diff(shortening(160, lags=True, damping=0.8)[-20:])
    assert np.sum(late[1:] * late[:-1] < 0) >= 6  # forth and back, while the stress only rises
    calm = np.diff(shortening(160, lags=False, damping=0.8)[-20:])
    # the second differences of the smooth motion are 1e-4 mm
    assert np.abs(calm).max() < 0.1 * np.abs(late).max()


def test_a_stress_that_follows_the_stretch_converges_at_second_order() -> None:
    ends = np.array([shortening(n, lags=False, damping=5.0)[-1] for n in (20, 40, 80, 160)])
    # successive differences, so that no reference is needed; the first steps are coarse
    np.testing.assert_allclose(observed_orders(np.abs(np.diff(ends))), 2.0, atol=0.1)
