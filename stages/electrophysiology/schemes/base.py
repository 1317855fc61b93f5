"""What a scheme in time is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, TypeAlias

from stages.configuration import OneOf, Section

if TYPE_CHECKING:
    from stages.electrophysiology.limits import Decay
    from stages.electrophysiology.tissue import Problem, Stepper
    from stages.numerics.collocation import CollocationOperators
    from stages.numerics.patches import Patch


class Scheme(Section):
    """A way to advance potential, states and active stress in time.

    A scheme file holds a subclass of this and names it in ``MODEL``. It is read with the configuration:
    import NumPy inside :meth:`stepper` only. An explicit part that limits the step says so in
    :meth:`longest_step`.
    """

    name: str

    def stepper(
        self, problem: Problem, patch: Patch, operators: CollocationOperators, general: bool
    ) -> Stepper:
        """Stepper of a patch: the fast one where the patch is separable, unless ``general`` is set.

        Both give the same potentials up to round-off.
        """
        raise TypeError(f"{type(self).__name__} does not say how it steps")

    def longest_step(self, decay: Decay) -> float:
        """Longest step with which cells of these decays are stable, ms; here any, since the scheme sees to it."""
        return math.inf


AnyScheme: TypeAlias = Annotated[Scheme, OneOf("stages.electrophysiology.schemes", Scheme)]
