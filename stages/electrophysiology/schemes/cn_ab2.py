"""Crank-Nicolson for diffusion, Adams-Bashforth 2 for the ionic current (sec. 3.4, eqs. 79-84)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from stages.electrophysiology.schemes.base import Scheme

if TYPE_CHECKING:
    from stages.electrophysiology.limits import Decay
    from stages.electrophysiology.tissue import Problem, Stepper
    from stages.numerics.collocation import CollocationOperators
    from stages.numerics.patches import Patch


AB2_LIMIT = 1.0
"""Step times decay up to which AB2 is stable on the negative real axis."""
RK4_LIMIT = 2.785
"""The same of RK4."""


class CrankNicolsonAdamsBashforth(Scheme):
    """The published scheme, second order while no stimulus jumps.

    One step from t_i to t_(i+1):

    1. the potential by CN for diffusion and AB2 for the ionic current (AB1 at the first step), eqs.
       82-84 with I_ion entering by -3/2 dt I_i + 1/2 dt I_(i-1);
    2. states of the cells and active stress at every collocation point by RK4, v linear over the step.

    A stimulus is read at the time levels, so that a flux which sets in between two of them acts half a
    step late.
    """

    name: Literal["cn-ab2"] = "cn-ab2"

    def stepper(
        self, problem: Problem, patch: Patch, operators: CollocationOperators, general: bool
    ) -> Stepper:
        """Stepper of the published scheme."""
        from stages.electrophysiology.diffusion import sparse_diffusion
        from stages.electrophysiology.general_stepper import GeneralStepper
        from stages.electrophysiology.separable import separable_diffusion
        from stages.electrophysiology.separable_stepper import SeparableStepper

        fast = None if general else separable_diffusion(problem, patch, operators)
        if fast is not None:
            return SeparableStepper(problem, fast, operators)
        return GeneralStepper(problem, sparse_diffusion(problem, operators), operators)

    def longest_step(self, decay: Decay) -> float:
        """AB2 for the potential, RK4 for gates and stress.

        Beyond the first, potentials on the plateau alternate: by 7 to 20 mV at 1.1 times that step for
        Aliev-Panfilov, Mitchell-Schaeffer and Bueno-Orovio, not at all at 1.0 times; at 2.3 to 2.7 times it they grow
        beyond all bounds.
        """
        slowest = max(
            decay.potential / AB2_LIMIT, decay.states / RK4_LIMIT, decay.stress / RK4_LIMIT
        )
        return math.inf if slowest <= 0.0 else 1.0 / slowest


MODEL = CrankNicolsonAdamsBashforth
