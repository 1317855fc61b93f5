"""Smooth twitch that rises to 1 and relaxes (eq. 103; Shim et al., 2012)."""

from __future__ import annotations

import math
from typing import Literal

from stages.configuration import quantity
from stages.time_laws.base import TimeLaw


class SmoothPulse(TimeLaw):
    """Parameter of eq. 103."""

    name: Literal["smooth-pulse"] = "smooth-pulse"
    time_to_peak: float = quantity("ms", "time from rest to the peak T", "eq. 103", gt=0)

    def at(self, time: float) -> float:
        """q = (t/T)^2 exp(1 - (t/T)^2), and 0 before t = 0.

        Examples
        --------
        >>> law = SmoothPulse(time_to_peak=210.0)
        >>> law.at(0.0), law.at(210.0), round(law.at(420.0), 6)  # 4 exp(-3)
        (0.0, 1.0, 0.199148)
        """
        square = (max(time, 0.0) / self.time_to_peak) ** 2
        return square * math.exp(1.0 - square)


MODEL = SmoothPulse
