"""Values of one field, as they are written on the command line.

A list of values, ``0.2,0.4,0.8``, of ranges, ``0:90:15`` or ``0:90:#7``, or of both; for sampling an
interval, ``10 um..30 um``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal

from pipeline.errors import InputError
from workflows.sweep.fields import Field, Scalar

_PART = r"[^:,\"'\[\]{}]+?"
RANGE = re.compile(rf"\s*({_PART})\s*:\s*({_PART})\s*:\s*(#\s*\d+|{_PART})\s*(:\s*log)?\s*")
INTERVAL = re.compile(rf"\s*({_PART})\s*\.\.\s*({_PART})\s*(:\s*log)?\s*")
UNIT = re.compile(r"\s*[+-]?(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\s*(?P<unit>.*?)\s*")

MOST = 1_000_000
"""Values of one range at most; more are a slip of the pen."""


@dataclass(frozen=True)
class Interval:
    """Where samples of a field are taken: between two ends, evenly or evenly in the logarithm."""

    low: float
    high: float
    log: bool

    def at(self, share: float, *, whole: bool) -> Scalar:
        """Value at a share from 0 to 1 of the way; a whole number of equal chance where only these do."""
        if whole:
            return min(
                int(self.low) + math.floor(share * (self.high - self.low + 1)), int(self.high)
            )
        if self.log:
            return self.low * (self.high / self.low) ** share
        return self.low + share * (self.high - self.low)


def values(field: Field, text: str, option: str, *, distinct: bool = True) -> tuple[Scalar, ...]:
    """All values that a text lists.

    Raises
    ------
    InputError
        If there are none, or one is wrong, or comes twice though all must be ``distinct``.
    """
    items = split(text)
    if not text.strip() or any(not item.strip() for item in items):
        raise InputError(
            f"{option} {field.path}={text}: there is nothing "
            f"{'to sweep over' if not text.strip() else 'between two commas'}; give values, as in "
            f"{field.path}=V1,V2 or {field.path}=FIRST:LAST:STEP"
        )
    found = [value for item in items for value in _item_values(field, item.strip(), option)]
    seen: set[Scalar] = set()
    for value in found:
        if distinct and value in seen:
            raise InputError(f"{option} {field.path}: the value {value} comes twice; give it once")
        seen.add(value)
    return tuple(found)


def interval(field: Field, text: str, option: str) -> Interval | None:
    """The interval that a text names; ``None`` if it names none.

    Raises
    ------
    InputError
        If it is empty, or the field takes no numbers.
    """
    match = INTERVAL.fullmatch(text)
    if match is None:
        return None
    about = f"{option} {field.path}={text}"
    low, high = _numbers(field, match.group(1, 2), about)
    if not low < high:
        raise InputError(f"{about}: the interval is empty; its first end must be the smaller one")
    log = match[3] is not None
    if log and not low > 0:
        raise InputError(f"{about}: a logarithm needs numbers above 0")
    if log and field.is_whole:
        raise InputError(f"{about}: {field.path} takes whole numbers, which have no log here")
    return Interval(low, high, log)


def split(text: str) -> list[str]:
    """Parts between commas, except inside quotes and brackets.

    Examples
    --------
    >>> split("0.2,0.4"), split('"a, b",[1, 2]')
    (['0.2', '0.4'], ['"a, b"', '[1, 2]'])
    """
    parts, depth, quote, start = [], 0, "", 0
    for i, letter in enumerate(text):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        elif letter in "[{(":
            depth += 1
        elif letter in "]})":
            depth -= 1
        elif letter == "," and depth <= 0:
            parts.append(text[start:i])
            start = i + 1
    return [*parts, text[start:]]


def _item_values(field: Field, item: str, option: str) -> Iterator[Scalar]:
    about = f"{option} {field.path}={item}"
    if item[0] not in "\"'[{" and not (field.takes_texts and not field.takes_numbers):
        if (match := RANGE.fullmatch(item)) is not None:
            yield from _range(field, match, about)
            return
        if ":" in item and not field.takes_texts:
            raise InputError(f"{about}: a range is FIRST:LAST:STEP or FIRST:LAST:#COUNT")
        if INTERVAL.fullmatch(item) is not None and not field.takes_texts:
            raise InputError(
                f"{about}: an interval is for samples: add --sample lhs:N, or give a range "
                "FIRST:LAST:STEP or FIRST:LAST:#COUNT"
            )
    yield field.value(item)


def _range(field: Field, match: re.Match[str], about: str) -> Iterator[Scalar]:
    """Numbers from first to last, which is one of them if the steps meet it."""
    log, third = match[4] is not None, match[3]
    if third.startswith("#"):
        count = third[1:].strip()
        if not count.isdecimal():
            raise InputError(f"{about}: {count!r} is no number of values; give one, such as #5")
        first, last = _numbers(field, match.group(1, 2), about)
        return (_fitting(field, v, about) for v in _spaced(first, last, int(count), log, about))
    if log:
        raise InputError(f"{about}: a range with :log needs a count, FIRST:LAST:#COUNT:log")
    first, last, step = _numbers(field, match.group(1, 2, 3), about)
    return (_fitting(field, v, about) for v in _stepped(first, last, step, about))


def _stepped(first: float, last: float, step: float, about: str) -> Iterator[float]:
    if step == 0:
        raise InputError(f"{about}: the step is 0")
    start, exact = Decimal(repr(first)), Decimal(repr(step))
    count = math.floor((Decimal(repr(last)) - start) / exact + Decimal("1e-9")) + 1
    if count < 1:
        raise InputError(
            f"{about}: the range is empty: steps of {step:g} do not lead from {first:g} to {last:g}"
        )
    _refuse_too_many(count, about)
    return (float(start + i * exact) for i in range(count))


def _spaced(first: float, last: float, count: int, log: bool, about: str) -> Iterator[float]:
    if count < 1:
        raise InputError(f"{about}: the range is empty: it is to have {count} values")
    if first == last or count == 1:
        raise InputError(
            f"{about}: a range with a count needs two different ends and two values at least"
        )
    if log and not min(first, last) > 0:
        raise InputError(f"{about}: a logarithm needs numbers above 0")
    _refuse_too_many(count, about)
    if log:
        return (
            last if i == count - 1 else first * (last / first) ** (i / (count - 1))
            for i in range(count)
        )
    start, way = Decimal(repr(first)), Decimal(repr(last)) - Decimal(repr(first))
    return (float(start + way * i / (count - 1)) for i in range(count))


def _refuse_too_many(count: int, about: str) -> None:
    if count > MOST:
        raise InputError(f"{about}: these are {count} values, and {MOST} are the most")


def _fitting(field: Field, value: float, about: str) -> Scalar:
    if not field.is_whole:
        return value
    if not value.is_integer():
        raise InputError(f"{about}: {field.path} takes whole numbers, and {value:g} is none")
    return int(value)


def _numbers(field: Field, texts: Sequence[str], about: str) -> list[float]:
    """Numbers in the field's unit; a unit that only one of them has holds for all."""
    units = {match["unit"] for text in texts if (match := UNIT.fullmatch(text))} - {""}
    numbers = []
    for text in texts:
        match = UNIT.fullmatch(text)
        bare = match is not None and not match["unit"]
        value = field.value(f"{text} {next(iter(units))}" if bare and len(units) == 1 else text)
        if isinstance(value, bool | str) or not math.isfinite(value):
            raise InputError(f"{about}: {text.strip()!r} is no number, which a range needs")
        numbers.append(float(value))
    return numbers
