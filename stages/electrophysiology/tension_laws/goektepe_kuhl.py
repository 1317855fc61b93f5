"""Potential-driven active stress with a smooth switch (Göktepe and Kuhl, 2010)."""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.electrophysiology.tension_laws.base import LinearTensionLaw
from stages.numerics.elementary import exp


class Constants(NamedTuple):
    """Parameters in the order of Table 3."""

    k_sigma: float
    v_r: float
    zeta_0: float
    zeta_inf: float
    xi: float
    v_bar: float


class GoektepeKuhl(LinearTensionLaw):
    """Parameters of eqs. 97-98.

    Table 3 gives zeta_0 and zeta_inf in 1/mV; eq. 97 is in dimensional time, so they are rates, per ms.
    """

    name: Literal["goektepe-kuhl"] = "goektepe-kuhl"
    k_sigma: float = quantity("kPa/mV", "saturated stress per potential k_sigma", "Table 3", ge=0)
    v_r: float | None = quantity(
        "mV", "resting potential v_r; left out: that of the cells", "Table 3", default=None
    )
    zeta_0: float = quantity("1/ms", "rate below the switch zeta_0", "Table 3, eq. 98", ge=0)
    zeta_inf: float = quantity("1/ms", "rate above the switch zeta_inf", "Table 3, eq. 98", ge=0)
    xi: float = quantity("1/mV", "steepness of the switch xi_v", "Table 3, eq. 98", gt=0)
    v_bar: float = quantity("mV", "potential of the switch v_bar", "Table 3, eq. 98")

    def constants(self) -> Constants:
        """Parameters as the equation reads them."""
        return Constants(
            self.k_sigma, self.resting(), self.zeta_0, self.zeta_inf, self.xi, self.v_bar
        )


def relaxation(v: float, p: Constants) -> tuple[float, float]:
    """Rate zeta(v) in 1/ms, and the target k_sigma (v - v_r) in kPa (eqs. 97-98).

    zeta = zeta_0 + (zeta_inf - zeta_0) exp(-exp(-xi (v - v_bar))).

    Examples
    --------
    >>> p = Constants(0.122, -80.0, 0.1, 1.0, 1.0, 0.0)
    >>> rate, target = relaxation(20.0, p)
    >>> round(rate, 6), round(target, 6)  # zeta is 1 to 2e-9
    (1.0, 12.2)
    >>> relaxation(-80.0, p)  # at rest: towards no stress at rate zeta_0
    (0.1, 0.0)
    """
    zeta = p.zeta_0 + (p.zeta_inf - p.zeta_0) * exp(-exp(-p.xi * (v - p.v_bar)))
    return zeta, p.k_sigma * (v - p.v_r)


MODEL = GoektepeKuhl
