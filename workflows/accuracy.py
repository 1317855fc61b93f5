"""Mesh, step and scheme of the cells from a preset or from an accuracy, by a measured table.

The table counts spans per width of the front and steps per rise of the potential, so that it serves
films of any size and cells of any model: the error of an activation time grows with the time for which
the front has run. Numbers are picked before anything is planned: however they were chosen, equal
ones give equal keys. Plain Python, for configurations are read with it.
"""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.front import Front, tissue_front

TABLE = Path(__file__).parent / "parameters" / "accuracy.toml"
DETOUR = 2.5
"""Straight ways across the film that a wave may take: round refractory tissue, and slowly in its tail."""
FORMATION = 2.0
"""Rise times that a front takes to form, in which errors arise, too."""
DRIVEN = 0.25
"""Steps by which the activation of cells is off that a pulse drives at once over the threshold."""
FEWEST = 4


@dataclass(frozen=True)
class MeasuredSetting:
    """One row of the table.

    Attributes
    ----------
    name
        Name as a preset; empty: it has none.
    scheme, degree
        As in the configuration.
    spans_per_front
        Knot spans in the width of the front (10 to 90 %).
    steps_per_rise
        Time steps in the time that the front takes to pass.
    error
        Largest error of activation times by mesh and step, in parts of the time for which the front has run.
    cost
        Computing time, relative to that of the published setting.
    """

    name: str
    scheme: str
    degree: int
    spans_per_front: float
    steps_per_rise: float
    error: float
    cost: float

    def largest_error(self, front: Front, length: float, width: float) -> float:
        """Error to expect at most on a film of that size, ms."""
        crossing = math.hypot(length, width) / front.speed
        travel = DETOUR * crossing + FORMATION * front.rise_time
        onset = DRIVEN * front.rise_time / self.steps_per_rise
        return max(self.error * travel, onset)


@cache
def measured_settings() -> tuple[MeasuredSetting, ...]:
    """All rows, the cheapest first."""
    rows = tomllib.loads(TABLE.read_text(encoding="utf-8"))["settings"]
    settings = (MeasuredSetting(**{"name": "", **row}) for row in rows)
    return tuple(sorted(settings, key=lambda setting: setting.cost))


def with_picked_setting(data: Any) -> Any:
    """Tables of a film with cells, with mesh, steps and scheme filled in where they are to be picked.

    Raises
    ------
    PydanticCustomError
        If a name is unknown, if no measured setting is as accurate, or if what is to be picked is given,
        too.
    """
    if not isinstance(data, Mapping) or not isinstance(data.get("electrophysiology"), Mapping):
        return data
    cells = dict(data["electrophysiology"])
    asked = [field for field in ElectrophysiologyConfig.picks if cells.get(field) is not None]
    if not asked:
        return data
    _refuse_contradictions(cells, asked)
    accuracy = cells.get("accuracy")
    if accuracy is not None and not (isinstance(accuracy, int | float) and accuracy > 0):
        return _unpicked(data, cells)
    try:
        length, width = (float(data["geometry"][side]) for side in ("length", "width"))
        numbers = _numbers_of(cells, asked[0], (length, width))
    except PydanticCustomError:  # nothing fits: a ValueError, but no mistake in the section
        raise
    except (ValidationError, KeyError, TypeError, ValueError):  # told where the section is read
        return _unpicked(data, cells)
    return {**data, "electrophysiology": {**cells, **numbers}}


def _numbers_of(
    cells: Mapping[str, Any], asked: str, sides: tuple[float, float]
) -> Mapping[str, Any]:
    """Fields that are picked; remembered, since many configurations may have the same cells."""
    known = json.dumps([cells, sides], default=repr)
    if known not in _PICKED:
        if len(_PICKED) >= REMEMBERED:
            _PICKED.clear()
        _PICKED[known] = _pick(cells, asked, sides)
    return _PICKED[known]


REMEMBERED = 1000
_PICKED: dict[str, Mapping[str, Any]] = {}


def _pick(cells: Mapping[str, Any], asked: str, sides: tuple[float, float]) -> Mapping[str, Any]:
    tissue = _tissue(cells)
    front = tissue_front(tissue)
    if front is None:
        raise PydanticCustomError(
            "no_front",
            "electrophysiology.{asked}: these cells carry no front by which a mesh could be picked; give "
            "elements, degree and n_steps",
            {"asked": asked},
        )
    return _numbers(_chosen(cells, front, *sides), front, tissue, sides)


