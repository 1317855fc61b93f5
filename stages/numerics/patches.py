"""Tensor-product spline patches in three dimensions."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace


@dataclass(frozen=True)
class Patch:
    """Surface r(theta1, theta2) = sum_ij N_i(theta1) M_j(theta2) B_ij (eq. 40).

    Control points and tensor-grid points are numbered ``i * m2 + j``: direction 2 runs fastest.

    Parameters
    ----------
    first, second
        Spline spaces of the two parametric directions, of sizes m1 and m2.
    control_points
        Shape ``(m1, m2, 3)``, mm.

    Raises
    ------
    ValueError
        If the control net does not match the spaces.
    """

    first: SplineSpace
    second: SplineSpace
    control_points: Array = field(metadata={"unit": "mm", "axes": ("row", "column", "xyz")})

    def __post_init__(self) -> None:
        net = np.asarray(self.control_points, dtype=float)
        object.__setattr__(self, "control_points", net)
        if net.shape != (self.first.size, self.second.size, 3):
            raise ValueError(
                f"a control net of shape {net.shape} does not fit spaces of "
                f"{self.first.size} x {self.second.size} functions in three dimensions"
            )

    @classmethod
    def rectangle(cls, length: float, width: float, height: float = 0.0) -> Patch:
        """Flat bilinear patch [0, length] x [0, width] at Z = ``height``; theta in the unit square.

        Examples
        --------
        >>> Patch.rectangle(3.5, 2.0).evaluate([0.5], [0.5]).tolist()
        [[1.75, 1.0, 0.0]]
        """
        line = SplineSpace.uniform(1, 1)
        x, y = np.meshgrid([0.0, length], [0.0, width], indexing="ij")
        return cls(line, line, np.stack((x, y, np.full_like(x, height)), axis=-1))

    @property
    def spaces(self) -> tuple[SplineSpace, SplineSpace]:
        """Both univariate spaces."""
        return self.first, self.second

    @property
    def size(self) -> int:
        """Number m1 * m2 of control points."""
        return self.first.size * self.second.size

    def evaluate(
        self,
        theta1: Array | list[float],
        theta2: Array | list[float],
        orders: tuple[int, int] = (0, 0),
    ) -> Array:
        """Positions, or a mixed derivative of them, on a tensor grid of parameters.

        Returns
        -------
        Array
            Shape ``(len(theta1) * len(theta2), 3)``, numbered as the control points.
        """
        n1 = self.first.evaluate(np.asarray(theta1, dtype=float), orders[0])
        n2 = self.second.evaluate(np.asarray(theta2, dtype=float), orders[1])
        grid = np.einsum("ai,bj,ijx->abx", n1, n2, self.control_points, optimize=True)
        return np.ascontiguousarray(grid.reshape(-1, 3))

    def evaluate_points(self, theta: Array, orders: tuple[int, int] = (0, 0)) -> Array:
        """The same at scattered parameters ``theta`` of shape ``(points, 2)``; shape ``(points, 3)``."""
        n1 = self.first.evaluate(theta[:, 0], orders[0])
        n2 = self.second.evaluate(theta[:, 1], orders[1])
        return np.asarray(np.einsum("pi,pj,ijx->px", n1, n2, self.control_points, optimize=True))

    def refine(self, degree: int, elements: tuple[int, int]) -> Patch:
        """The same surface with the same parametrisation on a finer mesh.

        Degree elevation first, then knot insertion, both exact (they change no point).
        """
        finer = (
            self.first.refine(degree, elements[0]),
            self.second.refine(degree, elements[1]),
        )
        embed1, embed2 = self.first.embed(finer[0]), self.second.embed(finer[1])
        net = np.einsum("ai,bj,ijx->abx", embed1, embed2, self.control_points, optimize=True)
        return Patch(*finer, net)

    def interpolate(self, points: Array) -> Patch:
        """Patch over the same spaces through ``points`` (m1 * m2, 3) at the Greville parameters."""
        grid = points.reshape(self.first.size, self.second.size, 3)
        return Patch(self.first, self.second, interpolate_grid(self.spaces, grid))


def interpolate_grid(spaces: tuple[SplineSpace, SplineSpace], values: Array) -> Array:
    """Control values of the tensor spline through grid values at the Greville points (eq. 86).

    ``values`` has shape ``(m1, m2, ...)``; two banded one-dimensional solves do it.
    """
    m1, m2 = spaces[0].size, spaces[1].size
    half = spaces[0].interpolate(values.reshape(m1, -1)).reshape(values.shape)
    turned = np.moveaxis(half, 1, 0)
    solved = spaces[1].interpolate(turned.reshape(m2, -1)).reshape(turned.shape)
    return np.ascontiguousarray(np.moveaxis(solved, 0, 1))
