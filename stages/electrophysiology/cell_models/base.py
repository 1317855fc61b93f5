"""What a cell model is (eq. 10)."""

from __future__ import annotations

from typing import ClassVar, NamedTuple

from stages.configuration import Section


class CellModel(Section):
    """Parameters of a cell model; its equations are plain functions beside the class.

    A cell model file holds a subclass of this that also declares where ``initial_recovery`` comes
    from, names it in ``MODEL``, and defines at module level

    - ``ionic_current(v, w, p) -> float``: I_ion / C_m in mV/ms, outward positive (enters dv/dt with
      a minus sign);
    - ``recovery_rate(v, w, p) -> float``: dw/dt in 1/ms;

    where ``v`` is the potential in mV, ``w`` the recovery variable and ``p`` the named tuple that
    ``constants()`` returns. They are scalar Python; the solver compiles them. Use
    ``stages.numerics.elementary.exp`` for exponentials.
    """

    functions: ClassVar[tuple[str, ...]] = ("ionic_current", "recovery_rate")
    """What the module must define beside the class."""

    name: str
    initial_recovery: float

    def constants(self) -> NamedTuple:
        """Parameters as the equations read them."""
        raise TypeError(f"{type(self).__name__} does not say its constants")
