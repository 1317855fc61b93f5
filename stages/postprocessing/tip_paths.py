"""Tips of spiral waves linked over time, and the turns of a spiral as its tip tells them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from stages.artefacts import ActivationHistory, TipPaths
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.postprocessing.tips import Tips, tips_of_frames

TURN = 360.0
"""Degrees."""

FEWEST = 5
"""A tip that is seen in fewer frames than this is left out: fronts that meet make such pairs."""


class _Path:
    """A tip so far."""

    def __init__(self, tips: Tips, i: int) -> None:
        self.chirality = tips.chirality[i]
        self.rows: list[tuple[float, Array, float]] = []
        self.add(tips, i)

    def add(self, tips: Tips, i: int) -> None:
        self.rows.append((tips.time, tips.position[i], tips.heading[i]))

    def away(self, tips: Tips, i: int) -> float:
        """Distance of a tip from where this one was last, mm; infinite if it turns the other way."""
        if tips.chirality[i] != self.chirality:
            return float("inf")
        return float(np.linalg.norm(tips.position[i] - self.rows[-1][1]))


def linked(found: Iterable[Tips], reach: float, speed: float) -> TipPaths:
    """Paths of tips.

    From one time to the next, the tip and the path that are nearest to one another are joined first. A path
    ends where no tip is near.

    Parameters
    ----------
    found
        Tips time by time.
    reach
        Distance within which a tip is the same, if nothing moves, mm.
    speed
        Largest speed of a tip, mm/ms.
    """
    done: list[_Path] = []
    open_paths: list[_Path] = []
    for tips in found:
        free = set(range(len(tips.chirality)))
        pairs = sorted(
            (path.away(tips, i), k, i) for k, path in enumerate(open_paths) for i in free
        )
        goes_on = set()
        for away, k, i in pairs:
            allowed = reach + speed * (tips.time - open_paths[k].rows[-1][0])
            if i in free and k not in goes_on and away <= allowed:
                open_paths[k].add(tips, i)
                free.remove(i)
                goes_on.add(k)
        done += [path for k, path in enumerate(open_paths) if k not in goes_on]
        open_paths = [path for k, path in enumerate(open_paths) if k in goes_on]
        open_paths += [_Path(tips, i) for i in sorted(free)]
    kept = [path for path in (*done, *open_paths) if len(path.rows) >= FEWEST]
    return _table(sorted(kept, key=lambda path: path.rows[0][0]))


def tip_paths(surface: Patch, history: ActivationHistory, level: float) -> TipPaths:
    """Paths of all tips in the frames of a history.

    A tip is looked for within two cells of where it was, and farther by as far as it comes with twice the
    median speed of the fronts: a tip is the end of one.

    Parameters
    ----------
    surface
        Excitable surface.
    level
        Potential of the line that ends at a tip, mV.
    """
    places = surface.evaluate(surface.first.greville(), surface.second.greville())
    grid = places.reshape(surface.first.size, surface.second.size, 3)
    cell = max(float(np.linalg.norm(np.diff(grid, axis=k), axis=-1).max()) for k in (0, 1))
    speeds = np.linalg.norm(np.asarray(history.conduction_velocity, dtype=float), axis=-1)
    speeds = speeds[np.isfinite(speeds)]
    speed = 2.0 * float(np.median(speeds)) if speeds.size else 0.0
    time = np.asarray(history.time, dtype=float)
    return linked(tips_of_frames(surface, history.potential, time, level), 2.0 * cell, speed)


def no_tips() -> TipPaths:
    """What there is to tell where no tips were looked for."""
    return _table([])


def turn_times(tips: TipPaths) -> Array:
    """How long each turn of the longest-lived spiral took, ms.

    A turn is complete when the potential's gradient at the tip has the same direction again.
    """
    if not tips.number.size:
        return np.empty(0)
    numbers, rows = np.unique(tips.number, return_counts=True)
    longest = tips.number == numbers[np.argmax(rows)]
    time, chirality = tips.time[longest], tips.chirality[longest][0]
    turned = chirality * (tips.heading[longest] - tips.heading[longest][0]) / TURN
    forward = np.maximum.accumulate(turned)  # a tip may swing back for a moment
    whole = np.arange(0.0, np.floor(forward[-1]) + 1.0)
    rising = np.concatenate([[True], np.diff(forward) > 0.0])
    return np.diff(np.interp(whole, forward[rising], time[rising]))


def _table(paths: list[_Path]) -> TipPaths:
    sizes = [len(path.rows) for path in paths]
    rows = [row for path in paths for row in path.rows]
    headings = [np.unwrap([row[2] for row in path.rows], period=TURN) for path in paths]
    return TipPaths(
        time=np.array([row[0] for row in rows]),
        number=np.repeat(np.arange(1.0, len(paths) + 1.0), sizes),
        position=np.array([row[1] for row in rows]).reshape(-1, 3),
        chirality=np.repeat(np.array([path.chirality for path in paths], dtype=float), sizes),
        heading=np.concatenate([np.empty(0), *headings]),
    )
