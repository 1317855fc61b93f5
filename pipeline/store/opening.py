"""The store at a location that a user names."""

from __future__ import annotations

import os
from pathlib import Path

from pipeline.errors import InputError
from pipeline.store.local import LocalStore


def open_store(location: str | os.PathLike[str] | None) -> LocalStore:
    """The store in a folder, or without a location the one in the user's cache folder.

    Raises
    ------
    InputError
        If there can be no store at this location.
    """
    if location is None:
        import platformdirs

        location = Path(platformdirs.user_cache_dir("myofilm"))
    if isinstance(location, str) and "://" in location:
        raise InputError(f"the store {location!r} is not a folder")
    return LocalStore(location)
