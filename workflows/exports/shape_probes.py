"""Probe series of a film without cells, as a table that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``probes.csv``: one row per frame, five columns per probe.

    Along a path, frames have a number and a load factor instead of a time.
    """
    shape = experiment.shape
    heading, columns = ["time [ms]"], [shape.time]
    if shape.along_path:
        heading = ["point", "load_factor"]
        columns = [np.arange(float(shape.time.size)), shape.load_factor]
    for i, name in enumerate(shape.probe_names):
        heading += [f"{name}.{axis} [mm]" for axis in ("ux", "uy", "uz")]
        heading += [f"{name}.active_stress [kPa]", f"{name}.fibre_stretch"]
        columns += [shape.displacement[:, i, axis] for axis in range(3)]
        columns += [shape.active_stress[:, i], shape.fibre_stretch[:, i]]
    write_csv(folder / "probes.csv", heading, np.column_stack(columns))
