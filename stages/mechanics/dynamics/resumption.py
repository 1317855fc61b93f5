"""The state of a moving film as plain arrays, for a checkpoint, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.energy_balance import Forces, Works
from stages.numerics.integration import Travel
from stages.numerics.step_control import Control
from stages.numerics.step_error import Balance
from stages.numerics.time_stepping import Motion


def packed(travel: Travel, control: Control) -> dict[str, Array | float]:
    """Everything that the next frame depends on; the tally begins anew with it."""
    motion, forces, balance = travel.motion, travel.forces, travel.balance
    return {
        "displacement": motion.displacement,
        "velocity": motion.velocity,
        "acceleration": motion.acceleration,
        "internal_force": forces.internal,
        "active_force": forces.active,
        "external_force": forces.external,
        "strain_energy": forces.strain_energy,
        "balance_acceleration": balance.acceleration,
        "balance_slope": balance.slope,
        "balance_length": balance.length,
        "works": np.array(travel.works),
        "control": np.array([control.length, control.error]),
    }


def unpacked(saved: Mapping[str, Any]) -> tuple[Travel, Control]:
    """The state from what :func:`packed` made of it."""
    motion = Motion(saved["displacement"], saved["velocity"], saved["acceleration"])
    forces = Forces(
        saved["internal_force"],
        saved["active_force"],
        saved["external_force"],
        float(saved["strain_energy"]),
    )
    balance = Balance(
        saved["balance_acceleration"], saved["balance_slope"], float(saved["balance_length"])
    )
    works = Works(*(float(w) for w in saved["works"]))
    length, error = (float(x) for x in saved["control"])
    return Travel(motion, forces, balance, works), Control(length, error)
