"""Quadrature through the layers: reference metric and fibres at every depth (eqs. 18, 34-39)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np

from stages.artefacts import Laminate, Layer
from stages.mechanics.materials.base import Material
from stages.mechanics.shell.kinematics import Frames
from stages.numerics.bsplines import Array
from stages.numerics.fibres import turned_direction
from stages.numerics.quadrature import gauss
from stages.numerics.surface_geometry import SurfaceFrame


@dataclass(frozen=True)
class LayerPoints:
    """Quadrature points of one layer.

    Attributes
    ----------
    layer
        The layer, with its name.
    material
        Its material.
    depth, weights
        theta3 and weight of each point through the layer, mm, shape ``(depth,)``.
    reference
        G^11 G^22 G^12, 1/det G_ab, f0^a f0^b (11, 22, 12): the fields of
        :class:`~stages.mechanics.shell.material_point.PlaneReference`, shape ``(point, depth, 7)``.
    thin
        Whether the metric is that of the mid-surface at every depth.
    """

    layer: Layer
    material: Material
    depth: Array
    weights: Array
    reference: Array
    thin: bool = False


def points_through(
    laminate: Laminate,
    materials: Mapping[str, Material],
    reference: Frames,
    points: int,
    *,
    thin: bool = False,
) -> tuple[LayerPoints, ...]:
    """Gauss points of every layer, bottom to top, over the undeformed mid-surface.

    Parameters
    ----------
    laminate
        Layers from theta3 = -d/2 to d/2.
    materials
        Materials by the names that the layers give.
    reference
        Frames of the undeformed mid-surface.
    points
        Gauss points through each layer.
    thin
        Take the metric of the mid-surface at every depth, as classical thin-shell theory does, with
        bending stiffness E t^3/12. It differs by (thickness times curvature)^2, relatively.

    Raises
    ------
    ValueError
        If a layer has no material or no thickness.
    """
    if not laminate.layers:
        raise ValueError("the laminate has no layers: give at least one")
    faces = np.cumsum([0.0, *(layer.thickness for layer in laminate.layers)])
    faces -= 0.5 * laminate.thickness
    layers = []
    for layer, bottom, top in zip(laminate.layers, faces[:-1], faces[1:], strict=True):
        if layer.thickness <= 0:
            raise ValueError(f"layer {layer.name!r} has thickness {layer.thickness:g} mm: not > 0")
        if layer.material not in materials:
            near = get_close_matches(layer.material, materials, n=1, cutoff=0.3)
            raise ValueError(
                f"layer {layer.name!r} is of material {layer.material!r}, which is not defined"
                f"{f' (did you mean {near[0]!r}?)' if near else ''}; there are: "
                f"{', '.join(sorted(materials)) or 'none'}"
            )
        depth, weights = gauss(points, bottom, top)
        fibre = fibre_direction(layer, reference)
        table = np.stack(
            [reference_at_depth(reference, fibre, 0.0 if thin else z) for z in depth], axis=1
        )
        layers.append(LayerPoints(layer, materials[layer.material], depth, weights, table, thin))
    return tuple(layers)


def fibre_direction(layer: Layer, reference: Frames | SurfaceFrame) -> Array:
    """f0: unit tangents at ``fibre_angle`` from the direction in which X runs along the film.

    The tissue conducts along the same ones (:mod:`stages.numerics.fibres`).
    """
    return turned_direction(reference.tangents, reference.normal, layer.fibre_angle)


def surface_density(layers: tuple[LayerPoints, ...]) -> float:
    """rho = sum rho_k d_k, mg/mm^2 (eq. 104)."""
    return float(sum(points.material.density * points.layer.thickness for points in layers))


def reference_at_depth(reference: Frames, fibre: Array, depth: float) -> Array:
    """PlaneReference at theta3 = ``depth``: g_a = a_a + theta3 a_3,a with a_3,a = -b_ac a^c."""
    b11, b22, b12 = reference.curvature.T
    b = np.stack((np.stack((b11, b12), -1), np.stack((b12, b22), -1)), 1)
    g = reference.tangents - depth * np.einsum("pac,pcx->pax", b, reference.dual)
    g11, g22, g12 = (np.einsum("px,px->p", g[:, i], g[:, j]) for i, j in ((0, 0), (1, 1), (0, 1)))
    inverse = 1.0 / (g11 * g22 - g12 * g12)
    con11, con22, con12 = g22 * inverse, g11 * inverse, -g12 * inverse
    f1, f2 = (np.einsum("px,px->p", fibre, g[:, a]) for a in range(2))
    up1, up2 = con11 * f1 + con12 * f2, con12 * f1 + con22 * f2
    return np.stack((con11, con22, con12, inverse, up1 * up1, up2 * up2, up1 * up2), axis=1)
