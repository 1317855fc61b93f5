"""Material points of the film, by where they lie in the undeformed one."""

from __future__ import annotations

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import locate

NEGLIGIBLE = 1e-12
"""Value of a basis function that the search for the point leaves by round-off."""


def functions_over(patch: Patch, position: tuple[float, float]) -> Array:
    """Basis functions at the point of the undeformed film over (X, Y), shape ``(control point,)``.

    Raises
    ------
    ValueError
        If (X, Y) lies outside the film.
    """
    shadow = patch.with_net(patch.control_points * np.array([1.0, 1.0, 0.0]))
    return functions_at(patch, tuple(locate(shadow, np.array([[*position, 0.0]]))[0]))


def functions_at(patch: Patch, parameters: tuple[float, float]) -> Array:
    """Basis functions at (theta1, theta2), shape ``(control point,)``.

    Raises
    ------
    ValueError
        If the parameters lie outside the patch.
    """
    for theta, space in zip(parameters, patch.spaces, strict=True):
        if not space.knots[0] <= theta <= space.knots[-1]:
            raise ValueError(
                f"the parameter {theta:g} lies outside the patch, which runs from "
                f"{space.knots[0]:g} to {space.knots[-1]:g}"
            )
    functions = np.asarray(patch.functions(np.array([parameters]))[0])
    functions[np.abs(functions) < NEGLIGIBLE] = 0.0
    return functions / functions.sum()