def picked(config: Any) -> str | None:
    """What was picked, and by what, in words; none where nothing was."""
    cells = getattr(config, "electrophysiology", None)
    if not isinstance(cells, ElectrophysiologyConfig):
        return None
    if cells.preset is None and cells.accuracy is None:
        return None
    by = f"preset {cells.preset}" if cells.preset else f"accuracy {cells.accuracy:g} ms"
    along, across = cells.elements
    return (
        f"{by} picks {along} x {across} spans of degree {cells.degree}, {cells.n_steps} steps of "
        f"{cells.step:.4g} ms, {cells.scheme.name}"
    )


UNPICKED = {"elements": (FEWEST, FEWEST), "degree": 2, "n_steps": 10**9}
"""Stands in while the rest of the section is read."""


def _unpicked(data: Mapping[str, Any], cells: Mapping[str, Any]) -> dict[str, Any]:
    """Tables with a stand-in for what cannot be picked, since the section tells what is wrong in it."""
    return {**data, "electrophysiology": {**cells, **UNPICKED}}


def _tissue(cells: Mapping[str, Any]) -> ElectrophysiologyConfig:
    picking = set(ElectrophysiologyConfig.picks)
    rest = {name: value for name, value in cells.items() if name not in picking}
    return ElectrophysiologyConfig.model_validate({**rest, **UNPICKED})


def _refuse_contradictions(cells: Mapping[str, Any], asked: list[str]) -> None:
    for field in asked:
        for other in ElectrophysiologyConfig.picks[field]:
            if cells.get(other) is not None:
                raise PydanticCustomError(
                    "picked_and_given",
                    "electrophysiology.{field} picks elements, degree, n_steps and scheme; "
                    "electrophysiology.{other} is given, too: leave one of them out",
                    {"field": field, "other": other},
                )


def _chosen(cells: Mapping[str, Any], front: Front, length: float, width: float) -> MeasuredSetting:
    """Row of the preset, or the cheapest one that is accurate enough."""
    settings = measured_settings()
    preset, accuracy = cells.get("preset"), cells.get("accuracy")
    if preset is not None:
        named = {setting.name: setting for setting in settings if setting.name}
        if preset in named:
            return named[preset]
        near = get_close_matches(str(preset), named, n=1)
        raise PydanticCustomError(
            "unknown_preset",
            "electrophysiology.preset: no preset is called {name}{hint}; choose one of: {allowed}",
            {
                "name": repr(preset),
                "hint": f" (did you mean {near[0]!r}?)" if near else "",
                "allowed": ", ".join(named),
            },
        )
    assert isinstance(accuracy, int | float)
    for setting in settings:
        if setting.largest_error(front, length, width) <= accuracy:
            return setting
    best = min(setting.largest_error(front, length, width) for setting in settings)
    raise PydanticCustomError(
        "too_accurate",
        "electrophysiology.accuracy = {asked} ms: no measured setting is as accurate on this film; the "
        "best one reaches {best} ms. Ask for that, or give elements, degree, n_steps and scheme",
        {"asked": f"{accuracy:g}", "best": f"{_rounded_up(best):g}"},
    )


def _numbers(
    setting: MeasuredSetting,
    front: Front,
    tissue: ElectrophysiologyConfig,
    sides: tuple[float, float],
) -> dict[str, Any]:
    """Fields of the configuration."""
    spans = setting.spans_per_front / front.width
    longest = front.rise_time / setting.steps_per_rise
    return {
        "elements": tuple(max(math.ceil(side * spans - 1e-6), FEWEST) for side in sides),
        "degree": setting.degree,
        "scheme": setting.scheme,
        "n_steps": _steps(tissue, longest),
    }


def _steps(tissue: ElectrophysiologyConfig, longest: float) -> int:
    """Fewest steps of at most ``longest`` ms, so that stimuli begin and end between them if that is cheap."""
    common = 0
    for time in _times(tissue):
        common = math.gcd(common, round(time * 1e6))
    whole = math.ceil(common / 1e6 / longest - 1e-9)
    step = common / 1e6 / whole
    if step < 0.5 * longest:
        step = longest
    return math.ceil(tissue.duration / step - 1e-6)


def _times(tissue: ElectrophysiologyConfig) -> Iterator[float]:
    """Times that steps should meet, ms."""
    yield tissue.duration
    for stimulus in tissue.stimuli:
        for start in stimulus.starts:
            yield start
            yield start + stimulus.duration


def _rounded_up(value: float) -> float:
    """Two significant digits, not below ``value``."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit) * unit
