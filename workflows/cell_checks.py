"""Whether settings beside the cell model suit the cells, before anything is computed."""

from __future__ import annotations

from collections.abc import Iterator

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.limits import excitation
from workflows.tables import number


def threshold_out_of_reach(cells: ElectrophysiologyConfig) -> Iterator[str]:
    """An activation threshold that action potentials of these cells do not cross from below."""
    found, threshold = excitation(cells), cells.activation_threshold
    if found is None or found.start < threshold < found.peak:
        return
    middle = round(0.5 * (found.start + found.peak))
    yield (
        f"electrophysiology.activation_threshold = {number(threshold)} mV does not lie between rest "
        f"({number(found.start)} mV) and peak ({number(found.peak)} mV) of these cells: no activation "
        f"would be found; half way is {middle} mV"
    )
