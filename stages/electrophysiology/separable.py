"""The diffusion step on separable patches: diagonal in products of one-dimensional modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.electrophysiology.diffusion import factorise, system_matrix
from stages.electrophysiology.modes import Factors, Modes, factors, free_modes
from stages.electrophysiology.tissue import Problem
from stages.numerics.bsplines import Array
from stages.numerics.collocation import CollocationOperators
from stages.numerics.patches import Patch


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
    keep: Factors
    """(1 + c (l1 + l2)) / (1 - c (l1 + l2))."""
    gain: Factors
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


def separable_modes(patch: Patch, operators: CollocationOperators) -> tuple[Modes, Modes] | None:
    """Modes of both directions where the patch is separable, else None."""
    if not is_separable(operators):
        return None
    tensor, closed = operators.diffusivity.components[0], operators.closed
    first = free_modes(patch.first, float(tensor[0, 0]), closed[0])
    second = free_modes(patch.second, float(tensor[1, 1]), closed[1])
    return None if first is None or second is None else (first, second)


def separable_diffusion(
    problem: Problem, patch: Patch, operators: CollocationOperators
) -> SeparableDiffusion | None:
    """Fast solver where the patch allows one, else None."""
    modes = separable_modes(patch, operators)
    if modes is None:
        return None
    first, second = modes
    sources = problem.sources
    shape = (patch.first.size, patch.second.size)
    lifts = np.zeros((len(sources), patch.size))
    if any(source.boundary.any() for source in sources):
        solver = factorise(system_matrix(problem, operators))
        for lift, source in zip(lifts, sources, strict=True):
            if source.boundary.any():
                lift[:] = operators.values @ solver.solve(source.boundary / problem.conductivity)
    lift_modes = np.zeros((len(sources), first.rates.size, second.rates.size))
    for amplitudes, lift in zip(lift_modes, lifts, strict=True):
        amplitudes[:] = first.from_points @ (2.0 * lift.reshape(shape)) @ second.from_points.T
    c = 0.5 * problem.step * problem.diffusivity
    return SeparableDiffusion(
        first,
        second,
        factors(first, second, lambda z: (1.0 + z) / (1.0 - z), c),
        factors(first, second, lambda z: 1.0 / (1.0 - z), c),
        lifts,
        lift_modes,
    )
