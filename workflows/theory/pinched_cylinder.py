"""A cylinder on rigid diaphragms under two opposite point forces: its double Fourier series.

Classical thin shell, small displacements, with the strains of the shell solver: with x along the axis,
theta around it, and displacements u, v, w along x, theta and outwards,

    eps_x = u_x,   eps_t = (v_t + w)/R,   gamma = u_t/R + v_x,
    kappa_x = -w_xx,   kappa_t = -(w_tt - 2 v_t - w)/R^2,   kappa_xt = -(w_xt - v_x)/R,

energy per area (C m + D b)/2 with C = E t/(1 - nu^2), D = E t^3/(12 (1 - nu^2)), where m is
eps_x^2 + eps_t^2 + 2 nu eps_x eps_t + (1 - nu)/2 gamma^2 and b is the same of kappa, with
2 (1 - nu) kappa_xt^2. The diaphragms leave u cos(a x) cos(n theta), v sin(a x) sin(n theta) and
w sin(a x) cos(n theta) with a = m pi/L: three equations for each pair (m, n).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class PinchedCylinder:
    """Cylinder of any consistent units; ``force`` is each of the two forces at half the length."""

    radius: float
    length: float
    thickness: float
    modulus: float
    poisson_ratio: float
    force: float

    def partial_sum(self, waves: int) -> float:
        """Displacement under a force from all waves with m, n < ``waves``.

        By symmetry m is odd and n is even.
        """
        radius, nu = self.radius, self.poisson_ratio
        m, n = np.arange(1, waves, 2)[:, None], np.arange(0, waves, 2)[None, :]
        a, b = np.broadcast_arrays(m * np.pi / self.length, n / radius)
        zero = np.zeros_like(a)
        eps_x, eps_t, gamma = (-a, zero, zero), (zero, b, zero + 1 / radius), (-b, a, zero)
        kappa_x = zero, zero, a**2
        kappa_t = zero, 2 * b / radius, b**2 + 1 / radius**2
        kappa_xt = zero, a / radius, a * b
        membrane = self.modulus * self.thickness / (1 - nu**2)
        bending = membrane * self.thickness**2 / 12
        matrix = membrane * (_plane(eps_x, eps_t, nu) + 0.5 * (1 - nu) * _square(gamma))
        matrix += bending * (_plane(kappa_x, kappa_t, nu) + 2 * (1 - nu) * _square(kappa_xt))
        matrix[:, 0, 1, 1] += membrane / radius**2  # n = 0 has no v
        # integrals of sin^2(a x) over the length and of cos^2(n theta) around, times pi R L/2
        measure = np.where(n == 0, 2.0, 1.0) * 0.5 * np.pi * radius * self.length
        peaks = np.sin(0.5 * np.pi * m)
        load = np.zeros((*a.shape, 3, 1))
        load[:, :, 2, 0] = 2 * self.force * peaks / measure
        return float((np.linalg.solve(matrix, load)[:, :, 2, 0] * peaks).sum())

    def displacement(self, waves: int = 640) -> float:
        """Displacement under a force: the sum extrapolated, as its rest falls like 1/waves^2.

        Examples
        --------
        >>> case = PinchedCylinder(300.0, 600.0, 3.0, 3.0e6, 0.3, 1.0)
        >>> f"{case.displacement(320):.4e} {case.displacement(640):.4e}"
        '1.8282e-05 1.8282e-05'
        """
        return (4 * self.partial_sum(2 * waves) - self.partial_sum(waves)) / 3


def _outer(x: tuple[np.ndarray, ...], y: tuple[np.ndarray, ...]) -> np.ndarray:
    return np.einsum("imn,jmn->mnij", np.array(x), np.array(y))


def _square(x: tuple[np.ndarray, ...]) -> np.ndarray:
    return _outer(x, x)


def _plane(x: tuple[np.ndarray, ...], y: tuple[np.ndarray, ...], nu: float) -> np.ndarray:
    mixed = _outer(x, y)
    return _square(x) + _square(y) + nu * (mixed + mixed.swapaxes(2, 3))
