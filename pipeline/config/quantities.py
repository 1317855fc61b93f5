"""Quantities with units, converted where a table enters the program."""

from __future__ import annotations

import re
from collections.abc import Mapping
from decimal import Decimal
from functools import cache, lru_cache
from typing import Any, Literal

from pydantic import BaseModel

from pipeline.config.fields import Declared

QUANTITY = re.compile(
    r"""\s*(?P<number>[+-]?(\d+(_\d+)*\.?\d*|\.\d+)([eE][+-]?\d+)?)
        \s*(?P<unit>[^\d\s][^\d]*(\d[^\d]*)*|1\s*/.+)\s*""",
    re.VERBOSE,
)


class NoQuantity(ValueError):  # noqa: N818 - the reason why a text is no quantity
    """A text is no quantity of the dimension that is expected."""


def converted(
    model: type[BaseModel], data: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, str]]:
    """Table with every quantity as a number in its field's unit, and with tuples where declared.

    The second value tells, by dotted name, of the texts that are no quantity of the dimension
    expected; they are left as they are.
    """
    problems: dict[str, str] = {}
    return _convert(data, Declared(model), "", problems), problems


@lru_cache(maxsize=4096)
def to_unit(text: str, unit: str) -> float:
    """Number in a unit, from a text such as ``"18 um"``.

    Decimal arithmetic makes ``"18 um"`` the same number as ``0.018``.

    Raises
    ------
    NoQuantity
        If the text is not a number with a unit, or of another dimension.

    Examples
    --------
    >>> to_unit("18 um", "mm")
    0.018
    >>> to_unit("800 / s", "1/ms")
    0.8
    """
    match = QUANTITY.fullmatch(text)
    if match is None:
        raise NoQuantity("it is not a number with a unit (a bare number stands without quotes)")
    import pint

    try:
        units = _registry()
        divisor = match["unit"].startswith("/")  # "0.8/ms"
        unit_given = units.parse_units(f"1{match['unit']}" if divisor else match["unit"])
        quantity = units.Quantity(Decimal(match["number"]), unit_given)
        return float(quantity.to(unit).magnitude)
    except pint.DimensionalityError as error:
        raise NoQuantity(f"{match['unit']!r} has another dimension") from error
    except Exception as error:  # the unit parser raises many kinds, AssertionError included
        raise NoQuantity(f"the unit {match['unit']!r} is not known") from error


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Decimal, cache_folder=None)


def _convert(data: Any, declared: Declared, path: str, problems: dict[str, str]) -> Any:
    if isinstance(data, Mapping):
        model = declared.model(data)
        result = {}
        for name, value in data.items():
            inner = declared.item(name) if model is None else Declared.of(model, name)
            place = f"{path}.{name}".lstrip(".")
            result[name] = value if inner is None else _convert(value, inner, place, problems)
        return result
    if isinstance(data, list | tuple):
        items = [
            _convert(value, declared.item(i), f"{path}.{i}", problems)
            for i, value in enumerate(data)
        ]
        return tuple(items) if tuple in declared.origins() else items
    if isinstance(data, str) and declared.unit and data not in declared.literals():
        return _number(data, declared, path, problems)
    return data


def _number(text: str, declared: Declared, path: str, problems: dict[str, str]) -> Any:
    try:
        value = to_unit(text, declared.unit)
    except NoQuantity as reason:
        if not {str, Literal} & set(declared.origins()):  # no other text is allowed
            problems[path] = (
                f'{path} = "{text}": expected a number in {declared.unit}, or a text with a unit '
                f"that converts to {declared.unit}; {reason}"
            )
        return text
    whole = float not in declared.origins() and value.is_integer()
    return int(value) if whole else value
