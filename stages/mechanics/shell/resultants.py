"""Membrane forces, bending moments and their tangents, layer by layer (eqs. 27, 34-35, 49-50)."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from stages.mechanics.shell.kinematics import Frames, strains_at
from stages.mechanics.shell.laminate import LayerPoints
from stages.mechanics.shell.material_point import compile_point, constants_of
from stages.mechanics.tension_laws.base import TensionLaw
from stages.numerics.bsplines import Array
from stages.numerics.compiled import kernel


class Resultants(NamedTuple):
    """Stress resultants at the quadrature points; stress pairs run 11, 22, 12.

    Attributes
    ----------
    force
        n^ab, kPa mm, shape ``(point, 3)``.
    moment
        m^ab, kPa mm^2, shape ``(point, 3)``.
    stiffness
        Integrals of C, theta3 C and theta3^2 C, shape ``(point, 3, 6)``; the six entries of each are
        1111, 1122, 1112, 2222, 2212, 1212.
    energy
        Passive strain energy per area, kPa mm, shape ``(point,)``.
    """

    force: Array
    moment: Array
    stiffness: Array
    energy: Array

    @classmethod
    def zeros(cls, points: int) -> Resultants:
        """Resultants of no layer at all, to add layers to."""
        shapes = ((3,), (3,), (3, 6), ())
        return cls(*(np.zeros((points, *shape)) for shape in shapes))


def compile_layer(points: LayerPoints, tension: TensionLaw) -> Callable[..., None]:
    """``add(reference, current, activation, resultants)``: adds one layer to ``resultants``.

    Parameters
    ----------
    points
        The layer's quadrature points and material.
    tension
        Tension law; the activation is given per in-plane quadrature point, shape ``(point,)``.
    """
    add = _layer_kernel(compile_point(points.material, tension))
    arrays = points.depth, points.weights, points.reference
    constants = constants_of(points.material, tension)

    def add_layer(
        reference: Frames, current: Frames, activation: Array, resultants: Resultants
    ) -> None:
        add(*arrays, constants, reference, current, activation, resultants)

    return add_layer


@functools.cache
def _layer_kernel(respond: Callable[..., Any]) -> Callable[..., None]:
    @kernel
    def add(
        depth: Any,
        weights: Any,
        table: Any,
        constants: Any,
        reference: Any,
        current: Any,
        activation: Any,
        resultants: Any,
    ) -> None:
        for p in range(activation.size):
            eps11, eps22, eps12, kap11, kap22, kap12 = strains_at(reference, current, p)
            for k in range(depth.size):
                z, w = depth[k], weights[k]
                ref = table[p, k]
                point = respond(
                    eps11 + z * kap11,
                    eps22 + z * kap22,
                    eps12 + z * kap12,
                    (ref[0], ref[1], ref[2], ref[3], ref[4], ref[5], ref[6]),
                    activation[p],
                    constants,
                )
                resultants.energy[p] += w * point.energy
                stress = (point.s11, point.s22, point.s12)
                tangent = (
                    point.c1111,
                    point.c1122,
                    point.c1112,
                    point.c2222,
                    point.c2212,
                    point.c1212,
                )
                for i in range(3):
                    resultants.force[p, i] += w * stress[i]
                    resultants.moment[p, i] += w * z * stress[i]
                for i in range(6):
                    resultants.stiffness[p, 0, i] += w * tangent[i]
                    resultants.stiffness[p, 1, i] += w * z * tangent[i]
                    resultants.stiffness[p, 2, i] += w * z * z * tangent[i]

    return add
