"""Equilibria of a body while everything that acts on it grows from nothing in proportion."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stages.mechanics.body.body import Body
    from stages.mechanics.body.imposed import Imposed
    from stages.numerics.bsplines import Array


def ramp(
    body: Body, whole: Imposed, fractions: Sequence[float], *, first_step: float
) -> Iterator[tuple[float, Array]]:
    """Displacements at growing fractions of what acts, shape ``(dof,)``, in adaptive steps.

    Newton's tolerance is far below any error of discretisation that a study measures.

    Raises
    ------
    PathEndError
        If a fraction cannot be reached; those before it have been yielded.
    """
    import numpy as np

    from stages.mechanics.statics.loading import Loading
    from stages.numerics.newton import NewtonControls
    from stages.numerics.stepping import PathPoint, StepControls, follow

    controls = NewtonControls(
        length=body.shell.extent,
        displacement_tolerance=1e-9,
        energy_tolerance=1e-8,
        force_tolerance=1e-9,
        max_iterations=20,
    )
    steps = StepControls(initial=first_step, smallest=first_step / 1000.0)
    start = PathPoint(0.0, np.zeros(body.shell.size))
    loading = Loading(body, body.nothing(), whole)
    for point in follow(loading, start, fractions, steps, controls):
        if point.target is not None:
            yield point.s, point.x
