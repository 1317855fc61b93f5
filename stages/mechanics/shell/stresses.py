"""Stress, strain and thickness at any point and depth of a deformed shell (eqs. 22, 34-39, 95).

For studies and reports: the laws are evaluated as plain Python, some 10^4 points a second, without waiting
for a compiler. Metrics at depth are those of the shell's kinematics: C_ab = G_ab + 2 (eps + theta3 kappa).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from stages.mechanics.shell.laminate import LayerPoints, fibre_direction
from stages.mechanics.shell.material_point import PlaneReference, constants_of, plain_point
from stages.mechanics.shell.plane_stress import thickness_stretch
from stages.mechanics.shell.shell import PRESCRIBED, Shell
from stages.mechanics.tension_laws.base import functions_of
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import SurfaceFrame, frame_on_grid


@dataclass(frozen=True)
class StressState:
    """State of a shell at one depth of a layer; points first, pairs run 11, 22, 12.

    Attributes
    ----------
    strain
        Green-Lagrange E_ab in the coordinates theta, mm^2, shape ``(point, 3)``.
    second_piola
        S^ab in the coordinates theta, passive and active, kPa/mm^2, shape ``(point, 3)``.
    cauchy
        Cauchy stress along the chosen direction, across it in the film, and shear, kPa, ``(point, 3)``.
    directions
        These two directions on the deformed mid-surface, unit vectors, shape ``(point, 2, 3)``.
    fibre_stretch
        lambda_f, shape ``(point,)``.
    active_stress
        sigma_a, kPa, shape ``(point,)``.
    thickness_stretch
        lambda_3, shape ``(point,)``.
    """

    strain: Array
    second_piola: Array
    cauchy: Array
    directions: Array
    fibre_stretch: Array
    active_stress: Array
    thickness_stretch: Array


def stress_state(
    shell: Shell,
    displacement: Array,
    theta1: Array,
    theta2: Array,
    *,
    layer: str,
    level: float = 0.5,
    activation: Array | float = 0.0,
    angle: float | None = None,
) -> StressState:
    """State at a tensor grid of parameters, in one layer.

    Parameters
    ----------
    shell, displacement
        The shell, and its control displacements, mm, shape ``(dof,)``.
    theta1, theta2
        Parameters; points are numbered with direction 2 fastest.
    layer, level
        Name of the layer, and where in it: 0 at its bottom, 1 at its top.
    activation
        What the tension law turns into sigma_a, kPa; a number, or shape ``(point,)``.
    angle
        Material direction of ``cauchy``, degrees from X; none: along the fibres.

    Raises
    ------
    ValueError
        If there is no such layer, or the level lies outside it.
    """
    points = _layer(shell, layer)
    law = shell.tension if points.layer.active else PRESCRIBED
    here = _place(shell, displacement, theta1, theta2, points, _depth(points, level))
    count = len(here.strain)
    pull = points.layer.activity * np.broadcast_to(np.asarray(activation, dtype=float), count)
    respond, constants = plain_point(points.material, law), constants_of(points.material, law)
    stress = np.array(
        [
            respond(*strain, PlaneReference(*table), active, constants)[1:4]
            for strain, table, active in zip(
                here.strain.tolist(), here.table.tolist(), pull.tolist(), strict=True
            )
        ]
    )
    stretch = np.sqrt(1.0 + here.fibre)
    tension, p = functions_of(type(law)).tension, law.constants()
    thickness = _thickness_stretch(points, here)
    chosen = points.layer if angle is None else replace(points.layer, fibre_angle=angle)
    up = here.components(fibre_direction(chosen, here.reference))
    volume = np.sqrt(1.0 + here.trace + here.det) * thickness
    cauchy, along = _in_frame(stress / volume[:, None], here, up)
    first = np.einsum("pa,pax->px", along, here.current.tangents)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return StressState(
        strain=here.strain,
        second_piola=stress,
        cauchy=cauchy,
        directions=np.stack((first, np.cross(here.current.normal, first)), axis=1),
        fibre_stretch=stretch,
        active_stress=np.array([tension(a, s, p)[0] for a, s in zip(pull, stretch, strict=True)]),
        thickness_stretch=thickness,
    )


def deformed_thickness(shell: Shell, displacement: Array, theta1: Array, theta2: Array) -> Array:
    """Thickness of the deformed film, the integral of lambda_3, mm, shape ``(point,)``."""
    total = np.zeros(np.size(theta1) * np.size(theta2))
    for points in shell.layers:
        for depth, weight in zip(points.depth, points.weights, strict=True):
            here = _place(shell, displacement, theta1, theta2, points, depth)
            total += weight * _thickness_stretch(points, here)
    return total


class _Place(NamedTuple):
    """Geometry at points of one depth: frames of the mid-surface, base vectors, metric, strain."""

    reference: SurfaceFrame
    current: SurfaceFrame
    base: Array
    con: Array
    strain: Array
    table: Array
    trace: Array
    det: Array
    fibre: Array

    def components(self, direction: Array) -> Array:
        """Contravariant components of a vector in the undeformed film, shape ``(point, 2)``."""
        return np.einsum("pab,pbx,px->pa", self.con, self.base, direction)


def _place(
    shell: Shell,
    displacement: Array,
    theta1: Array,
    theta2: Array,
    points: LayerPoints,
    depth: float,
) -> _Place:
    patch = shell.patch
    net = patch.control_points + displacement.reshape(patch.control_points.shape)
    reference = frame_on_grid(patch, theta1, theta2)
    moved = Patch(patch.first, patch.second, net, patch.weights)
    current = frame_on_grid(moved, theta1, theta2)
    pairs = (0, 1, 0), (0, 1, 1)
    membrane = 0.5 * (current.metric_cov - reference.metric_cov)
    bending = reference.curvature - current.curvature
    strain = (membrane + depth * bending)[:, *pairs]
    base = reference.tangents + (0.0 if points.thin else depth) * reference.normal_derivatives
    con = np.linalg.inv(np.einsum("pax,pbx->pab", base, base))
    inverse_det = np.linalg.det(con)
    up = np.einsum("pab,pbx,px->pa", con, base, fibre_direction(points.layer, reference))
    fibres = np.einsum("pa,pb->pab", up, up)[:, *pairs]
    twice = 2.0 * strain * [1.0, 1.0, 2.0]  # 12 and 21
    return _Place(
        reference,
        current,
        base,
        con,
        strain,
        np.column_stack((con[:, *pairs], inverse_det, fibres)),
        np.einsum("ps,ps->p", con[:, *pairs], twice),
        4.0 * inverse_det * (strain[:, 0] * strain[:, 1] - strain[:, 2] ** 2),
        np.einsum("ps,ps->p", fibres, twice),
    )


def _in_frame(stress: Array, here: _Place, up: Array) -> tuple[Array, Array]:
    """Components along and across a convected direction; and its unit vector e^a in C_ab."""
    e11, e22, e12 = here.strain.T
    metric = np.linalg.inv(here.con)
    c = metric + 2.0 * np.stack((np.stack((e11, e12), -1), np.stack((e12, e22), -1)), -1)
    along = up / np.sqrt(np.einsum("pa,pab,pb->p", up, c, up))[:, None]
    first = np.einsum("pab,pb->pa", c, along)
    area = np.sqrt(np.linalg.det(c))
    second = np.stack((-area * along[:, 1], area * along[:, 0]), axis=-1)
    s11, s22, s12 = stress.T
    tensor = np.stack((np.stack((s11, s12), -1), np.stack((s12, s22), -1)), -1)
    axes = np.stack((first, second), axis=1)
    turned = np.einsum("pia,pab,pjb->pij", axes, tensor, axes)
    return turned[:, (0, 1, 0), (0, 1, 1)], along


def _thickness_stretch(points: LayerPoints, here: _Place) -> Array:
    invariants = zip(here.trace.tolist(), here.det.tolist(), here.fibre.tolist(), strict=True)
    return np.array([thickness_stretch(points.material, *three) for three in invariants])


def _layer(shell: Shell, name: str) -> LayerPoints:
    for points in shell.layers:
        if points.layer.name == name:
            return points
    names = ", ".join(repr(points.layer.name) for points in shell.layers)
    raise ValueError(f"the film has no layer {name!r}; from bottom to top there are {names}")


def _depth(points: LayerPoints, level: float) -> float:
    """theta3 of a level between the bottom (0) and the top (1) of a layer."""
    if not 0.0 <= level <= 1.0:
        raise ValueError(f"level {level:g} lies outside the layer: 0 is its bottom, 1 its top")
    middle = float(points.depth @ points.weights) / points.layer.thickness
    return middle + (level - 0.5) * points.layer.thickness
