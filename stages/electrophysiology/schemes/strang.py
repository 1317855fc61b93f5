"""Strang splitting: half a step of the cells, a step of diffusion, half a step of the cells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from stages.electrophysiology.schemes.base import Scheme

if TYPE_CHECKING:
    from stages.electrophysiology.tissue import Problem, Stepper
    from stages.numerics.collocation import CollocationOperators
    from stages.numerics.patches import Patch


class Strang(Scheme):
    """Second order, for steps far longer than those of the published scheme.

    The cells advance by RK4, potential and states together; diffusion with all stimuli by the
    L-stable Runge-Kutta method of two stages. The active stress, which acts on neither, follows once per
    step, with the potential running linearly between the step's ends: half as many exponentials, and
    closer than inside both half steps, where the potential runs without diffusion. Nothing is
    extrapolated from earlier steps. A stimulus enters as its mean over the step. Diffusion starts from the
    potential at interior points alone, so that edges take new flux data at once; while a flux acts, it is
    put on them again at the end of the step.

    References
    ----------
    Strang (1968), On the construction and comparison of difference schemes, SIAM J. Numer. Anal. 5, 506;
    Alexander (1977), Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal. 14,
    1006, for the L-stable method.
    """

    name: Literal["strang"] = "strang"

    def stepper(
        self, problem: Problem, patch: Patch, operators: CollocationOperators, general: bool
    ) -> Stepper:
        """Stepper of the splitting."""
        from stages.electrophysiology.edge_values import edge_values
        from stages.electrophysiology.l_stable import l_stable_diffusion
        from stages.electrophysiology.separable import separable_modes
        from stages.electrophysiology.splitting import GeneralSplitting, SeparableSplitting

        diffusion = l_stable_diffusion(problem, operators)
        edges = edge_values(problem, operators)
        modes = None if general else separable_modes(patch, operators)
        if modes is not None:
            return SeparableSplitting(problem, diffusion, modes, edges)
        return GeneralSplitting(problem, diffusion, edges)


MODEL = Strang
