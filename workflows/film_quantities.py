"""Numbers that an experimenter would write down about a film with cells."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from workflows.workflow import Quantity

if TYPE_CHECKING:
    from stages.artefacts import Measures
    from stages.numerics.bsplines import Array


def quantities(measures: Measures) -> dict[str, Quantity]:
    """The numbers that an experimenter would write down."""
    speeds = listed(measures.conduction_velocity)
    found = {
        "conduction_velocity": Quantity(
            speeds[0] if speeds else None,
            "mm/ms",
            "speed of the first electrical front along the middle of the film",
        ),
        "max_curvature": of_flat_films(
            measures.curvature.max(),
            "1/mm",
            "largest curvature, from the length of the film's projection as in experiments",
        ),
    }
    for i, name in enumerate(measures.probe_names):
        found |= _probe_quantities(measures, i, name)
    return found


def of_flat_films(value: float, unit: str, meaning: str) -> Quantity:
    """What is read off the projection of a film that is flat at rest; nothing of any other film."""
    if math.isfinite(value):
        return Quantity(float(value), unit, meaning)
    return Quantity(None, unit, f"{meaning}: not measured, since this film is not flat at rest")


def _probe_quantities(measures: Measures, i: int, name: str) -> dict[str, Quantity]:
    tables = (
        measures.activation_times,
        measures.peak_active_stress,
        measures.repolarisation_times,
        measures.apd50,
        measures.apd90,
    )
    rows = zip(*(listed(table[i]) for table in tables), strict=True)
    beats = [(time, *others) for time, *others in rows if time is not None]
    reached = [float(measures.active_stress[:, i].max()), *(peak for _, peak, *_ in beats if peak)]
    motion = (measures.displacement[:, i] ** 2).sum(axis=-1) ** 0.5
    return {
        f"{name}.activation_times": Quantity(
            [time for time, *_ in beats],
            "ms",
            f"when the electrical front arrives at {name}, beat by beat",
        ),
        f"{name}.peak_active_stress": Quantity(
            max(reached), "kPa", f"how hard the muscle pulls at {name} at most"
        ),
        f"{name}.peak_active_stresses": Quantity(
            [peak for _, peak, *_ in beats], "kPa", f"the same for each beat at {name}"
        ),
        f"{name}.repolarisation_times": Quantity(
            [beat[2] for beat in beats],
            "ms",
            f"when {name} has come 90 % of the way back to rest, beat by beat",
        ),
        f"{name}.apd50": Quantity(
            [beat[3] for beat in beats],
            "ms",
            f"action potential duration at {name}: from activation to 50 % repolarisation",
        ),
        f"{name}.apd90": Quantity([beat[4] for beat in beats], "ms", "the same to 90 %"),
        f"{name}.max_displacement": Quantity(
            float(motion.max()), "mm", f"how far {name} moves from its place at rest at most"
        ),
    }


def listed(values: Array) -> list[float | None]:
    """Plain numbers, ``None`` for NaN."""
    return [float(v) if math.isfinite(v) else None for v in values]
