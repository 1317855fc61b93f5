"""Fibres that lie in a surface at an angle from its first coordinate line, with exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.surface_geometry import SurfaceFrame


@dataclass(frozen=True)
class FibreField:
    """Unit tangent vectors f at points of a surface.

    Attributes
    ----------
    direction
        f, shape ``(point, 3)``.
    derivatives
        f_,a, shape ``(point, 2, 3)``, per unit of the parameters.
    """

    direction: Array
    derivatives: Array


def turned_direction(tangents: Array, normal: Array, angle: float | Array) -> Array:
    """f = cos(angle) e_1 + sin(angle) e_2, with e_1 = a_1/|a_1| and e_2 = a_3 x e_1.

    The angle is measured in the surface, from the line along which theta^1 grows (on a film: X) towards
    theta^2 (Y); it is the angle from X wherever a film is flat. Nothing is said about a_2, which need not
    be orthogonal to a_1.

    Parameters
    ----------
    tangents, normal
        a_1 and a_2, shape ``(point, 2, 3)``, and a_3, shape ``(point, 3)``.
    angle
        In degrees; one number, or one for each point.

    Returns
    -------
    Array
        Unit vectors, shape ``(point, 3)``.
    """
    first = tangents[:, 0] / np.linalg.norm(tangents[:, 0], axis=1)[:, None]
    across = np.cross(normal, first)
    radians = np.deg2rad(np.asarray(angle, dtype=float))[..., None]
    return np.asarray(np.cos(radians) * first + np.sin(radians) * across)


def fibre_field(
    frame: SurfaceFrame, angle: float | Array, slopes: Array | None = None
) -> FibreField:
    """The same directions with their derivatives, exact from r_,a and r_,ab.

    Parameters
    ----------
    frame
        Surface frame at the points.
    angle
        Degrees from a_1 about the normal; one number, or one for each point.
    slopes
        Derivatives of the angle by the parameters, degrees, shape ``(point, 2)``; none: it is constant.
    """
    tangent = frame.tangents[:, 0]
    length = np.linalg.norm(tangent, axis=1)[:, None]
    first = tangent / length
    across = np.cross(frame.normal, first)
    growth = frame.second[:, 0]  # r_,1a
    along = np.einsum("px,pax->pa", first, growth)
    first_by = (growth - along[..., None] * first[:, None]) / length[:, None]
    across_by = np.cross(frame.normal_derivatives, first[:, None]) + np.cross(
        frame.normal[:, None], first_by
    )
    radians = np.deg2rad(np.asarray(angle, dtype=float))[..., None]
    cos, sin = np.cos(radians), np.sin(radians)
    direction = cos * first + sin * across
    derivatives = cos[..., None] * first_by + sin[..., None] * across_by
    if slopes is not None:
        turned = cos * across - sin * first
        derivatives = derivatives + np.deg2rad(slopes)[..., None] * turned[:, None]
    return FibreField(np.asarray(direction), np.asarray(derivatives))
