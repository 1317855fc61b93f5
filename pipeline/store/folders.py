"""What is in a folder that others may remove meanwhile."""

from __future__ import annotations

import os
from pathlib import Path


def names(folder: Path) -> list[str]:
    """Names of all entries, sorted; none if there is no such folder."""
    return sorted(entry.name for entry in entries(folder))


def entries(folder: Path) -> list[os.DirEntry[str]]:
    """All entries, in no particular order; none if there is no such folder."""
    try:
        with os.scandir(folder) as found:
            return list(found)
    except (FileNotFoundError, NotADirectoryError):
        return []
