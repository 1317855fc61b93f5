"""Fields followed at probes: exact on fields that the splines hold."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.patches import Patch
from stages.numerics.time_series import TimesNotCoveredError
from stages.postprocessing.probes import (
    collocation_weights,
    control_weights,
    probe_parameters,
    resample,
    series,
)

FILM = Patch.rectangle(3.5, 2.0).refine(2, (10, 4))
CELLS = Patch.rectangle(3.5, 2.0, height=0.009).refine(3, (14, 8))
POINTS = np.array([(1.75, 1.0), (3.5, 1.0), (3.5, 2.0), (0.613, 1.71)])
THETA = POINTS / np.array([3.5, 2.0])


def test_probes_are_found_in_the_undeformed_film() -> None:
    # locate() iterates to rounding on a flat film.
    np.testing.assert_allclose(probe_parameters(FILM, POINTS), THETA, atol=1e-14)


def test_probes_are_found_on_a_film_that_is_not_flat() -> None:
    bulge = FILM.control_points.copy()
    bulge[2:-2, :, 2] = 0.3
    film = Patch(FILM.first, FILM.second, bulge)
    theta = probe_parameters(film, POINTS[:1] + np.array([0.2, 0.0]))
    x = np.linspace(0.0, theta[0, 0], 200_001)
    line = film.evaluate(x, np.array([0.5]))
    chords = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert chords == pytest.approx(POINTS[0, 0] + 0.2, abs=1e-9)  # chords of 1e-5 mm


def test_a_probe_outside_the_film_is_refused() -> None:
    with pytest.raises(ValueError, match="does not lie on the film"):
        probe_parameters(FILM, np.array([[3.6, 1.0]]))


def test_values_at_collocation_points_are_followed_through_their_spline() -> None:
    places = CELLS.evaluate(*(space.greville() for space in CELLS.spaces))
    x, y = places[:, 0], places[:, 1]
    field = np.stack([x**3 - 2 * x * y**2 + t for t in range(3)])  # cubic: in the space
    found = series(field, collocation_weights(CELLS, THETA))
    x, y = POINTS.T
    # Exact up to rounding; values reach 43.
    np.testing.assert_allclose(found[2], x**3 - 2 * x * y**2 + 2, atol=1e-12)


def test_control_values_are_followed_through_their_basis() -> None:
    field = np.stack([FILM.control_points.reshape(-1, 3) * s for s in (1.0, -2.0)])
    found = series(field, control_weights(FILM, THETA))
    np.testing.assert_allclose(found[1, :, :2], -2.0 * POINTS, atol=1e-14)


def test_resampling_is_linear_between_frames() -> None:
    time = np.arange(0.0, 11.0)
    values = np.column_stack((2 * time, -time))
    found = resample(values, time, np.array([0.0, 2.5, 10.0]))
    np.testing.assert_allclose(found, [[0, 0], [5, -2.5], [20, -10]], rtol=1e-15)


def test_times_outside_the_history_are_refused() -> None:
    time = np.arange(0.0, 11.0)
    with pytest.raises(TimesNotCoveredError, match=r"from 0 to 10\.5 ms, but .* 0 to 10 ms only"):
        resample(time[:, None], time, np.array([0.0, 10.5]))
