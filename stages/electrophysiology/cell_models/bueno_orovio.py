"""Minimal model of human ventricular action potentials (Bueno-Orovio, Cherry and Fenton, 2008).

Three currents (fast inward, slow inward, slow outward) and three gates beside the potential; sets of
parameters for epicardial, endocardial and midmyocardial cells.

References
----------
A. Bueno-Orovio, E. M. Cherry, F. H. Fenton, Minimal model for human ventricular action potentials in
tissue, Journal of Theoretical Biology 253 (2008) 544-560.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.electrophysiology.cell_models.base import CellModel
from stages.numerics.elementary import exp, logistic

SOURCE = "Bueno-Orovio et al. (2008), Table 1"
SCALE = "Bueno-Orovio et al. (2008): V = 85.7 u - 84"


class Constants(NamedTuple):
    """Parameters in the order of Table 1, then the scale of the potential; times in ms, scale in mV."""

    u_o: float
    u_u: float
    theta_v: float
    theta_w: float
    theta_v_minus: float
    theta_o: float
    tau_v1_minus: float
    tau_v2_minus: float
    tau_v_plus: float
    tau_w1_minus: float
    tau_w2_minus: float
    k_w_minus: float
    u_w_minus: float
    tau_w_plus: float
    tau_fi: float
    tau_o1: float
    tau_o2: float
    tau_so1: float
    tau_so2: float
    k_so: float
    u_so: float
    tau_s1: float
    tau_s2: float
    k_s: float
    u_s: float
    tau_si: float
    tau_w_inf: float
    w_inf_star: float
    scale: float
    rest: float


class BuenoOrovio(CellModel):
    """Parameters of Table 1 there, with the names of that paper; u = (v - rest)/range."""

    name: Literal["bueno-orovio"] = "bueno-orovio"
    u_o: float = quantity("", "u at rest", SOURCE)
    u_u: float = quantity("", "u at which the fast current turns", SOURCE, gt=0)
    theta_v: float = quantity("", "u above which the fast current flows", SOURCE)
    theta_w: float = quantity("", "u above which the slow currents flow", SOURCE)
    theta_v_minus: float = quantity("", "u below which gate v opens", SOURCE)
    theta_o: float = quantity("", "u above which the outward current is faster", SOURCE)
    tau_v1_minus: float = quantity("ms", "opening of v below theta_v_minus", SOURCE, gt=0)
    tau_v2_minus: float = quantity("ms", "closing of v above theta_v_minus", SOURCE, gt=0)
    tau_v_plus: float = quantity("ms", "closing of v above theta_v", SOURCE, gt=0)
    tau_w1_minus: float = quantity("ms", "opening of w at low u", SOURCE, gt=0)
    tau_w2_minus: float = quantity("ms", "opening of w at higher u", SOURCE, gt=0)
    k_w_minus: float = quantity("", "steepness between the two", SOURCE)
    u_w_minus: float = quantity("", "u between the two", SOURCE)
    tau_w_plus: float = quantity("ms", "closing of w above theta_w", SOURCE, gt=0)
    tau_fi: float = quantity("ms", "fast inward current", SOURCE, gt=0)
    tau_o1: float = quantity("ms", "outward current below theta_o", SOURCE, gt=0)
    tau_o2: float = quantity("ms", "outward current above theta_o", SOURCE, gt=0)
    tau_so1: float = quantity("ms", "slow outward current at low u", SOURCE, gt=0)
    tau_so2: float = quantity("ms", "slow outward current at high u", SOURCE, gt=0)
    k_so: float = quantity("", "steepness between the two", SOURCE)
    u_so: float = quantity("", "u between the two", SOURCE)
    tau_s1: float = quantity("ms", "gate s below theta_w", SOURCE, gt=0)
    tau_s2: float = quantity("ms", "gate s above theta_w", SOURCE, gt=0)
    k_s: float = quantity("", "steepness of the target of s", SOURCE)
    u_s: float = quantity("", "u at which the target of s is 1/2", SOURCE)
    tau_si: float = quantity("ms", "slow inward current", SOURCE, gt=0)
    tau_w_inf: float = quantity("", "u at which the target of w would vanish", SOURCE, gt=0)
    w_inf_star: float = quantity("", "target of w above theta_o", SOURCE)
    potential_range: float = quantity("mV", "potential of u = 1 above rest", SCALE, gt=0)
    potential_rest: float = quantity("mV", "potential of u = 0", SCALE)
    initial_v: float = quantity("", "gate v at the start", SOURCE)
    initial_w: float = quantity("", "gate w at the start", SOURCE)
    initial_s: float = quantity("", "gate s at the start", SOURCE)

    def constants(self) -> Constants:
        """Parameters as the equations read them."""
        table = [getattr(self, name) for name in Constants._fields[:-2]]
        return Constants._make([*table, self.potential_range, self.potential_rest])

    def initial_states(self) -> tuple[float, float, float]:
        """The gates v, w, s."""
        return self.initial_v, self.initial_w, self.initial_s

    def rest_potential(self) -> float:
        """u = u_o, mV."""
        return self.potential_rest + self.potential_range * self.u_o


def ionic_current(v: float, s: tuple[float, float, float], p: Constants) -> float:
    """I_ion / C_m = range (J_fi + J_so + J_si), mV/ms.

    With E = exp(-2 k (u - m)), (1 + tanh(k (u - m)))/2 is 1/(1 + E), and a time constant that runs from
    t1 to t2 is (t1 E + t2)/(1 + E): one division each.

    Examples
    --------
    >>> epi = Constants(0.0, 1.55, 0.3, 0.13, 0.006, 0.006, 60.0, 1150.0, 1.4506, 60.0, 15.0, 65.0,
    ...     0.03, 200.0, 0.11, 400.0, 6.0, 30.0181, 0.9957, 2.0458, 0.65, 2.7342, 16.0, 2.0994,
    ...     0.9087, 1.8875, 0.07, 0.94, 85.7, -84.0)
    >>> ionic_current(-84.0, (1.0, 1.0, 0.0), epi)  # rest
    0.0
    >>> round(ionic_current(-75.43, (1.0, 1.0, 0.0), epi), 9)  # 85.7 * 0.1/6: the leak alone
    1.428333333
    >>> slow = 1.0 / (30.0181 + (0.9957 - 30.0181) / 2.0)  # at u = u_so: half way
    >>> fast = 1.0 * 0.35 * 0.9 / 0.11
    >>> round(ionic_current(85.7 * 0.65 - 84.0, (1.0, 1.0, 0.0), epi) / 85.7 / (slow - fast), 12)
    1.0
    """
    fast_gate, slow_gate, third = s
    u = (v - p.rest) / p.scale
    e = exp(-2.0 * p.k_so * (u - p.u_so))
    slow = (1.0 + e) / (p.tau_so1 * e + p.tau_so2)
    fast = fast_gate * (u - p.theta_v) * (p.u_u - u) / p.tau_fi
    plateau = slow - slow_gate * third / p.tau_si
    slow_leak, fast_leak = (u - p.u_o) / p.tau_o1, (u - p.u_o) / p.tau_o2
    leak = fast_leak if u >= p.theta_o else slow_leak
    outward = plateau if u >= p.theta_w else leak
    inward = fast if u >= p.theta_v else 0.0
    return p.scale * (outward - inward)


def state_rates(
    v: float, s: tuple[float, float, float], p: Constants
) -> tuple[float, float, float]:
    """Rates of the gates v, w and s, 1/ms.

    Examples
    --------
    >>> epi = Constants(0.0, 1.55, 0.3, 0.13, 0.006, 0.006, 60.0, 1150.0, 1.4506, 60.0, 15.0, 65.0,
    ...     0.03, 200.0, 0.11, 400.0, 6.0, 30.0181, 0.9957, 2.0458, 0.65, 2.7342, 16.0, 2.0994,
    ...     0.9087, 1.8875, 0.07, 0.94, 85.7, -84.0)
    >>> state_rates(-84.0, (1.0, 1.0, 0.0), epi)[:2]  # at rest both gates are open
    (0.0, 0.0)
    >>> v_rate, w_rate, s_rate = state_rates(85.7 * 0.9087 - 84.0, (0.5, 0.5, 0.1), epi)
    >>> round(v_rate * 1.4506, 12), round(w_rate * 200.0, 12), round(s_rate * 16.0, 12)
    (-0.5, -0.5, 0.4)
    """
    fast_gate, slow_gate, third = s
    u = (v - p.rest) / p.scale
    opening = (1.0 - fast_gate) / p.tau_v1_minus
    closing = -fast_gate / p.tau_v2_minus
    shut = -fast_gate / p.tau_v_plus
    below = closing if u >= p.theta_v_minus else opening
    v_rate = shut if u >= p.theta_v else below
    w_inf = p.w_inf_star if u >= p.theta_o else 1.0 - u / p.tau_w_inf
    e = exp(-2.0 * p.k_w_minus * (u - p.u_w_minus))
    rate = (1.0 + e) / (p.tau_w1_minus * e + p.tau_w2_minus)
    towards, away = (w_inf - slow_gate) * rate, -slow_gate / p.tau_w_plus
    w_rate = away if u >= p.theta_w else towards
    off = logistic(2.0 * p.k_s * (u - p.u_s)) - third
    low, high = off / p.tau_s1, off / p.tau_s2
    s_rate = high if u >= p.theta_w else low
    return v_rate, w_rate, s_rate


MODEL = BuenoOrovio
