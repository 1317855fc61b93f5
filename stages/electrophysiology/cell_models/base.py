"""What a cell model is (eq. 10)."""

from __future__ import annotations

import sys
from typing import Any, ClassVar, NamedTuple, Protocol, cast

from stages.configuration import Section


class CellModel(Section):
    """Parameters of a cell model; its equations are plain functions beside the class.

    A cell model file holds a subclass of this with the methods below, names it in ``MODEL``, and
    defines at module level

    - ``ionic_current(v, s, p) -> float``: I_ion / C_m in mV/ms, outward positive (enters dv/dt with
      a minus sign);
    - ``state_rates(v, s, p) -> tuple[float, ...]``: ds/dt in 1/ms, as many as there are states;

    where ``v`` is the potential in mV in every model, ``s`` the tuple of the other variables and ``p``
    the named tuple that ``constants()`` returns. They are scalar Python; the solver compiles them into
    the loop over cells. Use ``stages.numerics.elementary.exp`` for exponentials, and ``a if c else b``
    rather than ``if`` blocks: then the loop becomes SIMD code.
    """

    functions: ClassVar[tuple[str, ...]] = ("ionic_current", "state_rates")
    """What the module must define beside the class."""

    name: str

    def constants(self) -> NamedTuple:
        """Parameters as the equations read them."""
        raise TypeError(f"{type(self).__name__} does not say its constants")

    def rest_potential(self) -> float:
        """Potential of a cell at rest, mV."""
        raise TypeError(f"{type(self).__name__} does not say its potential at rest")

    def initial_states(self) -> tuple[float, ...]:
        """The variables ``s`` of a cell at rest."""
        raise TypeError(f"{type(self).__name__} does not say its states at rest")


class CellEquations(Protocol):
    """The module of a cell model; ``p`` are its constants."""

    def ionic_current(self, v: float, s: tuple[float, ...], p: Any) -> float:
        """I_ion / C_m, mV/ms."""
        ...

    def state_rates(self, v: float, s: tuple[float, ...], p: Any) -> tuple[float, ...]:
        """ds/dt, 1/ms."""
        ...


def equations_of(cell_model: CellModel) -> CellEquations:
    """The module that defines a cell model, and beside it its equations."""
    return cast(CellEquations, sys.modules[type(cell_model).__module__])
