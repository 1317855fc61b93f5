"""Beats watched while the solution advances: activation, peak, and repolarisation at every point.

A beat begins when the potential rises through the threshold. Its peak is the largest potential until the
next beat. It is repolarised by x when the potential falls, for the first time after the peak, to

    v_x = v_rest + (1 - x)(v_peak - v_rest),    x = 50 % and 90 %.

Times, and the peak itself, are those of the parabola through three time levels, of the straight line through
two where a stimulus has just set in or ended (:func:`restart`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from stages.numerics.compiled import inlined, kernel

BLOCK = 128
"""Points that are looked at together: where none of them has an event, that is SIMD code."""


class Watch(NamedTuple):
    """What the compiled loop reads and writes at every step; arrays of shape ``(point,)``.

    Attributes
    ----------
    threshold, rest
        Potential that begins a beat, and the one to which the tissue returns, mV.
    high, low
        Nothing happens while the potential stays between them, mV. ``high`` is the threshold, or above
        it the highest level of this beat so far; ``low`` is infinite while the potential still rises.
    started, half, full
        Times of the beat that is under way: activation, 50 % and 90 % repolarisation, ms; NaN until then.
    top
        Peak of that beat, once it is passed, mV.
    awaited
        Potential whose undershooting is the next repolarisation, mV; minus infinity where there is none.
    levels
        Potential at three successive time levels in turn, mV, shape ``(3, point)``; NaN before the first.
    log
        Beats that are over: a row (point, activation, 50 %, 90 %, peak) each.
    counts
        Rows of the log that are filled, and steps done: shape ``(2,)``.
    """

    threshold: float
    rest: float
    high: Array
    low: Array
    started: Array
    half: Array
    full: Array
    top: Array
    awaited: Array
    levels: Array
    log: Array
    counts: NDArray[np.int64]


def watch_of(potential: Array, threshold: float, rest: float, rows: int) -> Watch:
    """Watch that begins at a potential, mV, shape ``(point,)``, with room for ``rows`` finished beats.

    Points that are above the threshold already have no beat before they have been below it.
    """
    above, unknown = potential >= threshold, np.full(potential.size, np.nan)
    return Watch(
        threshold=threshold,
        rest=rest,
        high=np.where(above, np.inf, threshold),
        low=np.where(above, threshold, -np.inf),
        started=unknown.copy(),
        half=unknown.copy(),
        full=unknown.copy(),
        top=unknown.copy(),
        awaited=np.full(potential.size, -np.inf),
        levels=np.array([potential, unknown, unknown]),
        log=np.empty((rows, 5)),
        counts=np.zeros(2, dtype=np.int64),
    )


UNWATCHED = watch_of(np.empty(0), 0.0, 0.0, 0)
"""For steps of which nothing is to be recorded."""


@kernel
def watch(w: Watch, new: Array, start: float, step: float) -> None:
    """Note the events between ``start`` and ``start + step`` ms, at whose end the potential is ``new``."""
    now = w.counts[1] % 3
    newest = w.levels[(now + 1) % 3]
    for first in range(0, new.size if w.high.size else 0, BLOCK):
        block = slice(first, first + BLOCK)  # counted from 0, its loop becomes SIMD code
        potential, kept, high, low = new[block], newest[block], w.high[block], w.low[block]
        events = 0
        for i in range(potential.size):
            v = potential[i]
            kept[i] = v
            rising = (v > high[i]) & (low[i] == np.inf)
            events += 1 if ((v >= high[i]) | (v <= low[i])) & (not rising) else 0
            high[i] = v if rising else high[i]
        if events:
            for i in range(potential.size):
                v = potential[i]
                rising = (v == high[i]) & (low[i] == np.inf)
                if ((v >= high[i]) | (v <= low[i])) & (not rising):
                    _note(w, first + i, now, v, start, step)
    w.counts[1] += 1


@kernel
def restart(w: Watch, points: NDArray[np.int64], potential: Array) -> None:
    """What drives some points sets in or ends: earlier levels say nothing of the coming step.

    Where their potential jumps up below the threshold, the parabolas to come start from ``potential``, the
    one after the jump. After other jumps only the level before is left out: the peak is what was reached.
    """
    now, old = w.counts[1] % 3, (w.counts[1] + 2) % 3
    for i in points if w.high.size else points[:0]:
        w.levels[old, i] = np.nan
        if w.levels[now, i] < potential[i] < w.threshold:
            w.levels[now, i] = potential[i]


@inlined
def _note(w: Watch, i: int, now: int, v2: float, start: float, step: float) -> None:
    """The events of one point."""
    v0, v1 = w.levels[(now + 2) % 3, i], w.levels[now, i]
    if math.isnan(v0):
        v0 = 2.0 * v1 - v2  # a straight line where only two levels are of use
    if v1 < w.threshold <= v2:
        _log(w, i)
        w.started[i] = start + step * _crossing(-v0, -v1, -v2, -w.threshold)
        _rise(w, i, v2)
    elif v2 > w.high[i]:
        _rise(w, i, v2)
    else:
        if w.low[i] == np.inf:
            w.top[i] = _top(v0, v1, v2)
            w.awaited[i] = w.rest + 0.5 * (w.top[i] - w.rest)
        if v2 <= w.awaited[i] and math.isnan(w.half[i]):
            w.half[i] = start + step * _crossing(v0, v1, v2, w.awaited[i])
            w.awaited[i] = w.rest + 0.1 * (w.top[i] - w.rest)
        if v2 <= w.awaited[i]:
            w.full[i] = start + step * _crossing(v0, v1, v2, w.awaited[i])
            w.awaited[i] = -np.inf
        if v2 < w.threshold:
            w.high[i], w.low[i] = w.threshold, w.awaited[i]
        else:
            w.low[i] = max(w.threshold, w.awaited[i])


@inlined
def _rise(w: Watch, i: int, v: float) -> None:
    """Higher than ever in this beat: whatever was taken for repolarisation was none."""
    w.high[i], w.low[i] = v, np.inf
    w.half[i], w.full[i] = np.nan, np.nan


@inlined
def _log(w: Watch, i: int) -> None:
    """The beat that ends, if there was one."""
    if math.isnan(w.started[i]):
        return
    row = w.counts[0]
    if row < w.log.shape[0]:
        w.log[row, 0] = i
        w.log[row, 1] = w.started[i]
        w.log[row, 2] = w.half[i]
        w.log[row, 3] = w.full[i]
        w.log[row, 4] = w.top[i]
    w.counts[0] = row + 1


@inlined
def _crossing(v0: float, v1: float, v2: float, level: float) -> float:
    """Part s of the step at which the parabola through v(-1), v(0), v(1) falls to ``level``.

    v1 > level >= v2, so that the parabola has one root there; written so that nothing cancels.
    """
    bend, slope = 0.5 * (v0 + v2) - v1, 0.5 * (v2 - v0)
    root = math.sqrt(max(slope * slope - 4.0 * bend * (v1 - level), 0.0))
    return min(2.0 * (v1 - level) / (root - slope), 1.0)


@inlined
def _top(v0: float, v1: float, v2: float) -> float:
    """Largest value of the parabola through three levels; on a straight line down, that where it begins."""
    bend, slope = 0.5 * (v0 + v2) - v1, 0.5 * (v2 - v0)
    return v1 - slope * slope / (4.0 * bend) if bend < 0.0 and v0 <= v1 else v1
