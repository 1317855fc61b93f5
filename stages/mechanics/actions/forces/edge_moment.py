"""Moment about an edge that turns with it.

Its virtual work per length is the moment times the rotation about the edge: -delta a_3 . n, with n the
outward normal of the edge in the film's tangent plane and delta a_3 = -a^c (a_3 . delta a_c), so that

    F_I = integral of s^c N_I,c a_3,    s^c = n . a^c,

over the length of the undeformed edge: a couple that lifts the edge towards a_3 where it is positive.
With the edge along theta^b, the other direction a, L = |a_b| and J = |a_1 x a_2|,

    s^a = L/J,    s^b = -a_12/(J L)    (both with the other sign at the start of direction a).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stages.mechanics.actions.edges import across_direction, edge_quadrature, is_start
from stages.numerics.bands import GeneralBand
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch


@dataclass(frozen=True)
class EdgeMoment:
    """Moment of 1 kPa mm^2 (force times length, per length) about an edge.

    Attributes
    ----------
    across
        a: parametric direction (0 or 1) that leads away from the edge.
    nodes
        Control points whose functions bend the edge, per point of the edge; shape ``(point, local)``.
    slopes
        N_,1 and N_,2 of these, shape ``(point, 2, local)``.
    lengths
        Weights times ds of the undeformed edge, negative at the start of direction a, ``(point,)``.
    """

    across: int
    nodes: NDArray[np.int64]
    slopes: Array
    lengths: Array

    @classmethod
    def on(cls, patch: Patch, edge: str, points: int) -> EdgeMoment:
        """Moment about an edge, with ``points`` Gauss points per span."""
        theta, lengths = edge_quadrature(patch, edge, points)
        slopes = np.stack([patch.functions(theta, o) for o in ((1, 0), (0, 1))], axis=1)
        used = np.any(slopes != 0.0, axis=1)
        local = int(used.sum(axis=1).max())
        nodes = np.argsort(~used, axis=1, kind="stable")[:, :local]
        kept = np.take_along_axis(slopes, nodes[:, None], axis=2)
        nodes = np.where(np.take_along_axis(used, nodes, axis=1), nodes, nodes[:, :1])
        sign = -1.0 if is_start(edge) else 1.0
        return cls(across_direction(edge), nodes, kept, sign * lengths)

    @property
    def follows(self) -> bool:
        """Yes."""
        return True

    def at(self, position: Array) -> Array:
        """F, kPa mm^2, shape ``(dof,)``."""
        edge = self._frame(position)
        lever = np.einsum("pc,pci->pi", edge.s, self.slopes)
        force = np.zeros(position.shape)
        np.add.at(force, self.nodes, np.einsum("p,pi,px->pix", self.lengths, lever, edge.normal))
        return force.ravel()

    def add_stiffness(self, position: Array, factor: float, matrix: GeneralBand) -> None:
        """Add ``factor`` dF/du.

        From dL = a_b . da_b/L, dJ = J a^c . da_c, da_12 = a_1 . da_2 + a_2 . da_1 and da_3:
        ds^a = dL/J - s^a a^c . da_c,  ds^b = -da_12/(J L) - s^b (a^c . da_c + dL/L).
        """
        e, n, b = self._frame(position), self.slopes, 1 - self.across
        stretch = np.einsum("pcj,pcx->pjx", n, e.dual)
        longer = np.einsum("pj,px->pjx", n[:, b], e.tangents[:, b]) / e.length[:, None, None]
        shear = np.einsum("pj,px->pjx", n[:, 1], e.tangents[:, 0])
        shear += np.einsum("pj,px->pjx", n[:, 0], e.tangents[:, 1])
        j, length = e.area[:, None, None], e.length[:, None, None]
        ds = np.empty((len(j), 2, *stretch.shape[1:]))
        ds[:, self.across] = longer / j - e.s[:, self.across, None, None] * stretch
        ds[:, b] = -shear / (j * length)
        ds[:, b] -= e.s[:, b, None, None] * (stretch + longer / length)
        lever = np.einsum("pc,pci->pi", e.s, n)
        blocks = np.einsum("px,pci,pcjy->pixjy", e.normal, n, ds)
        blocks -= np.einsum("pi,pjx,py->pixjy", lever, stretch, e.normal)
        blocks *= factor * self.lengths[:, None, None, None, None]
        dofs = 3 * self.nodes[:, :, None] + np.arange(3)
        rows, columns = dofs[:, :, :, None, None], dofs[:, None, None]
        rows, columns = np.broadcast_arrays(rows, columns)
        np.add.at(matrix.bands, (columns, matrix.width + rows - columns), blocks)

    def _frame(self, position: Array) -> _Frame:
        tangents = np.einsum("pci,pix->pcx", self.slopes, position[self.nodes])
        cross = np.cross(tangents[:, 0], tangents[:, 1])
        area = np.linalg.norm(cross, axis=1)
        metric = np.einsum("pcx,pdx->pcd", tangents, tangents)
        dual = np.einsum("pcd,pdx->pcx", np.linalg.inv(metric), tangents)
        b = 1 - self.across
        length = np.sqrt(metric[:, b, b])
        s = np.empty((len(area), 2))
        s[:, self.across], s[:, b] = length / area, -metric[:, 0, 1] / (area * length)
        return _Frame(tangents, dual, cross / area[:, None], area, length, s)


@dataclass(frozen=True)
class _Frame:
    """The deformed film along the edge; ``s`` are the components s^c."""

    tangents: Array
    dual: Array
    normal: Array
    area: Array
    length: Array
    s: Array
