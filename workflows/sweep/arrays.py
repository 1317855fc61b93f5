"""A sweep as arrays that xarray opens: swept parameters are coordinates, quantities are variables.

``xarray.open_zarr("sweep.zarr")``: where every field changes by itself, quantities have a dimension per
field, whose coordinate is the field's values; else there is one dimension ``case``.
"""

from __future__ import annotations

import contextlib
import errno
import math
import os
import shutil
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from stages.numerics.bsplines import Array
from workflows.exports.files import ExportError
from workflows.sweep.results import Column, Results
from workflows.unfinished import temporary_sibling
from workflows.workflow import Quantity

ITEM = "item"
"""Dimension along quantities that are lists, such as one value per beat; NaN beyond the end."""


def write_arrays(results: Results, path: Path) -> None:
    """Write the group, in place of an earlier one.

    Raises
    ------
    ExportError
        If it cannot be written.
    """
    temporary = temporary_sibling(path)
    former = temporary.with_suffix(".former")
    try:
        with warnings.catch_warnings():  # texts have no place in the zarr 3 specification yet
            warnings.filterwarnings("ignore", message=".*(Zarr V3|Zarr format 3) specification.*")
            _write(results, temporary)
            zarr.consolidate_metadata(temporary)  # never stale: the whole is always written anew
        _exchange(temporary, path, former)
    except OSError as error:
        raise ExportError(path, (error.strerror or str(error)).lower()) from error
    finally:
        for folder in (temporary, former):
            shutil.rmtree(folder, ignore_errors=True)


def _exchange(new: Path, path: Path, former: Path) -> None:
    """Put a folder in the place of another; sweeps into the same folder may do so at the same time."""
    while True:
        with contextlib.suppress(FileNotFoundError):
            os.rename(path, former)
        try:
            os.rename(new, path)
        except OSError as error:
            if error.errno not in (errno.EEXIST, errno.ENOTEMPTY):
                raise
            shutil.rmtree(former, ignore_errors=True)  # another one was quicker: ours is later
        else:
            return


def _write(results: Results, path: Path) -> None:
    design = results.study.design
    shape: tuple[int, ...] = design.shape if design.is_grid else (len(design),)
    names = [field.path for field in design.fields] if design.is_grid else ["case"]
    group = zarr.open_group(path, mode="w", zarr_format=3)
    group.attrs.put(
        {"workflow": results.study.workflow.name, "title": results.study.workflow.title}
    )
    parameters = results.parameters()
    if design.is_grid:
        for block, column in zip(design.blocks, parameters, strict=True):
            axis = Column(column.name, column.unit, [row[0] for row in block.rows])
            _add(group, column.name, _values(axis), [column.name], _about(column))
    else:
        cases = [design.name(number) for number in range(len(design))]
        _add(group, "case", _texts(cases), ["case"], {})
        for column in parameters:
            _add(group, column.name, _values(column), ["case"], _about(column))
    shared = {} if design.is_grid else {"coordinates": " ".join(c.name for c in parameters)}
    done = np.reshape([status == "done" for status in results.statuses], shape)
    _add(group, "done", done, names, {"long_name": "whether the case is done", **shared})
    lists = results.lists()
    longest = max((length or 0 for _, length in lists.values()), default=0)
    for name, (quantity, length) in lists.items():
        about = _about(quantity) | shared
        values = _quantity(results, name, None if length is None else longest)
        items = [] if length is None else [ITEM]
        _add(group, name, values.reshape((*shape, *values.shape[1:])), [*names, *items], about)


def _quantity(results: Results, name: str, items: int | None) -> Array:
    """Values by case, ``(case,)`` or ``(case, item)``."""
    count = len(results.study.design)
    values = np.full((count,) if items is None else (count, items), np.nan)
    for number, quantities in results.quantities.items():
        value = quantities[name].value if name in quantities else None
        found = value if isinstance(value, list) else [value]
        numbers = [math.nan if one is None else one for one in found]
        if items is None:
            values[number] = numbers[0]
        else:
            values[number, : len(numbers)] = numbers
    return values


def _about(one: Column | Quantity) -> dict[str, str]:
    return {"units": one.unit or "1", "long_name": one.meaning}


def _values(column: Column) -> Any:
    if column.is_numeric:
        whole = all(isinstance(cell, int) for cell in column.cells)
        return np.array(column.cells if whole else column.numbers)
    if all(isinstance(cell, bool) for cell in column.cells):
        return np.array(column.cells)
    return _texts(["" if cell is None else str(cell) for cell in column.cells])


def _texts(texts: list[str]) -> Any:
    return np.array(texts, dtype=np.dtypes.StringDType())


def _add(
    group: zarr.Group, name: str, values: Any, dimensions: list[str], about: Mapping[str, str]
) -> None:
    array = group.create_array(
        name, shape=values.shape, dtype=values.dtype, dimension_names=dimensions
    )
    array[...] = values
    array.attrs.put({key: text for key, text in about.items() if text})
