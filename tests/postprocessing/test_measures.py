"""All measures together, on a film that rolls while a plane wave crosses it."""

from __future__ import annotations

import numpy as np
import pytest

from stages.artefacts import (
    ActivationHistory,
    Deformation,
    ExcitableSurface,
    Measures,
    MidSurface,
)
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.postprocessing.config import PostprocessingConfig
from stages.postprocessing.measures import take_measures
from tests.histories import history_with

SPEED = 0.0175  # mm/ms
LENGTH, WIDTH = 3.5, 2.0
FILM = Patch.rectangle(LENGTH, WIDTH).refine(2, (50, 10))
CELLS = Patch.rectangle(LENGTH, WIDTH, height=0.009).refine(2, (35, 6))
CONFIG = PostprocessingConfig(
    probes={"A": (1.75, 1.0), "B": (3.5, 1.0), "C": (3.5, 2.0)},
    mid_axis=1.0,
    velocity_window=(1.0, 2.5),
)


def travelling_wave() -> ActivationHistory:
    """Gaussian wave v(x - ct) that enters at t = 0 and again at t = 200 ms, weaker."""
    x = CELLS.evaluate(*(space.greville() for space in CELLS.spaces))[:, 0]
    time = np.arange(0.0, 501.0)
    arrivals = np.column_stack((x / SPEED, 200.0 + x / SPEED))

    def bell(age: Array) -> Array:
        return np.exp(-(((age - 40.0) / 15.0) ** 2))  # 40 ms after the arrival

    first, second = (bell(time[:, None] - arrivals[None, :, beat]) for beat in range(2))
    return history_with(
        time=time,
        potential=-80.0 + 100.0 * first,
        active_stress=12.0 * first + 10.0 * second,
        activation_times=arrivals,
    )


DEFORMATION_SCALARS = (
    "kinetic_energy",
    "strain_energy",
    "active_work",
    "external_work",
    "dissipated_energy",
    "energy_imbalance",
    "newton_iterations",
    "sub_steps",
    "shortest_step",
    "local_error",
)


def rolling_film(time: Array) -> Deformation:
    """Curvature 0.3/mm * t/t_end at every time, first flat."""
    points = FILM.evaluate(*(space.greville() for space in FILM.spaces))
    x = points[:, 0]
    frames = [np.zeros((FILM.size, 3))]
    for k in 0.3 * time[1:] / time[-1]:
        arc = np.stack((np.sin(k * x) / k, points[:, 1], (1 - np.cos(k * x)) / k), axis=-1)
        frames.append((FILM.interpolate(arc).control_points - FILM.control_points).reshape(-1, 3))
    zeros = np.zeros((time.size, FILM.size, 3))
    scalars = np.zeros(time.size)
    return Deformation(
        time=time,
        displacement=np.stack(frames),
        velocity=zeros,
        acceleration=zeros,
        fibre_stretch=scalars[:, None],
        active_stress=scalars[:, None],
        **dict.fromkeys(DEFORMATION_SCALARS, scalars),
    )


@pytest.fixture(scope="module")
def measures() -> Measures:
    deformation = rolling_film(np.linspace(0.0, 400.0, 81))
    return take_measures(
        CONFIG, travelling_wave(), ExcitableSurface(CELLS), MidSurface(FILM), deformation
    )


def test_the_probes_are_where_they_were_put(measures: Measures) -> None:
    assert measures.probe_names == ("A", "B", "C")
    expected = [(1.75, 1.0, 0.0), (3.5, 1.0, 0.0), (3.5, 2.0, 0.0)]
    np.testing.assert_allclose(measures.probe_points, expected, atol=1e-14)


def test_the_wave_passes_the_probes_at_its_speed(measures: Measures) -> None:
    x = measures.probe_points[:, 0]
    np.testing.assert_allclose(measures.activation_times[:, 0], x / SPEED, rtol=1e-12)
    np.testing.assert_allclose(measures.conduction_velocity, SPEED, rtol=1e-12)


def test_each_beat_shows_its_own_peak(measures: Measures) -> None:
    # Both bells keep 6e-20 of one another; a frame every ms misses a top by up to (0.5/15)^2 = 1e-3;
    # the spline (h = 0.1 mm under a bell of 0.26 mm) errs by about the same.
    np.testing.assert_allclose(measures.peak_active_stress[:2], [[12, 10], [12, 10]], rtol=5e-3)


def test_the_series_are_given_at_the_mechanics_times(measures: Measures) -> None:
    assert measures.active_stress.shape == (81, 3)
    age = measures.time - 1.75 / SPEED - 40.0
    exact = 12 * np.exp(-((age / 15) ** 2)) + 10 * np.exp(-(((age - 200) / 15) ** 2))
    # Spline interpolation of a bell of width 0.26 mm with h = 0.1 mm: below 1 % of its height.
    np.testing.assert_allclose(measures.active_stress[:, 0], exact, atol=0.1)
    first = -80 + 100 * np.exp(-((age / 15) ** 2))
    np.testing.assert_allclose(measures.potential[:, 0], first, atol=1.0)


def test_the_tip_moves_on_its_circle(measures: Measures) -> None:
    k = 0.3
    exact = (np.sin(k * LENGTH) / k - LENGTH, 0.0, (1 - np.cos(k * LENGTH)) / k)
    # An end point is interpolated exactly.
    np.testing.assert_allclose(measures.displacement[-1, 1], exact, atol=1e-13)


def test_the_curvature_grows_as_prescribed(measures: Measures) -> None:
    exact = 0.3 * measures.time / 400.0
    # Quadratic interpolation at h k = 0.02 errs by 1e-9 mm; dx/dk = k L^3/3 magnifies it most at the
    # first frame (k = 0.004/mm), by 17 /mm^2.
    np.testing.assert_allclose(measures.curvature, exact, atol=1e-6)
    assert measures.projected_length[0] == pytest.approx(LENGTH, rel=1e-15)


def test_mechanics_longer_than_the_electrophysiology_is_refused() -> None:
    deformation = rolling_film(np.linspace(0.0, 600.0, 3))
    with pytest.raises(ValueError, match="ran from 0 to 500 ms only"):
        take_measures(
            CONFIG, travelling_wave(), ExcitableSurface(CELLS), MidSurface(FILM), deformation
        )
