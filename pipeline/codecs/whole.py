"""Reading of zarr groups of which every chunk must be there.

zarr takes a chunk that is missing for one that was never written, and reads fill values. All of ours
are written, so a missing one is damage.
"""

from __future__ import annotations

import errno
from typing import TYPE_CHECKING

from zarr.storage import LocalStore

if TYPE_CHECKING:
    from zarr.abc.store import ByteRequest
    from zarr.core.buffer import Buffer, BufferPrototype


METADATA = ("zarr.json", ".zarray", ".zattrs", ".zgroup", ".zmetadata")
"""Files that zarr looks for where they need not be."""


class WholeStore(LocalStore):
    """A folder of zarr groups in which a missing chunk is an error.

    Raises
    ------
    FileNotFoundError
        On reading an array, if one of its chunks is not there.
    """

    async def get(
        self,
        key: str,
        prototype: BufferPrototype | None = None,
        byte_range: ByteRequest | None = None,
    ) -> Buffer | None:
        """Contents of a file; ``None`` for metadata that is not there."""
        found = await super().get(key, prototype, byte_range)
        if found is None and not key.endswith(METADATA):
            path = str(self.root / key)
            raise FileNotFoundError(errno.ENOENT, "a chunk of an array is missing", path)
        return found
