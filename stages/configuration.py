"""Building blocks of the configuration: sections, quantities with units, models chosen by name.

Everything here is light to import (no numpy): reading and checking a configuration must feel instant.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema


class Section(BaseModel):
    """One table of the configuration: every field declared, unknown ones refused, values immutable."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


def quantity(unit: str, description: str, source: str, **bounds: Any) -> Any:
    """Field with a physical unit; a number is read in that unit, a string may carry another one.

    Parameters
    ----------
    unit
        Unit of the stored number; ``""`` for a dimensionless one.
    description
        What the field means, in the field's standard terms.
    source
        Equation, table or section that the field comes from.
    bounds
        Anything that :func:`pydantic.Field` accepts (``gt``, ``ge``, ``lt``, ``default``, ...).

    Notes
    -----
    Physical numbers have no default here: the paper's values live in ``workflows/parameters``.
    """
    return Field(
        description=description, json_schema_extra={"unit": unit, "source": source}, **bounds
    )


def setting(description: str, source: str = "numerical setting", **bounds: Any) -> Any:
    """Field without a physical dimension: a count, a name, a tolerance."""
    return quantity("", description, source, **bounds)


def unkeyed(description: str, unit: str = "", **bounds: Any) -> Any:
    """Field that cannot change a result and therefore never enters a key."""
    return Field(
        description=description,
        json_schema_extra={"unit": unit, "source": "does not change results", "keyed": False},
        **bounds,
    )


class OneOf:
    """Annotation for a model that is picked by its ``name`` from a folder of one-file models.

    Where tables call it otherwise, ``tag`` says how: ``kind`` for supports and loads, whose names are
    the labels that the user gives them. ``library`` names the field beside it that holds named sets of
    parameters; the name of a set, and a table with that name and some parameters, then do as well.

    ``Annotated[Material, OneOf("stages.mechanics.materials", Material)]`` accepts an instance of
    ``Material`` or a table ``{"name": "neo-hookean", ...}``. The file ``neo_hookean.py`` of that
    package is imported, and only that one; it names its class in ``MODEL``. A new model is therefore
    one new file, and a stage's code fingerprint covers the chosen model alone.
    """

    def __init__(
        self, package: str, base: type[Section], tag: str = "name", library: str | None = None
    ) -> None:
        self.package = package
        self.base = base
        self.tag = tag
        self.library = library

    def names(self) -> list[str]:
        """Names on offer, in alphabetical order."""
        folder = importlib.import_module(self.package)
        return sorted(
            module.name.replace("_", "-")
            for module in pkgutil.iter_modules(folder.__path__)
            if not module.name.startswith("_") and module.name != "base"
        )

    def load(self, name: str) -> type[Section]:
        """Model class of that name; a ``PydanticCustomError`` lists the valid names otherwise."""
        if name not in self.names():
            raise PydanticCustomError(
                "unknown_name",
                "no model is called {name}; choose one of: {allowed}",
                {"name": repr(name), "given": name, "allowed": ", ".join(self.names())},
            )
        module = importlib.import_module(f"{self.package}.{name.replace('-', '_')}")
        for wrong in self._defects(module, name):
            raise PydanticCustomError(
                "bad_model",
                "the model file {file} {wrong}",
                {"file": module.__file__, "wrong": wrong},
            )
        model: type[Section] = module.MODEL
        return model

    def _defects(self, module: ModuleType, name: str) -> Iterator[str]:
        """What keeps a file from being a model, in words."""
        model = getattr(module, "MODEL", None)
        if not (isinstance(model, type) and issubclass(model, self.base)):
            yield f"must set MODEL to its subclass of {self.base.__name__}"
            return
        field = model.model_fields[self.tag]
        if field.default != name:
            yield f'must declare {self.tag}: Literal["{name}"] = "{name}", after the file'
        for function in getattr(model, "functions", ()):
            if not callable(getattr(module, function, None)):
                yield f"must define the function {function}"

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def _validate(self, value: Any) -> Section:
        if isinstance(value, self.base):
            return value
        if isinstance(value, str):
            value = {self.tag: value}
        if not isinstance(value, dict) or not isinstance(value.get(self.tag), str):
            raise PydanticCustomError(
                "needs_name",
                "expected a table with a {tag}; choose one of: {allowed}",
                {"tag": self.tag, "allowed": ", ".join(self.names())},
            )
        return self.load(value[self.tag]).model_validate(value)


Count = Annotated[int, Field(ge=1, le=100_000)]
"""A whole number of things of which there is at least one (and not more than can be meant)."""

Edge = Literal["X=0", "X=L1", "Y=0", "Y=L2"]
"""The four edges of a patch: first or second parametric direction at its start or its end."""
