"""Mitchell-Schaeffer two-current cell model: four time constants shape the action potential.

References
----------
C. C. Mitchell, D. G. Schaeffer, A two-current model for the dynamics of cardiac membrane, Bulletin of
Mathematical Biology 65 (2003) 767-793.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.electrophysiology.cell_models.base import CellModel

SOURCE = "Mitchell and Schaeffer (2003)"


class Constants(NamedTuple):
    """Times in ms, potentials in mV."""

    tau_in: float
    tau_out: float
    tau_open: float
    tau_close: float
    u_gate: float
    scale: float
    rest: float


class MitchellSchaeffer(CellModel):
    """du/dt = h u^2 (1 - u)/tau_in - u/tau_out, with u = (v - potential_rest)/potential_range.

    The gate h opens at rate (1 - h)/tau_open below ``gate_potential`` and closes at rate h/tau_close
    above it.
    """

    name: Literal["mitchell-schaeffer"] = "mitchell-schaeffer"
    tau_in: float = quantity("ms", "time constant of the inward current", SOURCE, gt=0)
    tau_out: float = quantity("ms", "time constant of the outward current", SOURCE, gt=0)
    tau_open: float = quantity("ms", "time in which the gate opens", SOURCE, gt=0)
    tau_close: float = quantity("ms", "time in which the gate closes", SOURCE, gt=0)
    gate_potential: float = quantity("", "u at which the gate turns", SOURCE, gt=0, lt=1)
    potential_range: float = quantity("mV", "potential of u = 1 above rest", "this project", gt=0)
    potential_rest: float = quantity("mV", "potential at rest, u = 0", "this project")
    initial_gate: float = quantity("", "gate h at the start", SOURCE, ge=0, le=1)

    def constants(self) -> Constants:
        """Parameters as the equations read them."""
        return Constants(
            self.tau_in,
            self.tau_out,
            self.tau_open,
            self.tau_close,
            self.gate_potential,
            self.potential_range,
            self.potential_rest,
        )

    def initial_states(self) -> tuple[float]:
        """The gate h."""
        return (self.initial_gate,)

    def rest_potential(self) -> float:
        """u = 0, mV."""
        return self.potential_rest


def ionic_current(v: float, s: tuple[float], p: Constants) -> float:
    """I_ion / C_m = potential_range (u/tau_out - h u^2 (1 - u)/tau_in), mV/ms.

    Examples
    --------
    >>> p = Constants(0.3, 6.0, 120.0, 150.0, 0.13, 100.0, -80.0)
    >>> ionic_current(-80.0, (1.0,), p)  # rest
    0.0
    >>> round(ionic_current(-30.0, (1.0,), p), 9)  # 100 (0.5/6 - 0.125/0.3)
    -33.333333333
    """
    (h,) = s
    u = (v - p.rest) / p.scale
    return p.scale * (u / p.tau_out - h * u * u * (1.0 - u) / p.tau_in)


def state_rates(v: float, s: tuple[float], p: Constants) -> tuple[float]:
    """dh/dt, 1/ms.

    Examples
    --------
    >>> p = Constants(0.3, 6.0, 120.0, 150.0, 0.13, 100.0, -80.0)
    >>> state_rates(-80.0, (0.4,), p), state_rates(-30.0, (0.75,), p)  # 0.6/120, -0.75/150
    ((0.005,), (-0.005,))
    """
    (h,) = s
    u = (v - p.rest) / p.scale
    opening, closing = (1.0 - h) / p.tau_open, -h / p.tau_close
    return (opening if u < p.u_gate else closing,)


MODEL = MitchellSchaeffer
