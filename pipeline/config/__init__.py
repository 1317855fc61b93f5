"""From TOML tables, ``--set`` strings and units to one validated configuration.

Examples
--------
>>> from pydantic import BaseModel, Field
>>> class Film(BaseModel):
...     thickness: float = Field(gt=0, json_schema_extra={"unit": "mm"})
>>> load(Film, [{"thickness": 1}], ["thickness=18 um"])
Film(thickness=0.018)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from pipeline.config.layers import overridden, read_toml
from pipeline.config.libraries import expanded
from pipeline.config.parameters import Parameter, describe
from pipeline.config.picks import laid_over
from pipeline.config.problems import told
from pipeline.config.quantities import converted
from pipeline.errors import InputError

__all__ = ["Parameter", "describe", "load", "read_toml"]

M = TypeVar("M", bound=BaseModel)


def load(model: type[M], layers: Sequence[Mapping[str, Any]], overrides: Sequence[str] = ()) -> M:
    """Configuration from tables of growing precedence, and overrides above them all.

    Parameters
    ----------
    model
        Model of the whole configuration.
    layers
        Tables; in a later one values replace those of an earlier one, and a table whose ``name``
        differs replaces the whole earlier table, because it selects another model. A field that picks
        others (:mod:`pipeline.config.picks`) takes away what earlier tables say of these.
    overrides
        Strings ``SECTION.KEY=VALUE``; the value is TOML if it is valid TOML, else a string.

    Raises
    ------
    InputError
        Naming every problem: field, value, what is allowed, the nearest valid name.
    """
    data, problems = expanded(model, laid_over(model, (*layers, overridden({}, overrides))))
    data, unread = converted(model, data)
    problems |= unread
    try:
        config = model.model_validate(data)
    except ValidationError as error:
        raise InputError(_listed(told(model, data, error, problems))) from error
    if problems:
        raise InputError(_listed(list(problems.values())))
    return config


def _listed(problems: Sequence[str]) -> str:
    if len(problems) == 1:
        return problems[0]
    return "\n".join([f"{len(problems)} problems in the configuration:", *problems])
