"""Active stress along the fibres and its stretch derivative (eqs. 37-39, 51).

S_a = sigma_a/lambda_f^2 f0 (x) f0. A tension law ``tension(activation, stretch) -> (sigma_a,
d sigma_a/d lambda_f)`` turns the activation handed to the shell into a stress at the actual fibre
stretch of each quadrature point; its derivative enters the tangent, which stays symmetric.
"""

from __future__ import annotations


def prescribed(activation: float, stretch: float) -> tuple[float, float]:
    """Tension law of the coupled approach: the activation is sigma_a itself, at any stretch.

    Examples
    --------
    >>> prescribed(12.2, 0.95)
    (12.2, 0.0)
    """
    return activation, 0.0
