"""Local error of a generalized-alpha step, and steps of changing length that keep second order.

The balance of a step holds at t_alpha, so that the acceleration in it, A = alpha_m a_{i+1} + (1 - alpha_m)
a_i, is second-order accurate there. The a_i that the method carries along is not the acceleration at
t_i: it belongs to t_i + (alpha_f - alpha_m) dt. Two things follow.

Error. Two successive A give a linear acceleration over the step. Its integral u* is accurate to dt^4
(with u_i, v_i taken as exact) and u_{i+1} - u* is the local error of the displacement; where a_i has
settled it is

    (beta + (alpha_f - alpha_m)/2 - 1/6) dt^3 u''' = (1/12 + (alpha_f - alpha_m)^2/4) dt^3 u'''.

The coefficient beta - 1/6 of Zienkiewicz and Xie (1991), which is right for Newmark's method, is right
here for rho_inf = 1 alone, and a_{i+1} - a_i would not notice an a_i that has not settled.

Change of length. The time to which a_i belongs moves with dt, and so must a_i; else every change costs
an error of order dt^2 in the velocity (Bruels and Arnold, 2008, meet the same).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.time_stepping import GeneralizedAlpha, Motion


@dataclass(frozen=True)
class Balance:
    """Acceleration in the balance of the last step.

    Attributes
    ----------
    acceleration
        A, at t_alpha of that step; at the start the acceleration a(0).
    slope
        Its rate of change, from this balance and the one before it; zero at the start.
    length
        Length of that step; zero at the start.
    """

    acceleration: Array
    slope: Array
    length: float

    @classmethod
    def start(cls, motion: Motion) -> Balance:
        """Before the first step."""
        return cls(motion.acceleration, np.zeros_like(motion.acceleration), 0.0)

    def after(self, scheme: GeneralizedAlpha, old: Motion, new: Motion, length: float) -> Balance:
        """Balance of the step from ``old`` to ``new``."""
        acceleration = scheme.at_alpha(old, new).acceleration
        between = (1.0 - scheme.alpha_f) * self.length + scheme.alpha_f * length
        return Balance(acceleration, (acceleration - self.acceleration) / between, length)

    def shifted(self, scheme: GeneralizedAlpha, motion: Motion, length: float) -> Motion:
        """State from which a step of another length starts: a_i moved to the time it belongs to."""
        if length == self.length or self.length == 0.0:
            return motion
        move = (scheme.alpha_f - scheme.alpha_m) * (length - self.length)
        return replace(motion, acceleration=motion.acceleration + move * self.slope)


def local_error(scheme: GeneralizedAlpha, old: Motion, new: Motion, balance: Balance) -> Array:
    """u_{i+1} - u*, the error that one step adds to the displacement.

    Parameters
    ----------
    scheme
        The method.
    old, new
        States at both ends of the step; ``old`` as it went into the step.
    balance
        Balance of this step, with the slope since the one before it.

    Returns
    -------
    Array
        Error with its sign, as the displacement; of order dt^3 for every spectral radius.

    Examples
    --------
    u = t^3 with rho_inf = 1: dt^3 u'''/12 = 0.1^3/2.

    >>> scheme, dt = GeneralizedAlpha.damping_to(1.0), 0.1
    >>> old = Motion(np.array([1.0]), np.array([3.0]), np.array([6.0]))
    >>> new = Motion(np.array([1.3315]), np.array([3.63]), np.array([6.6]))
    >>> balance = Balance(np.array([5.7]), np.array([6.0]), dt).after(scheme, old, new, dt)
    >>> local_error(scheme, old, new, balance).round(9).tolist()
    [0.0005]
    """
    a, slope, dt = balance.acceleration, balance.slope, balance.length
    beta = scheme.beta
    newmark = (0.5 - beta) * old.acceleration + beta * new.acceleration
    linear = 0.5 * a + (1.0 / 6.0 - 0.5 * scheme.alpha_f) * dt * slope
    return dt**2 * (newmark - linear)
