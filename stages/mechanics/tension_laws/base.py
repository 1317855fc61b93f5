"""What a tension law is: from activation and fibre stretch to the active stress (eqs. 37, 51, 96)."""

from __future__ import annotations

import sys
from typing import Any, ClassVar, NamedTuple, Protocol, TypeAlias, cast

from stages.configuration import Section

Tension: TypeAlias = tuple[float, float]
"""(sigma_a, d sigma_a / d lambda_f), kPa."""


class TensionLaw(Section):
    """Parameters of a tension law; its equation is a plain function beside the class.

    A law's file holds a subclass of this, names it in ``MODEL``, and defines at module level

    - ``tension(activation, stretch, p) -> (sigma_a, d sigma_a / d lambda_f)``, kPa;

    where ``activation`` (kPa) is what the stage before hands over, ``stretch`` is lambda_f > 0 at the
    point, and ``p`` is the named tuple that ``constants()`` returns. It is scalar Python, compiled into
    the loop over the points. The stress enters the shell as S_a = sigma_a/lambda_f^2 f0 (x) f0 (eqs.
    37-39) and its slope enters the tangent, which stays symmetric because sigma_a depends on the
    strain through lambda_f alone. A slope that is wrong costs Newton its quadratic convergence.
    """

    functions: ClassVar[tuple[str, ...]] = ("tension",)
    """What the module must define beside the class."""

    name: str

    def constants(self) -> NamedTuple:
        """Parameters as the law reads them."""
        raise TypeError(f"{type(self).__name__} does not say its constants")


class TensionFunctions(Protocol):
    """The module of a tension law; ``p`` are its constants."""

    MODEL: ClassVar[type[TensionLaw]]

    def tension(self, activation: float, stretch: float, p: Any) -> Tension:
        """Active stress and its slope."""
        ...


def functions_of(law: type[TensionLaw]) -> TensionFunctions:
    """The module that defines a tension law, and beside it its equation."""
    return cast(TensionFunctions, sys.modules[law.__module__])
