"""Tensor-product patches in three dimensions: B-splines, or NURBS where they carry weights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.rational import check_weights, homogeneous, quotient


@dataclass(frozen=True)
class Patch:
    """Surface r(theta1, theta2) = sum_ij R_ij B_ij (eq. 40).

    Without weights R_ij = N_i(theta1) M_j(theta2). With weights the patch is rational,
    R_ij = w_ij N_i M_j / W with W = sum_kl w_kl N_k M_l, and cylinders and spheres are exact. Control
    points and tensor-grid points are numbered ``i * m2 + j``: direction 2 runs fastest.

    Parameters
    ----------
    first, second
        Spline spaces of the two parametric directions, of sizes m1 and m2.
    control_points
        Shape ``(m1, m2, 3)``, mm.
    weights
        All > 0, shape ``(m1, m2)``; none: a polynomial patch.
    closed
        Directions in which the patch closes to a tube: its two edges are one line, the seam, across
        which it is smooth.
    extent
        Length and width in mm that the film's own coordinates X and Y run over
        (:class:`~stages.numerics.film_lengths.FilmLengths`); none: the patch's own lengths.

    Raises
    ------
    ValueError
        If the control net or the weights do not match the spaces, or a weight is not positive.

    References
    ----------
    Piegl and Tiller, The NURBS Book (1997), eq. 4.11, and eq. 4.20 for the derivatives.
    """

    first: SplineSpace
    second: SplineSpace
    control_points: Array = field(metadata={"unit": "mm", "axes": ("row", "column", "xyz")})
    weights: Array | None = field(default=None, metadata={"axes": ("row", "column")})
    closed: tuple[bool, bool] = (False, False)
    extent: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        net = np.asarray(self.control_points, dtype=float)
        object.__setattr__(self, "control_points", net)
        if net.shape != (self.first.size, self.second.size, 3):
            raise ValueError(
                f"a control net of shape {net.shape} does not fit spaces of "
                f"{self.first.size} x {self.second.size} functions in three dimensions"
            )
        if self.weights is not None:
            weights = np.asarray(self.weights, dtype=float)
            object.__setattr__(self, "weights", weights)
            check_weights(weights, net.shape[:2])

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
        x1, x2 = np.asarray(theta1, dtype=float), np.asarray(theta2, dtype=float)

        def tensor(net: Array, k1: int, k2: int) -> Array:
            n1, n2 = self.first.evaluate(x1, k1), self.second.evaluate(x2, k2)
            grid = np.einsum("ai,bj,ijx->abx", n1, n2, net, optimize=True)
            return np.ascontiguousarray(grid.reshape(-1, net.shape[2]))

        return self._sum(tensor, orders)

    def evaluate_points(self, theta: Array, orders: tuple[int, int] = (0, 0)) -> Array:
        """The same at scattered parameters ``theta`` of shape ``(points, 2)``; shape ``(points, 3)``."""

        def tensor(net: Array, k1: int, k2: int) -> Array:
            n1, n2 = self.first.evaluate(theta[:, 0], k1), self.second.evaluate(theta[:, 1], k2)
            return np.asarray(np.einsum("pi,pj,ijx->px", n1, n2, net, optimize=True))

        return self._sum(tensor, orders)

    def functions(self, theta: Array, orders: tuple[int, int] = (0, 0)) -> Array:
        """Basis functions R_ij, or a mixed derivative of them, at scattered parameters.

        Times control values (positions, displacements) they give the field at the points.

        Returns
        -------
        Array
            Dense, shape ``(points, m1 * m2)``.
        """

        def tensor(k1: int, k2: int) -> Array:
            n1, n2 = self.first.evaluate(theta[:, 0], k1), self.second.evaluate(theta[:, 1], k2)
            return np.asarray(np.einsum("pi,pj->pij", n1, n2).reshape(len(theta), -1))

        if self.weights is None:
            return tensor(*orders)
        weights = self.weights.ravel()

        def parts(k1: int, k2: int) -> tuple[Array, Array]:
            weighted = weights * tensor(k1, k2)
            return weighted, weighted.sum(axis=1)

        return quotient(parts, orders)

    def _sum(self, tensor: Callable[[Array, int, int], Array], orders: tuple[int, int]) -> Array:
        """Control points times basis functions, given the sum over products N_i M_j."""
        if self.weights is None:
            return tensor(self.control_points, *orders)
        net = homogeneous(self.control_points, self.weights)

        def parts(k1: int, k2: int) -> tuple[Array, Array]:
            sums = tensor(net, k1, k2)
            return sums[:, :3], sums[:, 3]

        return quotient(parts, orders)

    def refine(self, degree: int, elements: tuple[int, int]) -> Patch:
        """The same surface with the same parametrisation on a finer mesh.

        Degree elevation first, then knot insertion, both exact (they change no point). A rational
        patch is refined in homogeneous coordinates.
        """
        finer = (
            self.first.refine(degree, elements[0]),
            self.second.refine(degree, elements[1]),
        )
        embed1, embed2 = self.first.embed(finer[0]), self.second.embed(finer[1])

        def embed(net: Array) -> Array:
            return np.einsum("ai,bj,ijx->abx", embed1, embed2, net, optimize=True)

        if self.weights is None:
            net, weights = embed(self.control_points), None
        else:
            lifted = embed(homogeneous(self.control_points, self.weights))
            net, weights = lifted[..., :3] / lifted[..., 3:], lifted[..., 3]
        first, second = finer
        return replace(self, first=first, second=second, control_points=net, weights=weights)

    def with_net(self, control_points: Array) -> Patch:
        """Patch over the same functions with other control points, shape ``(m1, m2, 3)``."""
        return replace(self, control_points=control_points)

    def interpolate(self, points: Array) -> Patch:
        """Patch over the same functions through ``points`` (m1 * m2, 3) at the Greville parameters.

        A rational patch keeps its weights, so that a surface that lies in the span of its functions
        comes back exactly: a scaled one, hence the offset of a cylinder or of a sphere.
        """
        grid = points.reshape(self.first.size, self.second.size, 3)
        if self.weights is None:
            return self.with_net(interpolate_grid(self.spaces, grid))
        n1, n2 = (space.evaluate(space.greville()) for space in self.spaces)
        total = n1 @ self.weights @ n2.T
        net = interpolate_grid(self.spaces, total[..., None] * grid)
        return self.with_net(net / self.weights[..., None])


def interpolate_grid(spaces: tuple[SplineSpace, SplineSpace], values: Array) -> Array:
    """Control values of the tensor spline through grid values at the Greville points (eq. 86).

    ``values`` has shape ``(m1, m2, ...)``; two banded one-dimensional solves do it.
    """
    m1, m2 = spaces[0].size, spaces[1].size
    half = spaces[0].interpolate(values.reshape(m1, -1)).reshape(values.shape)
    turned = np.moveaxis(half, 1, 0)
    solved = spaces[1].interpolate(turned.reshape(m2, -1)).reshape(turned.shape)
    return np.ascontiguousarray(np.moveaxis(solved, 0, 1))
