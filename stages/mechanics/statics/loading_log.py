"""What a quasi-static run has to tell: divided steps, critical points, a film rolled up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stages.mechanics.body.body import Balance
from stages.mechanics.statics.equilibrium import Shape
from stages.mechanics.statics.loading import in_words
from stages.mechanics.statics.roll_up import largest_turn
from stages.numerics.critical import Critical


@dataclass
class LoadingLog:
    """Notices changes from frame to frame.

    Attributes
    ----------
    divided
        Frames that took more than one load step.
    unstable
        Unstable directions in the last frame.
    rolled
        Whether the film has rolled up into a full circle.
    limits, bifurcations
        Load factors of the critical points passed, in their order.
    """

    divided: int = 0
    unstable: int = 0
    rolled: bool = False
    limits: list[float] = field(default_factory=list)
    bifurcations: list[float] = field(default_factory=list)

    @classmethod
    def restored(cls, saved: Mapping[str, Any]) -> LoadingLog:
        """What a checkpoint kept."""
        return cls(
            int(saved["divided"]),
            int(saved["unstable"]),
            bool(saved["rolled"]),
            [float(x) for x in saved["limits"]],
            [float(x) for x in saved["bifurcations"]],
        )

    def saved(self) -> dict[str, Any]:
        """What a checkpoint keeps."""
        return {
            "divided": self.divided,
            "unstable": self.unstable,
            "rolled": self.rolled,
            "limits": np.array(self.limits),
            "bifurcations": np.array(self.bifurcations),
        }

    def look_at_frame(
        self, time: float, interval: float, balance: Balance, shape: Shape
    ) -> Iterator[str]:
        """Warnings about a new frame of a run by load.

        Parameters
        ----------
        time, interval
            Time of the frame and since the last one, ms.
        balance, shape
            The equilibrium and how it was found.
        """
        if shape.smallest_step < 0.99 * interval:
            self.divided += 1
        unstable = balance.unstable_directions
        if unstable != self.unstable:
            yield _stability(
                self.unstable, unstable, time, interval, in_words(balance.body, balance.imposed)
            )
            self.unstable = unstable
        yield from self._rolled_up(
            f"t = {time:g} ms ({in_words(balance.body, balance.imposed)})", balance
        )

    def look_at_point(
        self, number: int, load: float, balance: Balance, passed: Sequence[Critical]
    ) -> Iterator[str]:
        """Warnings about a new point of a path by arc length."""
        self.unstable = balance.unstable_directions
        span = f"between points {number - 1} and {number}"
        for critical in passed:
            factor = critical.point.load
            if critical.kind == "limit point":
                self.limits.append(factor)
                yield (
                    f"{span} the load has a limit point, at the factor {factor:.6g}: a real film under "
                    f"that load would snap away; then {unstable_directions(self.unstable)}"
                )
            else:
                self.bifurcations.append(factor)
                yield (
                    f"{span} another path branches off, at the load factor {factor:.6g}: a real film, "
                    f"never perfect, would follow the stable one; then {unstable_directions(self.unstable)}"
                )
        yield from self._rolled_up(f"point {number} (load factor {load:.4g})", balance)

    def _rolled_up(self, place: str, balance: Balance) -> Iterator[str]:
        if self.rolled:
            return
        turn = largest_turn(balance.body.shell.patch, balance.displacement)
        if turn > 2.0 * np.pi:
            self.rolled = True
            yield (
                f"at {place} the film has rolled up past a full circle: "
                f"it turns by {np.degrees(turn):.0f} degrees from end to end. Contact of the film "
                f"with itself is not modelled: from here on it passes through itself"
            )


def unstable_directions(number: int) -> str:
    """Their number in words."""
    return f"{number} unstable direction{'s' if number != 1 else ''}"


def _stability(before: int, now: int, time: float, interval: float, load: str) -> str:
    span = f"between t = {max(time - interval, 0.0):g} and {time:g} ms ({load})"
    if now > before:
        return (
            f"{span} the film has buckled or passed a limit point: its equilibrium has "
            f"{unstable_directions(now)} (before: {before}); a real film "
            f"would snap away from it"
        )
    return f"{span} the film has become more stable: {unstable_directions(now)} (before: {before})"
