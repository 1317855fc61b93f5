"""Probe series as a table that any spreadsheet opens."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from workflows.experiment import Experiment
from workflows.exports.files import write_text


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
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heading)
    for row in np.column_stack(columns):
        writer.writerow([f"{value:.10g}" for value in row])
    write_text(folder / "probes.csv", text.getvalue())
