"""Differential geometry of a patch at points: frames, metric, Christoffel symbols, curvature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.tubes import interpolate_closed


@dataclass(frozen=True)
class SurfaceFrame:
    """Curvilinear frame at points of a surface (eqs. 3-7, 16-18, 26, A.11); points come first.

    Attributes
    ----------
    position
        r, shape ``(point, 3)``, mm.
    tangents
        Covariant vectors a_a = r_,a, shape ``(point, 2, 3)``.
    second
        r_,ab, shape ``(point, 2, 2, 3)``.
    normal
        a_3, unit, shape ``(point, 3)``.
    """

    position: Array
    tangents: Array
    second: Array
    normal: Array
    area: Array
    """sqrt(det a_ab), shape ``(point,)``."""

    @property
    def metric_cov(self) -> Array:
        """a_ab = a_a . a_b, shape ``(point, 2, 2)``."""
        return np.einsum("pax,pbx->pab", self.tangents, self.tangents)

    @property
    def metric_con(self) -> Array:
        """a^ab, the inverse of a_ab."""
        return np.asarray(np.linalg.inv(self.metric_cov), dtype=float)

    @property
    def dual(self) -> Array:
        """Contravariant vectors a^a = a^ab a_b, shape ``(point, 2, 3)``."""
        return np.einsum("pab,pbx->pax", self.metric_con, self.tangents)

    @property
    def christoffel(self) -> Array:
        """Second kind, Gamma^c_ab = r_,ab . a^c, shape ``(point, c, a, b)`` (eq. A.11)."""
        return np.einsum("pabx,pcx->pcab", self.second, self.dual)

    @property
    def curvature(self) -> Array:
        """b_ab = r_,ab . a_3, shape ``(point, 2, 2)`` (eq. 26)."""
        return np.einsum("pabx,px->pab", self.second, self.normal)

    @property
    def normal_derivatives(self) -> Array:
        """a_3,a = -b_a^c a_c (Weingarten), shape ``(point, 2, 3)``."""
        mixed = np.einsum("pab,pbc->pac", self.curvature, self.metric_con)
        return -np.einsum("pac,pcx->pax", mixed, self.tangents)


def frame_from_derivatives(position: Array, tangents: Array, second: Array) -> SurfaceFrame:
    """Frame from r, r_,a and r_,ab.

    Raises
    ------
    ValueError
        If the surface degenerates (tangents parallel or zero) at a point.
    """
    cross = np.cross(tangents[:, 0], tangents[:, 1])
    area = np.linalg.norm(cross, axis=1)
    scale = np.linalg.norm(tangents[:, 0], axis=1) * np.linalg.norm(tangents[:, 1], axis=1)
    bad = np.flatnonzero(area <= 1e-12 * np.maximum(scale, np.finfo(float).tiny))
    if bad.size:
        raise ValueError(
            f"the surface degenerates at {position[bad[0]].tolist()} mm: no normal there"
        )
    return SurfaceFrame(position, tangents, second, cross / area[:, None], area)


def _stack(evaluate: Callable[..., Array], *theta: Array) -> SurfaceFrame:
    r = {o: evaluate(*theta, o) for o in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))}
    tangents = np.stack((r[1, 0], r[0, 1]), axis=1)
    second = np.stack(
        (np.stack((r[2, 0], r[1, 1]), axis=1), np.stack((r[1, 1], r[0, 2]), axis=1)), axis=1
    )
    return frame_from_derivatives(r[0, 0], tangents, second)


def frame_on_grid(patch: Patch, theta1: Array, theta2: Array) -> SurfaceFrame:
    """Frame at the tensor grid of two parameter lists (direction 2 fastest)."""
    return _stack(patch.evaluate, theta1, theta2)


def frame_at(patch: Patch, theta: Array) -> SurfaceFrame:
    """Frame at scattered parameters ``theta`` of shape ``(points, 2)``."""
    return _stack(patch.evaluate_points, theta)


def offset(patch: Patch, distance: float) -> Patch:
    """Parallel surface at ``distance`` along the normal, interpolated at the Greville points.

    Exact on flat patches; on curved ones exact at the Greville points and convergent with the mesh. The
    offset of a tube is as smooth across its seam as the tube.
    """
    theta = (patch.first.greville(), patch.second.greville())
    frame = frame_on_grid(patch, *theta)
    points = frame.position + distance * frame.normal
    if not any(patch.closed):
        return patch.interpolate(points)
    net = points.reshape(patch.first.size, patch.second.size, 3)
    for direction, (space, closed) in enumerate(zip(patch.spaces, patch.closed, strict=True)):
        lines = np.moveaxis(net, direction, 0)
        flat = lines.reshape(space.size, -1)
        found = interpolate_closed(space, flat[1:-1]) if closed else space.interpolate(flat)
        net = np.moveaxis(found.reshape(lines.shape), 0, direction)
    return patch.with_net(np.ascontiguousarray(net))


def locate(patch: Patch, targets: Array, tolerance: float = 1e-10) -> Array:
    """Parameters of the surface points nearest to ``targets``.

    Gauss-Newton from the nearest of a grid of samples, kept inside the domain.

    Parameters
    ----------
    targets
        Shape ``(points, 3)``, mm.
    tolerance
        Largest distance accepted, relative to the size of the patch.

    Returns
    -------
    Array
        Shape ``(points, 2)``.

    Raises
    ------
    ValueError
        If a target does not lie on the surface.
    """
    targets = np.atleast_2d(np.asarray(targets, dtype=float))
    domain = [(s.knots[0], s.knots[-1]) for s in patch.spaces]
    samples = [
        np.linspace(*d, 4 * s.elements + 9) for d, s in zip(domain, patch.spaces, strict=True)
    ]
    cloud = patch.evaluate(samples[0], samples[1])
    extent = float(np.linalg.norm(np.ptp(cloud, axis=0)))
    nearest = np.argmin(np.linalg.norm(cloud[None] - targets[:, None], axis=2), axis=1)
    row, column = np.divmod(nearest, samples[1].size)
    theta = np.stack((samples[0][row], samples[1][column]), axis=1)
    low, high = np.array(domain).T
    for _ in range(50):
        tangents = np.stack(
            (patch.evaluate_points(theta, (1, 0)), patch.evaluate_points(theta, (0, 1))), axis=1
        )
        gap = targets - patch.evaluate_points(theta)
        step = np.linalg.solve(
            np.einsum("pax,pbx->pab", tangents, tangents),
            np.einsum("pax,px->pa", tangents, gap)[..., None],
        )[..., 0]
        moved = np.clip(theta + step, low, high)
        change = float(np.abs(moved - theta).max())
        theta = moved
        if change < 1e-15 * float(np.max(high - low)):
            break
    distance = np.linalg.norm(targets - patch.evaluate_points(theta), axis=1)
    far = np.flatnonzero(distance > tolerance * extent)
    if far.size:
        raise ValueError(
            f"the point {targets[far[0]].tolist()} mm does not lie on the film: "
            f"the nearest point of it is {distance[far[0]]:.3g} mm away"
        )
    return theta
