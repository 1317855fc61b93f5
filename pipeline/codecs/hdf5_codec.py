"""HDF5 codec: one file per record, written once, without time stamps."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import h5py
import numpy as np
from numpy.typing import NDArray

from pipeline.codecs import tree

R = TypeVar("R")

DESCRIPTION = "description"


def save(path: Path, record: Any) -> None:
    """Write a record as a file.

    HDF5 builds it in memory: a full disk then fails in our own writing, as an ``OSError``. Inside HDF5
    it fails at some flush or close, with whatever exception and message that leads to. Publishing forces
    it to the disk, with all else.
    """
    with h5py.File(path.name, "w", driver="core", backing_store=False) as file:
        tree.write(record, _Writer(file))
        file.flush()
        image = file.id.get_file_image()
    path.write_bytes(image)


def load(path: Path, record: type[R], checksums: Mapping[str, str]) -> R:
    """Record of a file, its arrays in memory; the file is one whole, which the caller has checked."""
    with h5py.File(path, "r") as file:
        return tree.read(record, _Reader(file))


@dataclass(frozen=True)
class _Writer:
    place: Any

    def array(self, name: str, values: NDArray[Any], unit: str, axes: tuple[str, ...]) -> None:
        dataset = self.place.create_dataset(name, data=values, track_times=False)
        if unit:
            dataset.attrs["unit"] = unit
        for i, axis in enumerate(axes):
            dataset.dims[i].label = axis

    def group(self, name: str) -> _Writer:
        return _Writer(self.place.create_group(name))

    def describe(self, description: Mapping[str, Any]) -> None:
        # A data set, because an attribute is limited to 64 kB.
        text = np.bytes_(json.dumps(description, ensure_ascii=True))
        self.place.create_dataset(f"_{DESCRIPTION}", data=text, track_times=False)


@dataclass(frozen=True)
class _Reader:
    place: Any

    def array(self, name: str) -> NDArray[Any]:
        values: NDArray[Any] = np.asarray(self.place[name][()])
        return values

    def group(self, name: str) -> _Reader:
        return _Reader(self.place[name])

    def description(self) -> Mapping[str, Any]:
        described: dict[str, Any] = json.loads(bytes(self.place[f"_{DESCRIPTION}"][()]))
        return described
