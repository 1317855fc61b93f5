"""The deformed film on a grid of points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.film_lengths import FilmLengths
from stages.numerics.projection import GaussProjection
from workflows.experiment import Experiment


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
        """Grid of nearly square cells, ``quads_along`` of them along X.

        Across, their number is even: the mid-axis, on which the probes are, is a line of the grid.
        """
        length, width = FilmLengths(experiment.geometry.mid_surface.patch).size
        across = max(2 * round(quads_along * width / length / 2), 2)
        return cls(experiment, (quads_along + 1, across + 1))

    @cached_property
    def _shell(self) -> tuple[Array, Array]:
        first, second = self.experiment.geometry.mid_surface.patch.spaces
        return (
            first.evaluate(_grid(first, self.shape[0])),
            second.evaluate(_grid(second, self.shape[1])),
        )

    @cached_property
    def _cells(self) -> tuple[Array, Array]:
        first, second = self.experiment.geometry.excitable_surface.patch.spaces
        return (
            first.cardinals(_grid(first, self.shape[0])),
            second.cardinals(_grid(second, self.shape[1])),
        )

    @cached_property
    def reference(self) -> Array:
        """Points of the undeformed film, shape ``(n1, n2, 3)``, mm."""
        return self._field(self.experiment.geometry.mid_surface.patch.control_points)

    def displacement(self, control_values: Array) -> Array:
        """Displacement at the grid, shape ``(n1, n2, 3)``, from control values ``(points, 3)``."""
        return self._field(control_values)

    def _field(self, control_values: Array) -> Array:
        first, second = self._shell
        net = control_values.reshape(first.shape[1], second.shape[1], 3)
        weights = self.experiment.geometry.mid_surface.patch.weights
        if weights is None:
            return np.einsum("ai,bj,ijx->abx", first, second, net, optimize=True)
        weighted = np.einsum(
            "ai,bj,ijx->abx", first, second, weights[..., None] * net, optimize=True
        )
        return weighted / (first @ weights @ second.T)[..., None]

    def cell_field(self, collocation_values: Array) -> Array:
        """Field at the grid, shape ``(n1, n2)``, from values at the collocation points (eq. 86)."""
        first, second = self._cells
        return first @ collocation_values.reshape(first.shape[1], second.shape[1]) @ second.T

    def gauss_field(self, values: Array) -> Array:
        """Field at the grid, shape ``(n1, n2)``, from values at the shell's Gauss points."""
        return self._gauss.on_grid(values)

    @cached_property
    def _gauss(self) -> GaussProjection:
        patch = self.experiment.geometry.mid_surface.patch
        values = self.experiment.deformation.fibre_stretch.shape[1]
        at = (_grid(space, n) for space, n in zip(patch.spaces, self.shape, strict=True))
        return GaussProjection.onto(patch, values, *at)


def _grid(space: SplineSpace, count: int) -> Array:
    return np.linspace(space.knots[0], space.knots[-1], count)
