"""An experiment with made-up histories: a wave crosses a film that bends while it is active."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from stages.artefacts import (
    Deformation,
    ExcitableSurface,
    FilmGeometry,
    Laminate,
    Layer,
    MidSurface,
)
from stages.mechanics.supports.clamped import Clamped
from stages.numerics.patches import Patch
from stages.postprocessing.config import PostprocessingConfig
from stages.postprocessing.measures import take_measures
from tests.histories import history_with
from workflows.experiment import Experiment

PROBES = PostprocessingConfig(
    probes={"A": (1.75, 1.0), "B": (3.5, 1.0), "C": (3.5, 2.0)},
    mid_axis=1.0,
    velocity_window=(1.0, 2.5),
)

CLAMPED = SimpleNamespace(mechanics=SimpleNamespace(supports={"clamp": Clamped(edge="X=0")}))
"""As much of a configuration as pictures look at."""


def synthetic_experiment(
    starts: tuple[float, ...] = (0.0, 430.0),
    duration: float = 1000.0,
    elements: tuple[int, int] = (50, 10),
    cells: tuple[int, int] = (102, 60),
) -> Experiment:
    """Plane waves that start at given times, and a diagonal roll that follows the mean stress."""
    film = Patch.rectangle(3.5, 2.0).refine(2, elements)
    surface = Patch.rectangle(3.5, 2.0, height=0.009).refine(2, cells)
    geometry = FilmGeometry(
        ExcitableSurface(surface),
        MidSurface(film),
        Laminate((Layer("active", "active", 0.004, 45.0, 1.0),)),
    )
    x = surface.evaluate(*(space.greville() for space in surface.spaces))[:, 0]
    time = np.arange(0.0, duration + 0.5)
    potential = np.full((time.size, x.size), -80.0, dtype=np.float32)
    stress = np.zeros((time.size, x.size), dtype=np.float32)
    for beat, start in enumerate(starts):
        age = time[:, None] - start - x / 0.0175
        up = 0.5 * (1 + np.tanh(age / 4.0)) * 0.5 * (1 - np.tanh((age - 250.0 + 60 * beat) / 30.0))
        potential += 100.0 * up
        stress += (12.0 - 2.0 * beat) * up
    arrivals = np.column_stack([start + x / 0.0175 for start in starts])
    history = history_with(
        time=time,
        potential=potential,
        active_stress=stress,
        activation_times=arrivals,
        apd90=np.full_like(arrivals, 250.0),
        conduction_velocity=np.broadcast_to([0.0175, 0.0, 0.0], (*arrivals.shape, 3)),
    )
    deformation = _rolled(film, time[::5], stress[::5].mean(axis=1))
    measures = take_measures(
        PROBES, history, geometry.excitable_surface, geometry.mid_surface, deformation
    )
    records: dict[str, Any] = {
        "geometry": geometry,
        "electrophysiology": history,
        "mechanics": deformation,
        "postprocessing": measures,
    }
    return Experiment(CLAMPED, records.__getitem__)


def _rolled(film: Patch, time: np.ndarray, stress: np.ndarray) -> Deformation:
    points = film.evaluate(*(space.greville() for space in film.spaces))
    frames = []
    for s in stress:
        k = 1e-9 + 0.05 * s * (1 + 0.25 * (points[:, 1] - 1.0))
        bent = np.stack(
            (np.sin(k * points[:, 0]) / k, points[:, 1], (1 - np.cos(k * points[:, 0])) / k), -1
        )
        frames.append((film.interpolate(bent).control_points - film.control_points).reshape(-1, 3))
    zeros, scalars = np.zeros((time.size, film.size, 3)), np.zeros(time.size)
    fibres = np.zeros((time.size, 9 * film.first.elements * film.second.elements))
    return Deformation(time, np.stack(frames), zeros, zeros, *10 * (scalars,), 1.0 + fibres, fibres)
