"""Waves on bent films run as on flat ones, and probes find them by lengths along the film."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from stages.artefacts import ExcitableSurface
from stages.electrophysiology.stage import electrophysiology
from stages.geometry.config import FilmConfig, MeshConfig
from stages.geometry.films import film_patch
from stages.numerics.film_lengths import FilmLengths
from tests.paper import electrophysiology_config

LENGTH = 3.5


def speed(shape: dict[str, Any], elements: int = 51) -> float:
    """Speed of S1 from X = 1 to X = 2.5 mm along a strip, in steps of 0.1 ms, mm/ms."""
    film = FilmConfig(
        length=LENGTH,
        width=0.2,
        substrate_thickness=0.008,
        active_thickness=0.002,
        fibre_angle=0.0,
        shape=shape,
    )
    patch = film_patch(film, MeshConfig(elements=(elements, 2), degree=4))
    config = electrophysiology_config(
        elements=(elements, 2), degree=4, duration=160.0, n_steps=1600, output_interval=160.0
    )
    history = electrophysiology.compute(config, ExcitableSurface(patch))
    times = np.asarray(history.activation_times)[:, 0].reshape(patch.first.size, -1)[:, 1]
    x = FilmLengths(patch).along(0, patch.first.greville())
    passed = np.interp([1.0, 2.5], x[np.isfinite(times)], times[np.isfinite(times)])
    return float(1.5 / (passed[1] - passed[0]))


@pytest.mark.parametrize(
    "shape",
    [
        {"name": "cylinder", "radius": 2.0, "axis": "Y"},
        {"name": "cylinder", "radius": 0.8, "axis": "Y", "inside": "bottom"},
        {"name": "cylinder", "radius": 0.1, "axis": "X"},
    ],
    ids=["around, exact arc", "around, most of a turn", "along"],
)
def test_a_wave_runs_along_and_around_a_cylinder_as_fast_as_on_a_flat_film(
    shape: dict[str, Any],
) -> None:
    # bending changes no length; spans of a rational arc are uneven, so that the error of the flat front on
    # this mesh (2e-4) differs a little; linear interpolation between points adds as much
    assert speed(shape) == pytest.approx(speed({"name": "flat"}), rel=6e-4)
