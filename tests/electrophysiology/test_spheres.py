"""A wave that climbs a sphere against one-dimensional finite volumes in the latitude."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from stages.electrophysiology.monodomain import build
from stages.electrophysiology.recording import BeatRecorder
from stages.numerics.bsplines import Array
from stages.numerics.shapes import spherical_panel
from tests.paper import CELL, S1, electrophysiology_config

RADIUS, SOUTH, NORTH = 1.0, -20.0, 65.0
MARKS = np.array([0.0, 20.0, 40.0, 55.0])
"""Latitudes at which arrivals are compared, degrees."""
END = 120.0
"""ms."""


def finite_volumes(conductivity: float, cells: int = 500) -> Array:
    """Arrivals (-30 mV) at the marks of a wave that starts at the southern edge, ms.

    v_t = D/(R^2 cos b) (cos b v_b)_b + f(v, w) in the latitude b, with D along meridians.
    """
    b = np.deg2rad(np.linspace(SOUTH, NORTH, cells + 1))
    middle, h = 0.5 * (b[:-1] + b[1:]), RADIUS * (b[1] - b[0])
    faces, area = np.cos(b), np.cos(middle)

    def rate(t: float, y: Array) -> Array:
        v, w = y[:cells], y[cells:]
        flow = np.zeros(cells + 1)
        flow[1:-1] = conductivity * faces[1:-1] * np.diff(v) / h
        flow[0] = -2.0 * faces[0] * (t <= 5.0)
        f = (v + 80.0) / 100.0
        p = CELL
        ionic = (p.k_v * f * (f - p.a) * (f - 1.0) + f * w) * 100.0 / 12.9
        slow = (p.e_0 + p.mu_1 * w / (f + p.mu_2)) * (-w - p.k_v * f * (f - p.b - 1.0)) / 12.9
        return np.concatenate((np.diff(flow) / (area * h) - ionic, slow))

    start = np.concatenate((np.full(cells, -80.0), np.zeros(cells)))
    times = np.linspace(0.0, END, 1201)
    tri = sum(np.eye(cells, k=k) for k in (-1, 0, 1))
    coupled = np.block([[tri, np.eye(cells)], [np.eye(cells), np.eye(cells)]])
    y, pieces = start, []
    for first, last in ((0, 50), (50, 1200)):  # the flux stops after 5 ms
        solved = solve_ivp(
            rate,
            (times[first], times[last]),
            y,
            method="BDF",
            t_eval=times[first : last + 1],
            jac_sparsity=coupled,
            rtol=1e-6,
            atol=1e-6,
        )
        y = solved.y[:, -1]
        pieces.append(solved.y[:cells, : last - first])
    history = np.concatenate((*pieces, y[:cells, None]), axis=1)
    arrivals = []
    for mark in MARKS:
        v = np.array([np.interp(np.deg2rad(mark), middle, column) for column in history.T])
        k = int(np.flatnonzero(v > -30.0)[0])
        arrivals.append(times[k - 1] + 0.1 * (-30.0 - v[k - 1]) / (v[k] - v[k - 1]))
    return np.array(arrivals)


@pytest.mark.parametrize(
    ("along", "changes"),
    [
        (0.002, {}),
        (0.002, {"transverse_conductivity": 0.0005, "diffusion_angle": 90.0}),
        (0.001, {"transverse_conductivity": 0.001, "diffusion_angle": 0.0}),
    ],
    ids=["isotropic", "fibres along meridians", "fibres along parallels"],
)
def test_a_wave_up_a_sphere_arrives_when_finite_volumes_say(
    along: float, changes: dict[str, float]
) -> None:
    """Parallels get shorter, the front converges and speeds up: curvature that no flat film has."""
    patch = spherical_panel(RADIUS, (0.0, 20.0), (SOUTH, NORTH)).refine(4, (1, 60))
    stimuli = (S1.model_copy(update={"edge": "Y=0"}),)
    config = electrophysiology_config(n_steps=2400, duration=END, stimuli=stimuli, **changes)
    stepper, state = build(config, patch)
    beats = BeatRecorder(state.potential, -30.0, -80.0)
    stepper.advance(state, 2400, beats.watch)
    found = beats.tables()["activation_times"][:, 0].reshape(5, -1)
    height = patch.evaluate(patch.first.greville(), patch.second.greville())[:, 2].reshape(5, -1)
    latitude = np.rad2deg(np.arcsin(height[0] / RADIUS))
    np.testing.assert_allclose(found, np.broadcast_to(found[:1], found.shape), rtol=0, atol=1e-6)
    reached = CubicSpline(latitude, found[0])(MARKS)
    # half a step (0.025 ms) by which the scheme sees the flux late, and 0.01 ms of the mesh
    np.testing.assert_allclose(reached - 0.025, finite_volumes(along), rtol=0, atol=0.05)
