"""Memory of bounded size."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable
from typing import Generic, TypeVar

V = TypeVar("V")


class Recent(Generic[V]):
    """Values by key; those that were added or asked for longest ago are forgotten.

    Parameters
    ----------
    size
        Number of values that are kept.

    Examples
    --------
    >>> squares = Recent(2)
    >>> for number in (1, 2, 3):
    ...     squares.add(number, number**2)
    >>> squares.get(1), squares.get(2), squares.get(3)
    (None, 4, 9)
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._values: OrderedDict[Hashable, V] = OrderedDict()

    def add(self, key: Hashable, value: V) -> None:
        """Remember a value."""
        self._values[key] = value
        self._values.move_to_end(key)
        if len(self._values) > self._size:
            self._values.popitem(last=False)

    def get(self, key: Hashable) -> V | None:
        """The value of a key, ``None`` if there is none."""
        if key in self._values:
            self._values.move_to_end(key)
        return self._values.get(key)
