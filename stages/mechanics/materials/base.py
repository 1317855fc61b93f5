"""What a material is: a free energy, and how the film's thickness follows from its strain in plane.

A film is in plane stress, S^33 = 0. What the shell needs of any law is therefore its *plane* energy w, a
function of the strain E_ab in the film's plane alone, through the three quantities

    trace = 2 G^ab E_ab,    det = 4 det E_ab / det G_ab,    fibre = 2 f0^a E_ab f0^b.

They vanish at rest and are formed from the strain itself, so that small strains lose no digits. The
invariants of C_ab in the plane are t = 2 + trace, j = 1 + trace + det = J0^2, and lambda_f^2 = 1 + fibre.

A law comes in one of two forms. For an :class:`Incompressible` solid it is psi(I1, I2, I4), and
:mod:`stages.mechanics.shell.plane_stress` makes w of it once for all. A :class:`PlaneStress` law gives w itself,
which is the way for solids that change their volume. One fibre family is provided for.
"""

from __future__ import annotations

import sys
from typing import Any, ClassVar, NamedTuple, Protocol, TypeAlias, cast

from stages.configuration import Section, quantity

Gradient: TypeAlias = tuple[float, float, float]
"""First derivatives with respect to the three arguments, kPa."""

Hessian: TypeAlias = tuple[float, float, float, float, float, float]
"""Second derivatives 11, 12, 13, 22, 23, 33 with respect to the three arguments, kPa."""


class Material(Section):
    """Parameters of a material; its law is plain functions beside the class.

    A material file holds a subclass of :class:`Incompressible` or :class:`PlaneStress`, names it in
    ``MODEL``, and defines the functions of that form at module level. They are scalar Python, compiled
    by the solver; ``p`` is the named tuple that ``constants()`` returns. Use ``exp`` and ``expm1`` of
    ``stages.numerics.elementary``, the latter where a stress has to vanish at rest.
    """

    functions: ClassVar[tuple[str, ...]] = ("energy", "gradient", "hessian")
    """What the module must define beside the class."""

    name: str
    density: float = quantity("mg/mm^3", "mass density", "Table 1, eq. 104", gt=0)

    def constants(self) -> NamedTuple:
        """Parameters as the law reads them."""
        raise TypeError(f"{type(self).__name__} does not say its constants")


class Incompressible(Material):
    """A solid of constant volume: psi of x1 = I1 - 3, x2 = I2 - 3 and x4 = I4 - 1.

    - ``energy(x1, x2, x4, p) -> float``: psi, kPa, zero at rest;
    - ``gradient(x1, x2, x4, p) -> Gradient``;
    - ``hessian(x1, x2, x4, p) -> Hessian``;

    with I1 = tr C, I2 = (I1^2 - tr C^2)/2 and I4 = f0 . C f0. At rest the part in I1 and I2 is free of
    stress by incompressibility; psi_4 has to be zero there.
    """


class PlaneStress(Material):
    """A solid given by its plane energy w(trace, det, fibre), S^33 = 0 being solved already.

    - ``energy(trace, det, fibre, p) -> float``: w, kPa, zero at rest;
    - ``gradient(trace, det, fibre, p) -> Gradient``: the first and third are zero at rest;
    - ``hessian(trace, det, fibre, p) -> Hessian``;
    - ``thickness_stretch(trace, det, fibre, p) -> float``: lambda_3 that goes with it.
    """

    functions: ClassVar[tuple[str, ...]] = (*Material.functions, "thickness_stretch")


class MaterialLaw(Protocol):
    """The module of a material: scalar functions of three arguments; ``p`` are its constants."""

    MODEL: ClassVar[type[Material]]

    def energy(self, a: float, b: float, c: float, p: Any) -> float:
        """Energy per reference volume, kPa."""
        ...

    def gradient(self, a: float, b: float, c: float, p: Any) -> Gradient:
        """Its first derivatives."""
        ...

    def hessian(self, a: float, b: float, c: float, p: Any) -> Hessian:
        """Its second derivatives."""
        ...


def law_of(material: type[Material]) -> MaterialLaw:
    """The module that defines a material, and beside it its law."""
    return cast(MaterialLaw, sys.modules[material.__module__])
