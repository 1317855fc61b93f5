"""The activation is the active stress itself: the coupled approach (sec. 4.3)."""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.mechanics.tension_laws.base import Tension, TensionLaw


class Constants(NamedTuple):
    """None."""


class Prescribed(TensionLaw):
    """No parameters."""

    name: Literal["prescribed"] = "prescribed"

    def constants(self) -> Constants:
        """Parameters as the law reads them."""
        return Constants()


def tension(activation: float, stretch: float, p: Constants) -> Tension:
    """sigma_a = activation, at any stretch.

    Examples
    --------
    >>> tension(12.2, 0.95, Constants())
    (12.2, 0.0)
    """
    return activation, 0.0


MODEL = Prescribed
