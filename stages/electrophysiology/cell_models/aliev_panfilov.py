"""Aliev-Panfilov two-variable cell model in the normalised form of Göktepe and Kuhl (2010)."""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.electrophysiology.cell_models.base import CellModel


class Constants(NamedTuple):
    """Parameters in the order of Table 3; times in ms, potentials in mV."""

    k_v: float
    a: float
    b: float
    mu_1: float
    mu_2: float
    e_0: float
    r_v: float
    s_v: float
    r_t: float


class AlievPanfilov(CellModel):
    """Parameters of eqs. 99-100.

    The current, as printed in eq. 100, lost the factor (v* - 1) and the sign of v* w; here
    I* = k_v v* (v* - a)(v* - 1) + v* w (Aliev and Panfilov, 1996), with v* = (v - s_v)/r_v and
    t* = t/r_t.
    """

    name: Literal["aliev-panfilov"] = "aliev-panfilov"
    k_v: float = quantity("", "excitation rate k_v", "Table 3", gt=0)
    a: float = quantity("", "excitation threshold a", "Table 3", gt=0, lt=1)
    b: float = quantity("", "recovery shape b", "Table 3", ge=0)
    mu_1: float = quantity("", "restitution parameter mu_v1", "Table 3", ge=0)
    mu_2: float = quantity("", "restitution parameter mu_v2", "Table 3", gt=0)
    e_0: float = quantity("", "recovery rate e_0", "Table 3", ge=0)
    potential_range: float = quantity("mV", "potential scale r_v", "Table 3, eq. 99", gt=0)
    potential_rest: float = quantity("mV", "potential shift s_v", "Table 3, eq. 99")
    time_scale: float = quantity("ms", "time scale r_t", "Table 3, eq. 99", gt=0)
    initial_recovery: float = quantity("", "recovery variable at the start w_0", "Table 3")

    def constants(self) -> Constants:
        """Parameters as the equations read them."""
        return Constants(
            self.k_v,
            self.a,
            self.b,
            self.mu_1,
            self.mu_2,
            self.e_0,
            self.potential_range,
            self.potential_rest,
            self.time_scale,
        )

    def initial_states(self) -> tuple[float]:
        """The recovery variable w."""
        return (self.initial_recovery,)

    def rest_potential(self) -> float:
        """v* = 0, mV."""
        return self.potential_rest


def ionic_current(v: float, s: tuple[float], p: Constants) -> float:
    """I_ion / C_m = r_v/r_t (k_v v* (v* - a)(v* - 1) + v* w), mV/ms (eqs. 99-100).

    Examples
    --------
    >>> p = Constants(8.0, 0.15, 0.15, 0.2, 0.3, 0.002, 100.0, -80.0, 12.9)
    >>> ionic_current(-80.0, (0.0,), p)  # rest
    0.0
    >>> round(ionic_current(-30.0, (0.0,), p) * 12.9 / 100.0, 12)  # 8 * 0.5 * 0.35 * -0.5
    -0.7
    """
    (w,) = s
    x = (v - p.s_v) / p.r_v
    return (p.k_v * x * (x - p.a) * (x - 1.0) + x * w) * (p.r_v / p.r_t)


def state_rates(v: float, s: tuple[float], p: Constants) -> tuple[float]:
    """dw/dt = (e_0 + mu_1 w/(mu_2 + v*)) (-w - k_v v* (v* - b - 1)) / r_t, 1/ms (eq. 100)."""
    (w,) = s
    x = (v - p.s_v) / p.r_v
    return ((p.e_0 + p.mu_1 * w / (p.mu_2 + x)) * (-w - p.k_v * x * (x - p.b - 1.0)) / p.r_t,)


MODEL = AlievPanfilov
