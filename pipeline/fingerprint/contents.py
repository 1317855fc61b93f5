"""What tells that a file is another one than before: its state, quickly, or its contents, for certain."""

from __future__ import annotations

import hashlib
import os
from typing import TypeAlias

State: TypeAlias = tuple[int, int]
"""Modification time in nanoseconds, and size, of a file."""


def state(path: str | os.PathLike[str]) -> State:
    """Present state of a file; edits of equal size within a tick of the clock do not show in it."""
    status = os.stat(path)
    return status.st_mtime_ns, status.st_size


def package_of(name: str, file: str) -> str:
    """Package that relative imports in a module's file start from."""
    return name if file.endswith("__init__.py") else name.rpartition(".")[0]


def content_id(contents: bytes, name: str, file: str) -> str:
    """Digest of the bytes of a module's file and of its package."""
    package = package_of(name, file).encode()
    return hashlib.blake2b(b"%s\0%s" % (package, contents), digest_size=20).hexdigest()
