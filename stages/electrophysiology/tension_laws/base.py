"""What a tension law is (eq. 11)."""

from __future__ import annotations

import sys
from typing import Any, ClassVar, NamedTuple, Protocol, Self, cast

from stages.configuration import Section
from stages.electrophysiology.cell_models.base import CellModel


class TensionLaw(Section):
    """Parameters of a tension law; its equation is a plain function beside the class.

    A tension law file holds a subclass of this or of :class:`LinearTensionLaw`, names it in ``MODEL``,
    and defines at module level ``tension_rate(v, sigma, p) -> float``: d(sigma_a)/dt in kPa/ms, where
    ``v`` is the potential in mV, ``sigma`` the active stress in kPa and ``p`` the named tuple that
    ``constants()`` returns. Use ``stages.numerics.elementary.exp`` for exponentials.
    """

    linear: ClassVar[bool] = False
    functions: ClassVar[tuple[str, ...]] = ("tension_rate",)
    """What the module must define beside the class."""

    name: str

    def constants(self) -> NamedTuple:
        """Parameters as the equation reads them."""
        raise TypeError(f"{type(self).__name__} does not say its constants")

    def for_cells(self, cells: CellModel) -> Self:
        """The law for certain cells: they say its resting potential ``v_r`` where it was left out."""
        if "v_r" not in type(self).model_fields or getattr(self, "v_r", None) is not None:
            return self
        return self.model_copy(update={"v_r": cells.rest_potential()})

    def resting(self) -> float:
        """The resting potential ``v_r``, mV.

        Raises
        ------
        ValueError
            If it was left out and no cell has filled it in.
        """
        v_r: float | None = getattr(self, "v_r", None)
        if v_r is None:
            raise ValueError(f"the tension law {self.name} needs a resting potential v_r")
        return v_r


class LinearTensionLaw(TensionLaw):
    """A law d(sigma_a)/dt = rate (target - sigma_a) whose two numbers depend on the potential alone.

    Its file defines ``relaxation(v, p) -> (rate, target)`` instead, in 1/ms and kPa. They are evaluated
    once per potential, not once per stage of the Runge-Kutta step.
    """

    linear: ClassVar[bool] = True
    functions: ClassVar[tuple[str, ...]] = ("relaxation",)


class TensionEquation(Protocol):
    """The module of a tension law, which has one of the two; ``p`` are its constants."""

    def tension_rate(self, v: float, sigma: float, p: Any) -> float:
        """d(sigma_a)/dt, kPa/ms."""
        ...

    def relaxation(self, v: float, p: Any) -> tuple[float, float]:
        """Rate in 1/ms and target in kPa."""
        ...


def equation_of(tension_law: TensionLaw) -> TensionEquation:
    """The module that defines a tension law, and beside it its equation."""
    return cast(TensionEquation, sys.modules[type(tension_law).__module__])


def tension_rate(tension_law: TensionLaw, v: float, sigma: float) -> float:
    """d(sigma_a)/dt of any law in plain Python, kPa/ms."""
    equation, constants = equation_of(tension_law), tension_law.constants()
    if not tension_law.linear:
        return equation.tension_rate(v, sigma, constants)
    rate, target = equation.relaxation(v, constants)
    return rate * (target - sigma)
