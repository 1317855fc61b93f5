"""The result of a node, as whoever asked for it gets it: known by name, loaded on demand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.computing.obtaining import Obtained
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.store import Store


@dataclass(frozen=True)
class Outcome:
    """Result of a node.

    Attributes
    ----------
    node
        Its name.
    obtained
        What is known of it without looking into the store.
    """

    node: str
    obtained: Obtained
    store: Store
    record: type

    @property
    def stage(self) -> str:
        """Name of the stage."""
        return self.obtained.stage

    @property
    def key(self) -> str:
        """Key of the result."""
        return self.obtained.key

    @property
    def hit(self) -> bool:
        """Whether it was in the store already."""
        return self.obtained.hit

    @property
    def ref(self) -> Ref:
        """Name of the result in the store."""
        return Ref(self.stage, self.key)

    @property
    def seconds(self) -> float:
        """Duration of the computation, whenever it took place."""
        return self.obtained.seconds

    @property
    def size(self) -> int:
        """Bytes of all data files."""
        return self.obtained.size

    @property
    def parts(self) -> Mapping[str, str]:
        """Content id of each part."""
        return self.obtained.parts

    @property
    def content(self) -> str:
        """Content id of the whole."""
        return self.obtained.content

    @property
    def manifest(self) -> Manifest:
        """All that is known about it, read from the store.

        Raises
        ------
        StoreError
            If it is there no longer.
        """
        return self.store.manifest(self.ref)

    def load(self, part: str | None = None) -> Any:
        """The record, or one part of it.

        Raises
        ------
        StoreError
            If it cannot be read or is damaged.
        """
        from pipeline.computing.loading import load_result

        return load_result(self.store, self.ref, self.record, part)
