"""Reading of zarr groups of which every chunk must be there, as it was written.

zarr takes a chunk that is missing for one that was never written, and reads fill values. All of ours
are written, so a missing one is damage. The checksum inside a chunk tells a flipped bit, but not that
the chunk is an earlier one or another's: the one kept in the manifest tells all of that.
"""

from __future__ import annotations

import errno
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Self

from zarr.storage import LocalStore

if TYPE_CHECKING:
    from zarr.abc.store import ByteRequest
    from zarr.core.buffer import Buffer, BufferPrototype

METADATA = ("zarr.json", ".zarray", ".zattrs", ".zgroup", ".zmetadata")
"""Files that zarr looks for where they need not be."""


class WholeStore(LocalStore):
    """A folder of zarr groups, for reading only.

    Parameters
    ----------
    root
        The folder.
    checksums
        SHA-256 of its files by path, compared whenever one of them is read as a whole.

    Raises
    ------
    FileNotFoundError
        On reading an array, if one of its chunks is not there.
    ValueError
        On reading a file whose checksum is wrong.
    """

    def __init__(self, root: Path | str, checksums: Mapping[str, str]) -> None:
        super().__init__(root, read_only=True)
        self._checksums = checksums

    def with_read_only(self, read_only: bool = False) -> Self:
        """Itself; there is no writing to it."""
        if not read_only:
            raise ValueError("a published artefact is never written to")
        return self

    async def get(
        self,
        key: str,
        prototype: BufferPrototype | None = None,
        byte_range: ByteRequest | None = None,
    ) -> Buffer | None:
        """Contents of a file; ``None`` for metadata that is not there."""
        found = await super().get(key, prototype, byte_range)
        if found is None:
            if key.endswith(METADATA):
                return None
            path = str(self.root / key)
            raise FileNotFoundError(errno.ENOENT, "a chunk of an array is missing", path)
        expected = self._checksums.get(key) if byte_range is None else None
        if expected not in (None, hashlib.sha256(found.as_buffer_like()).hexdigest()):
            raise ValueError(f"the checksum of {self.root / key} is wrong")
        return found
