"""Membrane locking: quadratic elements that are too long for the curvature they are to follow.

Along an element of length h that bends to a curvature k, quadratic splines cannot keep the mid-surface
unstretched. The thinner the film (thickness d), the more the strain that is left counts beside bending; the
error follows h^2 k/d, see ``LARGEST``. Cubic splines lock far less.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stages.mechanics.shell.shell import Shell
from stages.numerics.bsplines import Array
from stages.numerics.time_series import StoredFrames, blocks

LARGEST = 0.6
"""h^2 k/d up to which the curvature of a curling film is right to about 2.5 %.

Measured on the film of section 4.1 against 100 x 20 elements: 0.5 % too little curvature at 0.08, 1.1 % at
0.45, 2.4 % at 0.66, 5 % at 1.2, 8 % at 1.4, 19 % at 2.8; cubic elements stay within 1.9 % up to 17.
"""


def sag(shell: Shell, displacement: Array) -> tuple[float, float]:
    """h^2 k/d along both directions: mean over the film of the change of curvature b_aa.

    In parameters it is (delta theta^a)^2 |b_aa - B_aa|/d, which needs no lengths.

    Parameters
    ----------
    displacement
        Of the control points, mm, shape ``(dof,)``.
    """
    change = np.abs(shell.frames(displacement).curvature - shell.reference.curvature)
    spans = [np.repeat(np.diff(s.breaks), shell.basis.points) for s in shell.patch.spaces]
    grid = change.reshape(spans[0].size, spans[1].size, 3)
    thickness = sum(points.layer.thickness for points in shell.layers)
    along = np.mean(spans[0][:, None] ** 2 * grid[..., 0]) / thickness
    across = np.mean(spans[1] ** 2 * grid[..., 1]) / thickness
    return float(along), float(across)


def locked(shell: Shell, displacement: StoredFrames) -> Iterator[str]:
    """A warning for each direction in which quadratic elements are too long for a stored shape.

    Parameters
    ----------
    displacement
        Shape ``(frame, control point, xyz)``, mm.
    """
    degrees = [space.degree for space in shell.patch.spaces]
    if min(degrees) > 2:
        return
    sags = np.array([sag(shell, u.ravel()) for _, block in blocks(displacement) for u in block])
    for name, degree, space, most in zip(
        "XY", degrees, shell.patch.spaces, sags.max(axis=0), strict=True
    ):
        if degree == 2 and most > LARGEST:
            wanted = int(np.ceil(space.elements * np.sqrt(most / LARGEST)))
            yield (
                f"the mesh is too coarse for how much the film bends: {space.elements} quadratic elements "
                f"along {name} stiffen it (membrane locking, h^2 k/d = {most:.2g}, at most {LARGEST}), and it "
                f"curls too little; take about {wanted} elements or more along {name} "
                f"(mechanics.elements), or mechanics.degree = 3"
            )
