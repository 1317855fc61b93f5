"""What holds a closed film together: its two edges at the seam are one smooth line."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stages.mechanics.actions.relations import weighted
from stages.numerics.patches import Patch
from stages.numerics.ties import Relation


def seams(patch: Patch) -> Iterator[Relation]:
    """Displacement and slope of a closed patch are the same on both sides of the seam.

    The slope by the parameter: u_,d at the start is that at the end, of splines without weights. So the
    deformed surface is C1 across the seam, which a thin shell needs, wherever the undeformed one is.

    Raises
    ------
    ValueError
        If a closed patch is rational: equal slopes would not join it.
    """
    grid = np.arange(patch.size).reshape(patch.first.size, patch.second.size)
    for direction in np.flatnonzero(patch.closed):
        if patch.weights is not None:
            raise ValueError(
                "a closed patch with weights cannot be joined at its seam: take one without"
            )
        space, lines = patch.spaces[direction], np.moveaxis(grid, direction, 0)
        first, last = space.evaluate(space.knots[[0, -1]], 1)
        slope = first - last
        used = np.flatnonzero(slope)
        for column in lines.T:
            for component in np.eye(3):
                yield weighted([int(column[0]), int(column[-1])], [1.0, -1.0], component)
                points = [int(i) for i in column[used]]
                yield weighted(points, [float(f) for f in slope[used]], component)
