"""What a material is (eqs. 36, 88, 91): an incompressible free energy of three invariants.

The interface covers incompressible solids with one fibre family: psi(I1, I2, I4). A second family, or a
volume that changes, needs more invariants and another elimination of the thickness strain.
"""

from __future__ import annotations

import sys
from typing import Any, ClassVar, NamedTuple, Protocol, TypeAlias, cast

from stages.configuration import Section, quantity

Gradient: TypeAlias = tuple[float, float, float]
"""(psi_1, psi_2, psi_4): derivatives of psi with respect to I1, I2 and I4, kPa."""

Hessian: TypeAlias = tuple[float, float, float, float, float, float]
"""(psi_11, psi_12, psi_14, psi_22, psi_24, psi_44), kPa."""


class Material(Section):
    """Parameters of an incompressible material; its law is three plain functions beside the class.

    A material file holds a subclass of this, names it in ``MODEL``, and defines at module level

    - ``energy(i1, i2, i4, p) -> float``: psi, kPa;
    - ``gradient(i1, i2, i4, p) -> Gradient``;
    - ``hessian(i1, i2, i4, p) -> Hessian``;

    where I1 = tr C, I2 = (I1^2 - tr C^2)/2, I4 = f0 . C f0 is the squared fibre stretch, and ``p`` is
    the named tuple that ``constants()`` returns. They are scalar Python; the solver compiles them and
    eliminates the thickness strain (``stages.mechanics.plane_stress``). Use
    ``stages.numerics.elementary.exp`` for exponentials. At rest (3, 3, 1) the stress has to vanish:
    the part in I1 and I2 does so by incompressibility, psi_4 has to be zero there.
    """

    functions: ClassVar[tuple[str, ...]] = ("energy", "gradient", "hessian")
    """What the module must define beside the class."""

    name: str
    density: float = quantity("mg/mm^3", "mass density", "Table 1, eq. 104", gt=0)

    def constants(self) -> NamedTuple:
        """Parameters as the law reads them."""
        raise TypeError(f"{type(self).__name__} does not say its constants")


class MaterialLaw(Protocol):
    """The module of a material: scalar functions of the invariants; ``p`` are its constants."""

    MODEL: ClassVar[type[Material]]

    def energy(self, i1: float, i2: float, i4: float, p: Any) -> float:
        """psi, kPa."""
        ...

    def gradient(self, i1: float, i2: float, i4: float, p: Any) -> Gradient:
        """Its first derivatives."""
        ...

    def hessian(self, i1: float, i2: float, i4: float, p: Any) -> Hessian:
        """Its second derivatives."""
        ...


def law_of(material: type[Material]) -> MaterialLaw:
    """The module that defines a material, and beside it its law."""
    return cast(MaterialLaw, sys.modules[material.__module__])
