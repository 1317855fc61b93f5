"""The diffusion step on separable patches: diagonal in products of one-dimensional modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig
from scipy.sparse.linalg import splu

from stages.electrophysiology.diffusion import system_matrix
from stages.electrophysiology.sources import Source
from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.collocation import CollocationOperators
from stages.numerics.patches import Patch


@dataclass(frozen=True)
class Modes:
    """Eigenmodes of the one-dimensional collocated Laplacian with zero flux at both ends, or periodic ones.

    Attributes
    ----------
    to_control
        Control values of each mode, shape ``(n, n - 2)``.
    to_points
        Values of each mode at the Greville points, shape ``(n, n - 2)``.
    from_points
        Mode amplitudes from interior residuals, shape ``(n - 2, n)``; its end columns are zero.
    rates
        Eigenvalues, 1/mm^2, all <= 0.
    """

    to_control: Array
    to_points: Array
    from_points: Array
    rates: Array


def free_modes(space: SplineSpace, stiffness: float, closed: bool = False) -> Modes | None:
    """Modes of one direction, or None if they are not real and damped (then there is no fast path).

    ``stiffness`` is D^aa, 1/mm^2 per unit of the parameter squared; ``closed``: the direction runs into
    itself, with one value and one slope at both ends.
    """
    greville = space.greville()
    values, slopes, bends = (space.evaluate(greville, k) for k in range(3))
    n = space.size
    ends = np.stack((values[0] - values[-1], slopes[0] - slopes[-1])) if closed else slopes[[0, -1]]
    free = np.zeros((n, n - 2))
    free[1:-1] = np.eye(n - 2)
    free[[0, -1]] = -np.linalg.solve(ends[:, [0, -1]], ends[:, 1:-1])
    mass = values[1:-1] @ free
    rates, modes = eig(stiffness * bends[1:-1] @ free, mass)
    scale = float(np.abs(rates).max())
    if np.abs(rates.imag).max() > 1e-9 * scale or rates.real.max() > 1e-9 * scale:
        return None
    order = np.argsort(-rates.real, kind="stable")
    modes = modes.real[:, order]
    if np.linalg.cond(modes) > 1e6:
        return None
    from_points = np.zeros((n - 2, n))
    from_points[:, 1:-1] = np.linalg.inv(mass @ modes)
    to_control = free @ modes
    return Modes(to_control, values @ to_control, from_points, rates.real[order])


@dataclass(frozen=True)
class SeparableDiffusion:
    """Orthogonal, constant metric and diffusivity: the step is diagonal in products of 1-D modes.

    With zero flux on all edges the solution lies in the span of the modes (they fulfil every edge
    row, hence also the corner rows), and it is the only one. A stimulus adds its lift: the solution
    of A v = boundary data, times its amplitude. For v = modes Y + sum_k a_k lift_k, since
    (N + c Lap) lift = 2 N lift inside,

        (1 - c (l1 + l2)) Y_new = (1 + c (l1 + l2)) Y_old
                                  + W1 (2 sum_k a_k,old N lift_k + source) W2^T.
    """

    first: Modes
    second: Modes
    keep: Array
    """(1 + c (l1 + l2)) / (1 - c (l1 + l2)), shape ``(n1 - 2, n2 - 2)``."""
    gain: Array
    """1 / (1 - c (l1 + l2))."""
    lifts: Array
    """Values of each stimulus' lift at the points, shape ``(stimulus, point)``."""
    lift_modes: Array
    """W1 (2 N lift) W2^T, shape ``(stimulus, n1 - 2, n2 - 2)``."""


def is_separable(operators: CollocationOperators, tolerance: float = 1e-10) -> bool:
    """Whether metric and diffusivity are constant and orthogonal and the coordinates straight.

    Relative to what counts in the Laplacian: a Christoffel symbol multiplies v_,a, which is smaller
    than v_,ab by about the number of points, as is its rounding error.
    """

    def spread(tensor: Array) -> float:
        scale = np.array([tensor[:, 0, 0].mean(), tensor[:, 1, 1].mean()])
        mixed = np.abs(tensor[:, 0, 1]).max() / np.sqrt(scale.prod())
        return float(max(mixed, *(np.ptp(tensor[:, k, k]) / scale[k] for k in (0, 1))))

    diffusivity, points = operators.diffusivity, max(operators.shape)
    bend = max(np.abs(operators.frame.christoffel).max(), np.abs(diffusivity.divergence).max())
    uneven = (spread(operators.frame.metric_con), spread(diffusivity.components), bend / points)
    return bool(max(uneven) < tolerance)


def separable_diffusion(
    patch: Patch,
    operators: CollocationOperators,
    sources: Sequence[Source],
    diffusivity: float,
    conductivity: float,
    step: float,
) -> SeparableDiffusion | None:
    """Fast solver where the patch allows one, else None.

    ``diffusivity`` is D/C_m, mm^2/ms; ``conductivity`` D, nF/ms (turns flux data into slopes).
    """
    if not is_separable(operators):
        return None
    tensor, closed = operators.diffusivity.components[0], operators.closed
    first = free_modes(patch.first, float(tensor[0, 0]), closed[0])
    second = free_modes(patch.second, float(tensor[1, 1]), closed[1])
    if first is None or second is None:
        return None
    rate = 0.5 * step * diffusivity * (first.rates[:, None] + second.rates[None, :])
    shape = (patch.first.size, patch.second.size)
    lifts = np.zeros((len(sources), patch.size))
    if any(source.boundary.any() for source in sources):
        solver = splu(system_matrix(operators, diffusivity, step))
        for lift, source in zip(lifts, sources, strict=True):
            if source.boundary.any():
                lift[:] = operators.values @ solver.solve(source.boundary / conductivity)
    lift_modes = np.zeros((len(sources), *rate.shape))
    for modes, lift in zip(lift_modes, lifts, strict=True):
        modes[:] = first.from_points @ (2.0 * lift.reshape(shape)) @ second.from_points.T
    return SeparableDiffusion(
        first, second, (1.0 + rate) / (1.0 - rate), 1.0 / (1.0 - rate), lifts, lift_modes
    )
