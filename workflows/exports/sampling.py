"""The deformed film on a grid of points, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from workflows.experiment import Experiment

BLOCK = 64
"""Frames read at once: the chunk length of stored histories."""


class Frames:
    """Frames of a stored history at any time, linear between stored ones.

    One block of frames is kept; asking for times in increasing order reads every block once.
    """

    def __init__(self, field: Array, time: Array) -> None:
        self._field = field
        self._time = np.asarray(time, dtype=float)
        self._block = -1
        self._frames: Array = np.empty(0)

    def at(self, time: float) -> Array:
        """Frame at a time, in double precision; before the first and after the last: these."""
        place = float(np.interp(time, self._time, np.arange(self._time.size)))
        left = int(place)
        part = place - left
        if part < 1e-9:  # rounding of i * dt
            return self._frame(left)
        if part > 1 - 1e-9:
            return self._frame(left + 1)
        earlier = self._frame(left)
        return (1 - part) * earlier + part * self._frame(left + 1)

    def _frame(self, index: int) -> Array:
        block, offset = divmod(index, BLOCK)
        if block != self._block:
            start = block * BLOCK
            self._frames = np.asarray(self._field[start : start + BLOCK], dtype=float)
            self._block = block
        return self._frames[offset]


@dataclass(frozen=True)
class FilmGrid:
    """Grid of n1 x n2 points laid over the film, the same material points on both meshes.

    Attributes
    ----------
    experiment
        Results to draw from.
    shape
        Numbers of points along X and along Y.
    """

    experiment: Experiment
    shape: tuple[int, int]

    @classmethod
    def square(cls, experiment: Experiment, quads_along: int) -> FilmGrid:
        """Grid of nearly square cells, ``quads_along`` of them along X."""
        net = experiment.geometry.mid_surface.patch.control_points
        length, width, _ = np.ptp(net.reshape(-1, 3), axis=0)
        across = max(round(quads_along * width / length), 2)
        return cls(experiment, (quads_along + 1, across + 1))

    @cached_property
    def _shell(self) -> tuple[Array, Array]:
        first, second = self.experiment.geometry.mid_surface.patch.spaces
        return _points(first, self.shape[0]), _points(second, self.shape[1])

    @cached_property
    def _cells(self) -> tuple[Array, Array]:
        first, second = self.experiment.geometry.excitable_surface.patch.spaces
        return _cardinals(first, self.shape[0]), _cardinals(second, self.shape[1])

    @cached_property
    def reference(self) -> Array:
        """Points of the undeformed film, shape ``(n1, n2, 3)``, mm."""
        net = self.experiment.geometry.mid_surface.patch.control_points
        return np.einsum("ai,bj,ijx->abx", *self._shell, net, optimize=True)

    def displacement(self, control_values: Array) -> Array:
        """Displacement at the grid, shape ``(n1, n2, 3)``, from control values ``(points, 3)``."""
        first, second = self._shell
        net = control_values.reshape(first.shape[1], second.shape[1], 3)
        return np.einsum("ai,bj,ijx->abx", first, second, net, optimize=True)

    def cell_field(self, collocation_values: Array) -> Array:
        """Field at the grid, shape ``(n1, n2)``, from values at the collocation points (eq. 86)."""
        first, second = self._cells
        return first @ collocation_values.reshape(first.shape[1], second.shape[1]) @ second.T


def _points(space: SplineSpace, count: int) -> Array:
    return space.evaluate(np.linspace(space.knots[0], space.knots[-1], count))


def _cardinals(space: SplineSpace, count: int) -> Array:
    """Splines that are 1 at one collocation point and 0 at the others, ``(count, n)``."""
    return _points(space, count) @ space.interpolate(np.eye(space.size))
