"""Linear rise from 0 to 1, then 1: the gradual load of a quasi-static path (sec. 4.1)."""

from __future__ import annotations

from typing import Literal

from stages.configuration import quantity
from stages.time_laws.base import TimeLaw


class Ramp(TimeLaw):
    """When the rise begins and how long it takes."""

    name: Literal["ramp"] = "ramp"
    start: float = quantity("ms", "time at which the rise begins", "sec. 4.1", ge=0, default=0.0)
    rise_time: float = quantity("ms", "time from 0 to the full value", "sec. 4.1", gt=0)

    def at(self, time: float) -> float:
        """(t - start)/rise_time, not below 0 and not above 1.

        Examples
        --------
        >>> law = Ramp(start=10.0, rise_time=40.0)
        >>> [law.at(t) for t in (0.0, 10.0, 30.0, 50.0, 60.0)]
        [0.0, 0.0, 0.5, 1.0, 1.0]
        """
        return min(max((time - self.start) / self.rise_time, 0.0), 1.0)


MODEL = Ramp
