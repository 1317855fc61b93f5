"""Crank-Nicolson for diffusion, Adams-Bashforth 2 for the ionic current (sec. 3.4, eqs. 79-84)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from stages.electrophysiology.schemes.base import Scheme

if TYPE_CHECKING:
    from stages.electrophysiology.tissue import Problem, Stepper
    from stages.numerics.collocation import CollocationOperators
    from stages.numerics.patches import Patch


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


MODEL = CrankNicolsonAdamsBashforth
