"""From collocation points and times to shell quadrature points and times (eqs. 86-87)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch


class TimesOutsideHistoryError(ValueError):
    """The shell asks for active stress at times that the cells were not simulated for."""

    remedy = "Simulate longer cells (electrophysiology.duration) or a shorter shell (mechanics.duration)."

    def __init__(self, wanted: tuple[float, float], given: tuple[float, float]) -> None:
        super().__init__(
            f"active stress is needed from {wanted[0]:g} to {wanted[1]:g} ms, but the "
            f"electrophysiology ran from {given[0]:g} to {given[1]:g} ms only"
        )


@dataclass(frozen=True)
class SurfaceTransfer:
    """Values at the Greville points of one patch to values on a tensor grid of parameters.

    The spline through the collocated values (eq. 86), evaluated at the grid (eq. 87); in one
    direction after the other, each a small dense matrix ``(grid, n)``.
    """

    first: Array
    second: Array

    @classmethod
    def between(cls, source: Patch, theta1: Array, theta2: Array) -> SurfaceTransfer:
        """Transfer from the Greville points of ``source`` to ``theta1`` x ``theta2``."""
        matrices = [
            space.evaluate(theta) @ space.interpolate(np.eye(space.size))
            for space, theta in zip(source.spaces, (theta1, theta2), strict=True)
        ]
        return cls(*matrices)

    def __call__(self, values: Array) -> Array:
        """Shape ``(point,)`` to shape ``(grid point,)``, direction 2 fastest on both sides."""
        grid = values.reshape(self.first.shape[1], self.second.shape[1])
        return (self.first @ grid @ self.second.T).ravel()


def check_covered(times: Array, wanted: Array) -> None:
    """Refuse wanted times before the first or after the last frame; nothing is extrapolated.

    Raises
    ------
    TimesOutsideHistoryError
        If a wanted time lies outside ``times`` by more than round-off.
    """
    slack = _slack(times)
    if wanted[0] < times[0] - slack or wanted[-1] > times[-1] + slack:
        raise TimesOutsideHistoryError(
            (float(wanted[0]), float(wanted[-1])), (float(times[0]), float(times[-1]))
        )


def resample(times: Array, wanted: Array, frame: Callable[[int], Array]) -> Iterator[Array]:
    """Fields at ``wanted`` times, linear between the two frames around each.

    Parameters
    ----------
    times
        Increasing times of the frames, ms.
    wanted
        Times asked for, ms, covered by the frames; a frame's own time returns that frame.
    frame
        Reads one frame by its index; called at most twice per wanted time.
    """
    slack = _slack(times)
    for time in wanted:
        after = min(int(np.searchsorted(times, time - slack)), times.size - 1)
        if abs(times[after] - time) <= slack:
            yield frame(after)
            continue
        weight = (time - times[after - 1]) / (times[after] - times[after - 1])
        yield (1.0 - weight) * frame(after - 1) + weight * frame(after)


def _slack(times: Array) -> float:
    """Difference that rounding may make between two equal times, ms."""
    return 1e-9 * float(np.abs(times).max())
