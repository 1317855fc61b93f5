"""Active stress that follows the potential at two rates (Nash and Panfilov, 2004).

References
----------
M. P. Nash, A. V. Panfilov, Electromechanical model of excitable tissue to study reentrant cardiac
arrhythmias, Progress in Biophysics and Molecular Biology 85 (2004) 501-522, eqs. 22-23.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.electrophysiology.tension_laws.base import LinearTensionLaw

SOURCE = "Nash and Panfilov (2004), eqs. 22-23"


class Constants(NamedTuple):
    """Stress in kPa, potentials in mV, rates in 1/ms."""

    k_t: float
    v_r: float
    scale: float
    threshold: float
    below: float
    above: float


class NashPanfilov(LinearTensionLaw):
    """d(sigma)/dt* = eps(u) (k_T u - sigma), with u = (v - v_r)/potential_range and t* = t/time_scale.

    eps is ``rate_below`` for u < ``threshold``, else ``rate_above``.
    """

    name: Literal["nash-panfilov"] = "nash-panfilov"
    k_t: float = quantity("kPa", "stress at u = 1, k_T", SOURCE, ge=0)
    threshold: float = quantity("", "u of the switch", SOURCE, gt=0, lt=1)
    rate_below: float = quantity(
        "", "rate eps_0 below the switch, in normalised time", SOURCE, ge=0
    )
    rate_above: float = quantity("", "rate above the switch, in normalised time", SOURCE, ge=0)
    time_scale: float = quantity("ms", "unit of normalised time", "Table 3, eq. 99", gt=0)
    potential_range: float = quantity("mV", "potential of u = 1 above rest", "Table 3", gt=0)
    v_r: float | None = quantity(
        "mV", "resting potential v_r; left out: that of the cells", "Table 3", default=None
    )

    def constants(self) -> Constants:
        """Parameters as the equation reads them."""
        return Constants(
            self.k_t,
            self.resting(),
            self.potential_range,
            self.threshold,
            self.rate_below / self.time_scale,
            self.rate_above / self.time_scale,
        )


def relaxation(v: float, p: Constants) -> tuple[float, float]:
    """Rate in 1/ms and target k_T u in kPa.

    Examples
    --------
    >>> p = Constants(47.9, -80.0, 100.0, 0.05, 0.1, 1.0)
    >>> relaxation(-80.0, p)
    (0.1, 0.0)
    >>> relaxation(20.0, p)
    (1.0, 47.9)
    """
    u = (v - p.v_r) / p.scale
    return (p.below if u < p.threshold else p.above), p.k_t * u


MODEL = NashPanfilov
