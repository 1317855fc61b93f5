"""Plain NumPy twin of the compiled shell kernels: the equations as einsum, points first."""

from __future__ import annotations

import numpy as np

from stages.mechanics.materials.base import Incompressible, law_of
from stages.mechanics.shell.shell import Shell
from stages.mechanics.tension_laws.base import TensionLaw, functions_of
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.quadrature import QuadratureGrid, quadrature_grid
from stages.numerics.surface_geometry import SurfaceFrame, frame_on_grid

ORDERS = {(1,): (1, 0), (2,): (0, 1), (1, 1): (2, 0), (2, 2): (0, 2), (1, 2): (1, 1)}


def respond(body: Shell, displacement: Array, activation: Array) -> tuple[Array, Array, float]:
    """Internal force (dof,), dense tangent (dof, dof) and passive energy (eqs. 24-51)."""
    patch = body.patch
    moved = patch.control_points + displacement.reshape(patch.control_points.shape)
    grid = quadrature_grid(patch, body.basis.points)
    reference = frame_on_grid(patch, grid.theta1, grid.theta2)
    current = frame_on_grid(patch.with_net(moved), grid.theta1, grid.theta2)
    weights = (grid.weights1[:, None] * grid.weights2).ravel() * reference.area

    eps = 0.5 * (current.metric_cov - reference.metric_cov)
    kap = reference.curvature - current.curvature
    n, m = np.zeros_like(eps), np.zeros_like(eps)
    c0, c1, c2 = (np.zeros((*eps.shape, 2, 2)) for _ in range(3))
    energy = 0.0
    for points in body.layers:
        pull = points.layer.activity * activation
        for z, w in zip(points.depth, points.weights, strict=True):
            psi, s, c = _point(points, reference, eps + z * kap, pull, z, body.tension)
            n, m = n + w * s, m + w * z * s
            c0, c1, c2 = c0 + w * c, c1 + w * z * c, c2 + w * z**2 * c
            energy += float(weights @ psi) * w

    b1 = _values(patch, grid, (1, 0)), _values(patch, grid, (0, 1))
    first = np.stack(b1, axis=1)  # (point, a, node)
    second = np.stack(
        [
            np.stack([_values(patch, grid, o) for o in row], axis=1)
            for row in (((2, 0), (1, 1)), ((1, 1), (0, 2)))
        ],
        axis=1,
    )
    h = second - np.einsum("pcab,pci->pabi", current.christoffel, first)
    d_eps = 0.5 * (
        np.einsum("pai,pbx->pabix", first, current.tangents)
        + np.einsum("pbi,pax->pabix", first, current.tangents)
    )
    d_kap = -np.einsum("pabi,px->pabix", h, current.normal)

    force = np.einsum("p,pab,pabix->ix", weights, n, d_eps)
    force += np.einsum("p,pab,pabix->ix", weights, m, d_kap)

    dn = np.einsum("pabcd,pcdix->pabix", c0, d_eps) + np.einsum("pabcd,pcdix->pabix", c1, d_kap)
    dm = np.einsum("pabcd,pcdix->pabix", c1, d_eps) + np.einsum("pabcd,pcdix->pabix", c2, d_kap)
    k = np.einsum("p,pabix,pabjy->ixjy", weights, d_eps, dn, optimize=True)
    k += np.einsum("p,pabix,pabjy->ixjy", weights, d_kap, dm, optimize=True)
    k += np.einsum("p,pab,pai,pbj,xy->ixjy", weights, n, first, first, np.eye(3), optimize=True)
    k += _moment_part(current, weights, m, h, first)
    size = patch.size * 3
    return force.ravel(), k.reshape(size, size), energy


def _moment_part(current: SurfaceFrame, weights: Array, m: Array, h: Array, first: Array) -> Array:
    """m : D[delta kappa]."""
    moment = np.einsum("pab,pabi->pi", m, h)
    mb = np.einsum("pab,pab->p", m, current.curvature)
    operands = weights, moment, first, current.dual, current.normal
    k = np.einsum("p,pi,pdj,pdx,py->ixjy", *operands, optimize=True)
    k = k + k.transpose(2, 3, 0, 1)
    k += np.einsum(
        "p,p,pcd,pci,pdj,px,py->ixjy",
        *(weights, mb, current.metric_con, first, first, current.normal, current.normal),
        optimize=True,
    )
    return k


