"""Probe series as a table that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``probes.csv``: one row per mechanics time, five columns per probe."""
    measures = experiment.measures
    heading = ["time [ms]"]
    columns = [measures.time]
    for i, name in enumerate(measures.probe_names):
        heading += [f"{name}.{axis} [mm]" for axis in ("ux", "uy", "uz")]
        heading += [f"{name}.active_stress [kPa]", f"{name}.potential [mV]"]
        columns += [measures.displacement[:, i, axis] for axis in range(3)]
        columns += [measures.active_stress[:, i], measures.potential[:, i]]
    write_csv(folder / "probes.csv", heading, np.column_stack(columns))
