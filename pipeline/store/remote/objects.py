"""What a store needs of a place for objects, whatever serves it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol


@dataclass(frozen=True)
class Entry:
    """What a listing tells of an object.

    Attributes
    ----------
    size
        Bytes.
    modified
        When it was written, by the clock of the server; seconds since 1970.
    version
        Changes when the object is written again.
    """

    size: int
    modified: float
    version: str


class Objects(Protocol):
    """Objects by path below a URL, each written as a whole.

    Whoever reads an object after it was written sees all of what was written last, and listings
    contain it. Any method raises ``StoreError`` if the place cannot be reached or refuses.
    """

    @property
    def location(self) -> str:
        """URL."""
        ...

    def be_patient(self) -> None:
        """From now on, ride out interruptions of some seconds: work would be lost by giving up."""
        ...

    def check_place(self) -> None:
        """Raise ``StoreError`` unless there could be objects here: a bucket must be there before."""
        ...

    def read(self, path: str) -> bytes | None:
        """Contents of an object, ``None`` if there is none."""
        ...

    def read_many(self, paths: Iterable[str]) -> dict[str, bytes]:
        """Contents of several objects at once; those that are not there are left out."""
        ...

    def write(self, contents: Mapping[str, bytes]) -> None:
        """Write objects, or replace them."""
        ...

    def create(self, path: str, contents: bytes) -> bool:
        """Write an object unless there is one; gives whether it was written.

        Of several processes that try at once, one succeeds.
        """
        ...

    def listing(self, folder: str) -> dict[str, Entry]:
        """All objects below a folder, however deep, by their path."""
        ...

    def upload(self, files: Mapping[str, Path]) -> None:
        """Write objects from files."""
        ...

    def download(self, files: Mapping[str, Path]) -> None:
        """Write files from objects; folders are made."""
        ...

    def remove(self, paths: Iterable[str]) -> None:
        """Remove objects; those that are not there are left alone."""
        ...
