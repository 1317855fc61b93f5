"""What a time law is: a factor q(t) on a load or on an imposed activation."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from stages.configuration import OneOf, Section


class TimeLaw(Section):
    """Parameters of a time law, and its value at a time.

    A law's file holds a subclass of this, names it in ``MODEL`` and defines the method ``at``. It is
    plain Python, without NumPy: configurations stay light to read.
    """

    name: str

    def at(self, time: float) -> float:
        """Factor q at a time in ms, dimensionless."""
        raise TypeError(f"{type(self).__name__} does not say its value")


AnyTimeLaw: TypeAlias = Annotated[TimeLaw, OneOf("stages.time_laws", TimeLaw)]
"""A field that takes any time law, as a table or, where it has no parameters, by its name alone."""
