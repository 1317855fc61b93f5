"""Closed form of cylindrical bending: a wide film under uniform active stress along X.

Far from its edges a wide clamped film takes no curvature along Y (the edge regions alone could bend
that way, against the film's own stretching), but it is free to strain along Y, since nothing holds its
sides: the stretches lx, ly and the curvature k follow from N11 = M11 = N22 = 0. The stresses are written
here in physical components of a flat film, apart from the shell's code.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import fsolve

from stages.numerics.bsplines import Array


def cylindrical_bending(
    active_stress: float, substrate: float = 0.018, active: float = 0.004
) -> tuple[float, float, float]:
    """(lx, ly, k): stretches of the mid-surface along X and Y, and its curvature along X, 1/mm."""
    half = 0.5 * (substrate + active)
    x, w = np.polynomial.legendre.leggauss(6)

    def balance(unknown: Array) -> list[float]:
        lx, ly, b = unknown
        n1 = m1 = n2 = 0.0
        for low, high, muscle in (
            (-half, half - active, False),
            (half - active, half, True),
        ):
            z = 0.5 * (low + high) + 0.5 * (high - low) * x
            dz = 0.5 * (high - low) * w
            cx, cy = lx**2 - 2 * z * b, np.full_like(z, ly**2)  # C = 1 + 2 (eps + z kappa)
            mu = 0.767 if muscle else 500.0
            sx, sy = mu * (1 - 1 / (cx**2 * cy)), mu * (1 - 1 / (cx * cy**2))  # eq. 89
            if muscle:
                fibre = np.sqrt(cx)
                sx = sx + 21.0 / (5.5 * fibre) * np.expm1(5.5 * (fibre - 1))  # eq. 92
                sx = sx + active_stress / cx  # eq. 37
            n1, m1, n2 = n1 + dz @ sx, m1 + dz @ (z * sx), n2 + dz @ sy
        return [n1, m1 / half, n2]

    lx, ly, b = fsolve(balance, [1.0, 1.0, 0.04 * active_stress], xtol=1e-13)
    return float(lx), float(ly), float(b / lx**2)
