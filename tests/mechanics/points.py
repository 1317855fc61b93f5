"""Material points for the tests: reference metrics, random strains, stresses as Cartesian tensors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from hypothesis import strategies as st

from stages.mechanics.materials.base import Material
from stages.mechanics.shell.material_point import PlaneReference, constants_of, plain_point
from stages.mechanics.tension_laws.base import TensionLaw
from stages.mechanics.tension_laws.prescribed import Prescribed
from stages.numerics.bsplines import Array

PRESCRIBED = Prescribed()
UNIT = PlaneReference(1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0)
"""Cartesian axes, fibres along the first."""

HALF_SHEAR = np.array([1.0, 1.0, 0.5])
"""S^12 belongs to E_12 + E_21: a difference by E_12 alone sees it twice."""


class Point(NamedTuple):
    """Covariant base vectors (rows, in Cartesian axes), fibre direction and strain, both Cartesian."""

    base: Array
    fibre: Array
    strain: Array

    @property
    def covariant(self) -> Array:
        """E_11, E_22, E_12 in the coordinates of the base."""
        e = self.base @ self.strain @ self.base.T
        return np.array([e[0, 0], e[1, 1], e[0, 1]])

    @property
    def reference(self) -> PlaneReference:
        """Metric and fibres in the coordinates of the base."""
        metric = self.base @ self.base.T
        con = np.linalg.inv(metric)
        f = con @ (self.base @ self.fibre)
        return PlaneReference(
            *(con[0, 0], con[1, 1], con[0, 1], 1.0 / np.linalg.det(metric)),
            *(f[0] ** 2, f[1] ** 2, f[0] * f[1]),
        )

    @property
    def stretch(self) -> float:
        """lambda_f."""
        return float(np.sqrt(1.0 + 2.0 * self.fibre @ self.strain @ self.fibre))


@st.composite
def points(draw: st.DrawFn, size: float = 0.2) -> Point:
    """Skew coordinates, any fibre angle, principal strains up to ``size``."""
    number = st.floats(-1.0, 1.0)
    base = np.diag([draw(st.floats(0.5, 3.0)), draw(st.floats(0.5, 3.0))])
    base[0, 1], base[1, 0] = 0.3 * draw(number), 0.3 * draw(number)
    angle, turn = draw(st.floats(0.0, np.pi)), draw(st.floats(0.0, np.pi))
    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    strain = axes.T @ np.diag([size * draw(number), size * draw(number)]) @ axes
    return Point(base, np.array([np.cos(angle), np.sin(angle)]), strain)


def at(
    material: Material, tension: TensionLaw = PRESCRIBED, activation: float = 0.0
) -> Callable[[Any, PlaneReference], Array]:
    """``(E_11 E_22 E_12, reference) -> [energy, S^11, S^22, S^12, C^1111, C^1122, ...]``."""
    respond, constants = plain_point(material, tension), constants_of(material, tension)

    def evaluate(strain: Any, reference: PlaneReference = UNIT) -> Array:
        e = (float(value) for value in strain)
        return np.array(respond(*e, reference, activation, constants))

    return evaluate


def tangent(response: Array) -> Array:
    """C as a symmetric matrix over 11, 22, 12."""
    c1111, c1122, c1112, c2222, c2212, c1212 = response[4:]
    return np.array([[c1111, c1122, c1112], [c1122, c2222, c2212], [c1112, c2212, c1212]])


def differences(evaluate: Callable[[Array], Array], strain: Array, step: float = 1e-5) -> Array:
    """Derivatives of the whole response by E_11, E_22, E_12, fourth order; shape (3, response)."""
    rows = []
    for unit in np.eye(3) * step:
        near = evaluate(strain + unit) - evaluate(strain - unit)
        far = evaluate(strain + 2 * unit) - evaluate(strain - 2 * unit)
        rows.append((8.0 * near - far) / (12.0 * step))
    return np.array(rows) * HALF_SHEAR[:, None]
