"""Supports: which displacement components are held, by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch

Fixed = NDArray[np.bool_]
"""Held degrees of freedom, shape ``(dof,)``."""


def fixed_degrees(patch: Patch, support: str) -> Fixed:
    """Degrees of freedom that a named support at the edge X = 0 holds at zero.

    Parameters
    ----------
    patch
        Mid-surface; the edge is its first row of control points.
    support
        ``"clamped"``: the first two rows of control points, in all components. This is common
        practice, and also holds u_x,X at the edge, an O(h) over-constraint. ``"clamped-normal"``: the
        first row, and of the second row the component along the normal only, which is all that a
        fixed rotation needs.

    Raises
    ------
    ValueError
        If the support is unknown, or ``clamped-normal`` is asked of an edge whose normal is not along
        a coordinate axis.

    Examples
    --------
    >>> film = Patch.rectangle(3.5, 2.0).refine(2, (4, 3))
    >>> int(fixed_degrees(film, "clamped").sum()), int(fixed_degrees(film, "clamped-normal").sum())
    (30, 20)
    """
    if support not in _SUPPORTS:
        raise ValueError(f"no support is called {support!r}; choose one of: {', '.join(_SUPPORTS)}")
    return _SUPPORTS[support](patch.control_points).ravel()


def _clamped(net: Array) -> NDArray[np.bool_]:
    fixed = np.zeros(net.shape, dtype=bool)
    fixed[:2] = True
    return fixed


def _clamped_normal(net: Array) -> NDArray[np.bool_]:
    """The normal along the edge comes from the first two rows, which span the edge's tangents."""
    along, across = np.gradient(net[0], axis=0), net[1] - net[0]
    normals = np.cross(across, along)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    axis = int(np.argmax(np.abs(normals[0])))
    if np.any(np.abs(normals[:, axis]) < 1.0 - 1e-12):
        raise ValueError(
            "the support 'clamped-normal' needs an edge whose normal lies along a coordinate axis; "
            "use 'clamped' on this film"
        )
    fixed = np.zeros(net.shape, dtype=bool)
    fixed[0] = True
    fixed[1, :, axis] = True
    return fixed


_SUPPORTS: dict[str, Callable[[Array], NDArray[np.bool_]]] = {
    "clamped": _clamped,
    "clamped-normal": _clamped_normal,
}
