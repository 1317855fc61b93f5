"""Probe series as a table that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stages.artefacts import Measures, ShapeMeasures
from stages.numerics.bsplines import Array
from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``probes.csv``: one row per mechanics time, five columns per probe."""
    measures = experiment.measures
    heading, columns = probe_columns(measures, "potential [mV]", measures.potential)
    table = np.column_stack([measures.time, *columns])
    write_csv(folder / "probes.csv", ["time [ms]", *heading], table)


def probe_columns(
    measures: Measures | ShapeMeasures, last: str, values: Array
) -> tuple[list[str], list[Array]]:
    """Displacement, active stress and one field more, shape ``(time, probe)``, probe by probe."""
    heading, columns = [], []
    for i, name in enumerate(measures.probe_names):
        heading += [f"{name}.{axis} [mm]" for axis in ("ux", "uy", "uz")]
        heading += [f"{name}.active_stress [kPa]", f"{name}.{last}"]
        columns += [measures.displacement[:, i, axis] for axis in range(3)]
        columns += [measures.active_stress[:, i], values[:, i]]
    return heading, columns
