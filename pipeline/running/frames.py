"""Shapes and types of the frames of a streamed record, and the checks they must pass."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pipeline.annotations import field_hints
from pipeline.codecs.tree import as_stored
from pipeline.records import field_metadata

R = TypeVar("R")


@dataclass(frozen=True)
class FrameShapes(Generic[R]):
    """``count`` frames of the streamed fields of a record, or, with ``fewer``, as many at most.

    Raises
    ------
    ValueError
        If a field named in ``shapes`` is not one whose first axis is ``"time"``, or the count is
        negative.
    """

    record: type[R]
    count: int
    shapes: Mapping[str, tuple[int, ...]]
    fewer: bool = False

    def __post_init__(self) -> None:
        timed = [
            name
            for name, _, extra in field_hints(self.record)
            if tuple(extra.get("axes", ()))[:1] == ("time",)
        ]
        if wrong := sorted(self.shapes.keys() - set(timed)):
            raise ValueError(
                f"{self.record.__name__} cannot stream {wrong[0]!r}: its fields with the first "
                f"axis 'time' are {', '.join(timed) or 'none'}"
            )
        if self.count < 0:
            raise ValueError(f"a history of {self.count} frames")

    def checked(self, fields: Mapping[str, ArrayLike], done: int) -> dict[str, NDArray[Any]]:
        """One frame as arrays of the stored type."""
        if fields.keys() != self.shapes.keys():
            raise ValueError(
                f"a frame of {self.record.__name__} holds {', '.join(self.shapes)}; "
                f"got {', '.join(fields) or 'nothing'}"
            )
        if done >= self.count:
            raise ValueError(f"{self.record.__name__} was announced with {self.count} frames")
        frame = {}
        for name, value in fields.items():
            array = np.asarray(value)
            if array.shape != tuple(self.shapes[name]):
                raise ValueError(
                    f"frame {done} of {name!r} has shape {array.shape}, announced "
                    f"{tuple(self.shapes[name])}"
                )
            frame[name] = as_stored(array, self.dtype(name, array))
        return frame

    def dtype(self, name: str, array: NDArray[Any] | None = None) -> np.dtype[Any]:
        """Stored type of a field: the declared one, else the array's own."""
        own = np.dtype(np.float64) if array is None else array.dtype
        declared: np.dtype[Any] = np.dtype(field_metadata(self.record, name).get("stored") or own)
        return declared

    def check_finished(self, done: int, fields: Mapping[str, Any]) -> None:
        """Raise ``ValueError`` unless all frames are there and the other fields are the right ones."""
        if done != self.count and not (self.fewer and 0 < done < self.count):
            raise ValueError(
                f"{self.record.__name__} ends after {done} of the {self.count} frames announced"
            )
        record: Any = self.record
        others = [f for f in dataclasses.fields(record) if f.init and f.name not in self.shapes]
        needed = {f.name for f in others if f.default is f.default_factory is dataclasses.MISSING}
        if not needed <= fields.keys() <= {f.name for f in others}:
            raise ValueError(
                f"to finish {self.record.__name__}, give {', '.join(sorted(needed)) or 'nothing'}"
                f"; got {', '.join(sorted(fields)) or 'nothing'}"
            )
