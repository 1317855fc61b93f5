"""What a quasi-static run has to tell: divided steps, lost stability, a film rolled up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stages.mechanics.body import Balance
from stages.mechanics.equilibrium import Shape
from stages.mechanics.roll_up import largest_turn


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
    """

    divided: int = 0
    unstable: int = 0
    rolled: bool = False

    @classmethod
    def restored(cls, saved: Mapping[str, Any]) -> LoadingLog:
        """What a checkpoint kept."""
        return cls(int(saved["divided"]), int(saved["unstable"]), bool(saved["rolled"]))

    def saved(self) -> dict[str, Any]:
        """What a checkpoint keeps."""
        return {"divided": self.divided, "unstable": self.unstable, "rolled": self.rolled}

    def look_at(
        self, time: float, interval: float, balance: Balance, shape: Shape
    ) -> Iterator[str]:
        """Warnings about a new frame.

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
            yield _stability(self.unstable, unstable, time, interval, _load(balance))
            self.unstable = unstable
        if not self.rolled:
            turn = largest_turn(balance.body.shell.patch, balance.displacement)
            if turn > 2.0 * np.pi:
                self.rolled = True
                yield (
                    f"at t = {time:g} ms ({_load(balance)}) the film has rolled up past a full circle: "
                    f"it turns by {np.degrees(turn):.0f} degrees from end to end. Contact of the film "
                    f"with itself is not modelled: from here on it passes through itself"
                )


def _stability(before: int, now: int, time: float, interval: float, load: str) -> str:
    span = f"between t = {max(time - interval, 0.0):g} and {time:g} ms ({load})"
    if now > before:
        return (
            f"{span} the film has buckled or passed a limit point: its equilibrium has "
            f"{now} unstable direction{'s' if now != 1 else ''} (before: {before}); a real film "
            f"would snap away from it"
        )
    return f"{span} the film has become more stable: {now} unstable directions (before: {before})"


def _load(balance: Balance) -> str:
    """What acts, in words."""
    imposed = balance.imposed
    parts = [f"activation up to {np.abs(imposed.activation).max(initial=0.0):.4g} kPa"]
    for load, factor in zip(balance.body.loads, imposed.loads, strict=True):
        parts.append(f"{load.label} times {factor:.4g}")
    parts += [f"supports moved by factor {drive:.4g}" for drive in imposed.drives]
    return ", ".join(parts)
