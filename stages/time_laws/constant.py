"""q(t) = 1: acts in full from the first instant (sec. 4.1)."""

from __future__ import annotations

from typing import Literal

from stages.time_laws.base import TimeLaw


class Constant(TimeLaw):
    """No parameters: the size is that of the load or of the peak stress."""

    name: Literal["constant"] = "constant"

    def at(self, time: float) -> float:
        """One, at any time.

        Examples
        --------
        >>> Constant().at(3.0)
        1.0
        """
        return 1.0


MODEL = Constant
