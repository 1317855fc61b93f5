"""Active stress that depends on the fibre stretch: the imposed approach (eq. 96).

Outside [lambda_min, lambda_max] the stress is zero. The parabola has its zeros at lambda_0 - (lambda_s - 1)
-+ |1 - lambda_0|, which are 0.86 and 1.34 for Table 2, the ends of the range: there the stress is
continuous and only its slope jumps, which Newton takes like any other bend (it may need a few iterations
more). Other parameters make the stress itself jump at an end of the range, and where it lies beyond a
zero the stress is negative, a push, as the equation says. An equilibrium whose fibres lie right at a jump
need not exist: Newton then goes back and forth across it and says that it did not converge. Choose a
range between the zeros, or a load that keeps the fibres away from its ends.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import quantity
from stages.mechanics.tension_laws.base import Tension, TensionLaw


class Constants(NamedTuple):
    """What the equation reads: centre and squared half-width of the parabola, and the range."""

    centre: float
    square: float
    low: float
    high: float


class LengthDependent(TensionLaw):
    """Parameters of eq. 96."""

    name: Literal["length-dependent"] = "length-dependent"
    optimal_stretch: float = quantity(
        "", "stretch lambda_0 at which the muscle pulls most", "Table 2, eq. 96", gt=0
    )
    min_stretch: float = quantity(
        "", "smallest stretch lambda_min at which it pulls", "Table 2, eq. 96", gt=0
    )
    max_stretch: float = quantity(
        "", "largest stretch lambda_max at which it pulls", "Table 2, eq. 96", gt=0
    )
    prestretch: float = quantity(
        "", "stretch lambda_s of the fibres in the flat film", "Table 2, eq. 96", gt=0
    )

    @model_validator(mode="after")
    def _has_a_range(self) -> LengthDependent:
        if self.optimal_stretch == 1.0:
            raise PydanticCustomError(
                "optimal_stretch",
                "optimal_stretch must differ from 1: eq. 96 divides by (1 - lambda_0)^2",
            )
        if not self.min_stretch < self.max_stretch:
            raise PydanticCustomError(
                "stretch_range",
                "min_stretch = {low} must lie below max_stretch = {high}: the muscle pulls between them",
                {"low": f"{self.min_stretch:g}", "high": f"{self.max_stretch:g}"},
            )
        return self

    def constants(self) -> Constants:
        """Parameters as the law reads them."""
        return Constants(
            self.optimal_stretch - (self.prestretch - 1.0),
            (1.0 - self.optimal_stretch) ** 2,
            self.min_stretch,
            self.max_stretch,
        )


def tension(activation: float, stretch: float, p: Constants) -> Tension:
    """sigma_a = P q (1 - (lambda_f + lambda_s - 1 - lambda_0)^2/(1 - lambda_0)^2) in the range, else 0.

    Examples
    --------
    >>> table_2 = Constants(1.24 - 0.14, 0.24**2, 0.86, 1.34)
    >>> tension(10.0, 1.1, table_2)[0], tension(10.0, 0.5, table_2)[0]
    (10.0, 0.0)
    >>> round(tension(10.0, 1.0, table_2)[0], 4)  # 10 (1 - (0.1/0.24)^2)
    8.2639
    """
    if p.low <= stretch <= p.high:
        away = stretch - p.centre
        return activation * (1.0 - away * away / p.square), -2.0 * activation * away / p.square
    return 0.0, 0.0


MODEL = LengthDependent
