"""The store at a location that a user names."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.errors import InputError
from pipeline.store.local import LocalStore

if TYPE_CHECKING:
    from pipeline.store.remote import RemoteStore


def open_store(location: str | os.PathLike[str] | None) -> LocalStore | RemoteStore:
    """The store in a folder or below a URL, or without a location the one in the user's cache folder.

    Raises
    ------
    InputError
        If there can be no store at this location, or it cannot be reached.
    StoreError
        If its description is damaged.
    """
    if location is None:
        import platformdirs

        location = Path(platformdirs.user_cache_dir("myofilm"))
    if isinstance(location, str) and "://" in location:
        return remote_store(location)
    return LocalStore(location)


def remote_store(location: str, **settings: float | Path) -> RemoteStore:
    """The store below a URL.

    Parameters
    ----------
    location
        URL, for instance ``s3://bucket/prefix``.
    settings
        Of :class:`~pipeline.store.remote.RemoteStore`.

    Raises
    ------
    InputError
        If it names no place, or the place cannot be used.
    """
    from pipeline.store.remote import RemoteStore
    from pipeline.store.remote.objects import Objects

    protocol, _, path = location.partition("://")
    if not protocol or not path.strip("/"):
        raise InputError(f"the store {location!r} names no place; write s3://bucket/prefix")
    objects: Objects
    if protocol in ("file", "local"):
        from pipeline.store.remote.folder_objects import FolderObjects

        objects = FolderObjects(Path(path).absolute())
    else:
        from pipeline.store.remote.fsspec_objects import FsspecObjects

        objects = FsspecObjects(location)
    return RemoteStore(objects, **settings)  # type: ignore[arg-type]
