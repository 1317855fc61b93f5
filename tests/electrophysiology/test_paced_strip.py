"""A paced strip against an independent method of lines."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stages.artefacts import ExcitableSurface
from stages.electrophysiology.protocols.config import RestitutionConfig, RestitutionProtocol
from stages.electrophysiology.protocols.stage import restitution
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from tests.paper import S1, electrophysiology_config

LENGTH, S2 = 3.0, 500.0


def lines(points: int, end: float) -> tuple[Array, Array]:
    """Potential at 1.0, 1.5 and 2.0 mm over time: second-order differences, an adaptive integrator."""
    h = LENGTH / (points - 1)
    probes = [round(x / h) for x in (1.0, 1.5, 2.0)]

    def rates(t: float, y: Array, flux: float) -> Array:
        v, w = y.reshape(2, -1)
        x = (v + 80.0) / 100.0
        ghost = np.concatenate(([v[1]], v, [v[-2]]))
        diffusion = 0.002 * (ghost[2:] - 2.0 * v + ghost[:-2]) / h**2
        diffusion[0] += 2.0 * flux / h
        current = 100.0 / 12.9 * (8.0 * x * (x - 0.15) * (x - 1.0) + x * w)
        recovery = (0.002 + 0.2 * w / (0.3 + x)) * (-w - 8.0 * x * (x - 1.15)) / 12.9
        return np.concatenate((diffusion - current, recovery))

    y = np.concatenate((np.full(points, -80.0), np.zeros(points)))
    times, values = [], []
    knots = [0.0, 5.0, S2, S2 + 5.0, end]
    for (begin, stop), flux in zip(pairwise(knots), (2.0, 0.0) * 2, strict=True):
        at = np.append(np.arange(begin, stop, 0.25), stop)
        piece = solve_ivp(rates, (begin, stop), y, "RK45", at, rtol=1e-6, atol=1e-6, args=(flux,))
        times.append(at[:-1])
        values.append(piece.y[probes, :-1])
        y = piece.y[:, -1]
    return np.concatenate(times), np.concatenate(values, axis=1)


def crossing(times: Array, values: Array, level: float, after: float, up: bool) -> float:
    """First crossing of a level after a time, on the straight line between two samples."""
    sign = 1.0 if up else -1.0
    x = sign * (values - level)
    k = int(np.flatnonzero((times[:-1] >= after) & (x[:-1] < 0) & (x[1:] >= 0))[0])
    return float(np.interp(0.0, x[k : k + 2], times[k : k + 2]))


@pytest.mark.slow
def test_beats_on_a_strip_agree_with_an_independent_solver() -> None:
    times, values = lines(301, S2 + 400.0)
    rise = [crossing(times, v, -30.0, S2, up=True) for v in values]
    middle = values[1]
    ends = []
    for begin, stop in ((0.0, S2), (S2 + 60.0, S2 + 400.0)):
        inside = (times >= begin) & (times < stop)
        level = -80.0 + 0.1 * (middle[inside].max() + 80.0)
        top = times[inside][np.argmax(middle[inside])]
        ends.append(crossing(times, middle, level, top, up=False))

    protocol = RestitutionProtocol(
        preparation="cable",
        pulses={"cable": S1},
        count=1,
        period=1000.0,
        intervals=(S2,),
        periods=(),
        tolerance=1.0,
        window=(1.0, 2.0),
    )
    tissue = electrophysiology_config(
        elements=(60, 1), degree=4, n_steps=10_000, duration=400.0, stimuli=()
    )
    strip = ExcitableSurface(Patch.rectangle(LENGTH, 0.2).refine(4, (60, 1)))
    beat = restitution.compute(RestitutionConfig(tissue=tissue, protocol=protocol), strip).s2
    found = {name: float(getattr(beat, name)[0]) for name in ("apd90", "diastolic_interval")}
    expected = {"apd90": ends[1] - rise[1], "diastolic_interval": rise[1] - ends[0]}
    # found: 4e-4; both solvers are within a few 1e-4 of the speed of their limits
    assert beat.conduction_velocity[0] == pytest.approx(1.0 / (rise[2] - rise[0]), rel=1.5e-3)
    # found: 0.05 and 0.3 ms; beats are measured at the collocation point next to 1.5 mm, up to 0.025 mm
    # beside it, and the wave slows down and its beats shorten on the way
    assert found == pytest.approx(expected, abs=0.5)
