"""Material points of the film, by their lengths along the undeformed one."""

from __future__ import annotations

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.film_lengths import FilmLengths
from stages.numerics.patches import Patch

NEGLIGIBLE = 1e-12
"""Value of a basis function that the search for the point leaves by round-off."""


def functions_over(patch: Patch, position: tuple[float, float]) -> Array:
    """Basis functions at the point (X, Y) of the film, lengths along it, shape ``(control point,)``.

    Raises
    ------
    ValueError
        If (X, Y) lies outside the film.
    """
    (theta,) = FilmLengths(patch).parameters(np.array([position]))
    return functions_at(patch, (float(theta[0]), float(theta[1])))


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
