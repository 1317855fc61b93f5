"""The description of a store, ``store.json``: the version of its layout."""

from __future__ import annotations

import json

from pipeline.errors import InputError
from pipeline.keys import SCHEMA


def check_description(contents: bytes, store: object) -> None:
    """Whether this program can use a store with such a description.

    Parameters
    ----------
    contents
        Of ``store.json``.
    store
        Where the store is, for the message.

    Raises
    ------
    InputError
        If it was written by a newer version, or says nothing about the version.
    """
    try:
        version = json.loads(contents)["version"]
        if type(version) is not int or version < 1:
            raise ValueError(f"version {version!r}")
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise InputError(
            f"unreadable description of the store {store}: store.json gives no version ({error})\n"
            f'Remedy: if all in it is of this version, write {{"version": {SCHEMA}}} into store.json; '
            "otherwise choose another store with --store"
        ) from error
    if version > SCHEMA:
        raise InputError(
            f"the store {store} has layout version {version}; this program knows versions "
            f"up to {SCHEMA}: update it, or choose another store with --store"
        )