def _values(patch: Patch, grid: QuadratureGrid, order: tuple[int, int]) -> Array:
    pairs = np.stack(np.meshgrid(grid.theta1, grid.theta2, indexing="ij"), axis=-1)
    return patch.functions(pairs.reshape(-1, 2), order)


def _point(
    points: object,
    reference: SurfaceFrame,
    strain: Array,
    activation: Array,
    z: float,
    tension: TensionLaw,
) -> tuple[Array, Array, Array]:
    """psi, S^ab and C^abcd from C = G + 2 E directly: each argument with its two derivatives.

    With X = C^-1 and j = det C/det G, from dj/dC = j X and dX_abcd = -(X_ac X_bd + X_ad X_bc)/2:
    dI1/dC = G^-1 - X/j, dI2/dC = G^-1/j + (j - t/j) X, dI4/dC = f0 (x) f0; and for laws in plane stress
    dt/dC = G^-1, d(j - t)/dC = j X - G^-1.
    """
    layer, material = points.layer, points.material
    law, p = law_of(type(material)), material.constants()
    g = reference.tangents + z * reference.normal_derivatives
    metric = np.einsum("pax,pbx->pab", g, g)
    con = np.linalg.inv(metric)
    c = metric + 2.0 * strain
    inverse = np.linalg.inv(c)
    j = np.linalg.det(c) / np.linalg.det(metric)
    angle = np.deg2rad(layer.fibre_angle)
    a1, a2 = reference.tangents[:, 0], reference.tangents[:, 1]
    a1 = a1 / np.linalg.norm(a1, axis=1)[:, None]
    square = a2 - np.einsum("px,px->p", a1, a2)[:, None] * a1  # Gram-Schmidt
    square /= np.linalg.norm(square, axis=1)[:, None]
    f = np.cos(angle) * a1 + np.sin(angle) * square
    up = np.einsum("pab,pbx,px->pa", con, g, f)
    ff = np.einsum("pa,pb->pab", up, up)
    t, i4 = np.einsum("pab,pab->p", con, c), np.einsum("pab,pab->p", ff, c)
    if isinstance(material, Incompressible):
        given = t + 1.0 / j - 3.0, t / j + j - 3.0, i4 - 1.0
    else:
        given = t - 2.0, j - t + 1.0, i4 - 1.0
    invariants = list(zip(*given, strict=True))
    pull, constants = functions_of(type(tension)).tension, tension.constants()
    both = [pull(a, np.sqrt(q), constants) for a, q in zip(activation, i4, strict=True)]
    sigma, slope = np.array(both).T
    psi = np.array([law.energy(*x, p) for x in invariants])
    gradient = np.array([law.gradient(*x, p) for x in invariants]).T
    h11, h12, h14, h22, h24, h44 = np.array([law.hessian(*x, p) for x in invariants]).T
    hessian = np.array([[h11, h12, h14], [h12, h22, h24], [h14, h24, h44]])

    j, t = j[:, None, None], t[:, None, None]
    if isinstance(material, Incompressible):
        first = np.stack((con - inverse / j, con / j + (j - t / j) * inverse, ff))
    else:
        first = np.stack((con, j * inverse - con, ff))
    j, t = j[..., None, None], t[..., None, None]
    swap = np.einsum("pac,pbd->pabcd", inverse, inverse)
    swap = 0.5 * (swap + np.einsum("pad,pbc->pabcd", inverse, inverse))
    square = np.einsum("pab,pcd->pabcd", inverse, inverse)
    mixed = np.einsum("pab,pcd->pabcd", con, inverse)
    mixed = mixed + mixed.transpose(0, 3, 4, 1, 2)
    if isinstance(material, Incompressible):
        second = (square + swap) / j, (j + t / j) * square - mixed / j + (t / j - j) * swap
    else:
        second = np.zeros_like(square), j * (square - swap)

    s = 2 * np.einsum("mp,mpab->pab", gradient, first) + (sigma / i4)[:, None, None] * ff
    tangent = 4 * np.einsum("mp,mpabcd->pabcd", gradient[:2], np.stack(second))
    tangent += 4 * np.einsum("mnp,mpab,npcd->pabcd", hessian, first, first)
    active = slope / i4**1.5 - 2 * sigma / i4**2  # 2 d(sigma/q)/dq, q = lambda_f^2
    tangent += np.einsum("p,pab,pcd->pabcd", active, ff, ff)
    return psi, s, tangent
