"""What a tension law is (eq. 11)."""

from __future__ import annotations

from typing import ClassVar, NamedTuple

from stages.configuration import Section


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


class LinearTensionLaw(TensionLaw):
    """A law d(sigma_a)/dt = rate (target - sigma_a) whose two numbers depend on the potential alone.

    Its file defines ``relaxation(v, p) -> (rate, target)`` instead, in 1/ms and kPa. They are evaluated
    once per potential, not once per stage of the Runge-Kutta step.
    """

    linear: ClassVar[bool] = True
    functions: ClassVar[tuple[str, ...]] = ("relaxation",)
