"""Buckling of a loaded film: critical load factors at rest, and the softest motions of a shape."""

from __future__ import annotations

import numpy as np

from stages.mechanics.body.body import Balance, Body
from stages.mechanics.body.imposed import Imposed
from stages.numerics import buckling
from stages.numerics.bands import Band
from stages.numerics.bsplines import Array
from stages.numerics.buckling import Modes, NoModesError


def buckling_modes(body: Body, imposed: Imposed, number: int, part: float = 1e-4) -> Modes:
    """Factors of a loading under which the film buckles, and how, from its response at rest.

    (K0 + lambda dK/dlambda) phi = 0, with the change of the tangent along the linear response to a small
    part of the loading. Correct where the film hardly deforms before it buckles; a shell that bends
    first needs :mod:`stages.numerics.continuation`.

    Parameters
    ----------
    body, imposed
        The film, and what acts at factor one.
    number
        How many modes, smallest |factor| first; negative factors belong to the reversed loading.
    part
        Part of the loading by which the derivative is taken.

    Returns
    -------
    Modes
        Factors, and control displacements of the modes, shape ``(number, dof)``, of unit strain energy.

    Raises
    ------
    NoModesError
        If the loading changes no stiffness.
    """
    nothing = body.nothing()
    rest = body.balance(np.zeros(body.shell.size), nothing)
    response = rest.rate(imposed)
    changed = [
        body.balance(sign * part * response, nothing.towards(imposed, sign * part))
        for sign in (1.0, -1.0)
    ]
    base = rest.reduced.symmetric_part()
    # central difference: K1 = K0 + dK/dlambda
    slope = _Difference(changed[0].reduced, changed[1].reduced, 0.5 / part, base)
    free = ~body.ties.dependent
    modes = buckling.buckling_modes(base, rest.factor.solve, slope, free, number)
    return _expanded(body, modes)


def scaled_modes(body: Body, imposed: Imposed, number: int) -> tuple[Array, Array]:
    """The same factors, and modes of the shape ``(number, control point, 3)`` with a largest motion of 1.

    Raises
    ------
    NoModesError
        If nothing acts, or it changes no stiffness.
    """
    if not imposed.any():
        raise NoModesError(
            "nothing acts at the last instant of the loading, so nothing can buckle the film",
            "let loads, supports that move or the activation end at their full value (time laws)",
        )
    modes = buckling_modes(body, imposed, number)
    shapes = modes.shapes.reshape(number, -1, 3)
    largest = np.linalg.norm(shapes, axis=2).max(axis=1)
    return modes.values, np.asarray(shapes / largest[:, None, None])


def motion_before(body: Body, imposed: Imposed, factor: float) -> float:
    """Largest motion across a flat film, mm, by its linear response to a factor of what acts."""
    rest = body.balance(np.zeros(body.shell.size), body.nothing())
    return float(np.abs(factor * rest.rate(imposed)[2::3]).max())


def softest_modes(balance: Balance, number: int) -> Modes:
    """Eigenvalues of the tangent closest to zero, and their motions, at a shape.

    An eigenvalue through zero is where the film buckles or passes a limit point; negative ones are its
    unstable directions. They depend on the mesh's control points as unknowns and compare states of one
    film only.

    Parameters
    ----------
    balance
        The film in equilibrium.
    number
        How many modes.
    """
    matrix = balance.reduced.symmetric_part()
    factor = matrix.factorise()
    modes = buckling.softest_modes(matrix, factor.solve, ~balance.body.ties.dependent, number)
    return _expanded(balance.body, modes)


class _Difference:
    """K + scale (A - B) as a product."""

    def __init__(self, plus: Band, minus: Band, scale: float, base: Band) -> None:
        self.plus, self.minus = plus.symmetric_part(), minus.symmetric_part()
        self.scale, self.base = scale, base

    def __matmul__(self, vector: Array) -> Array:
        change = self.plus @ vector - self.minus @ vector
        return np.asarray(self.base @ vector + self.scale * change)


def _expanded(body: Body, modes: Modes) -> Modes:
    shapes = np.stack([body.ties.expand(shape) for shape in modes.shapes])
    return Modes(modes.values, shapes)
