"""Maps of every beat for ParaView: beat k at the time k."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from stages.numerics.bsplines import Array
from workflows.experiment import Experiment
from workflows.exports.vtkhdf import POINTS, write_grid

FIELDS = {
    "activation_times": 1,
    "repolarisation_times": 1,
    "apd50": 1,
    "apd90": 1,
    "peak_potential": 1,
    "conduction_velocity": 3,
}


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``maps.vtkhdf`` into a folder: the film at rest with the maps at its collocation points.

    Nothing is interpolated: where a point has no such beat, its values are NaN. A run without beats
    shows the film alone.
    """
    patch = experiment.geometry.excitable_surface.patch
    places = patch.evaluate(patch.first.greville(), patch.second.greville())
    maps = {name: np.asarray(getattr(experiment.history, name)) for name in FIELDS}
    beats = maps["activation_times"].shape[1]
    numbers = np.arange(1.0, max(beats, 1) + 1.0)

    def frames() -> Iterator[Mapping[str, Array]]:
        for beat in range(beats):
            yield {POINTS: places, **{name: values[:, beat] for name, values in maps.items()}}
        if not beats:
            nothing = {name: np.full((len(places), n), np.nan) for name, n in FIELDS.items()}
            yield {POINTS: places, **nothing}

    shape = (patch.first.size, patch.second.size)
    write_grid(folder / "maps.vtkhdf", shape, numbers, FIELDS, frames())
