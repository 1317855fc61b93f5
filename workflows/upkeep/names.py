"""What a user means by a key."""

from __future__ import annotations

from pipeline.errors import InputError
from pipeline.keys import Ref
from pipeline.store import Store

SHORT = 12
"""Characters of a key that are shown in lists."""

AT_LEAST = 4
"""Characters of a key that tell which result is meant where something is done to it."""


def short(ref: Ref) -> str:
    """Stage and first characters of the key."""
    return f"{ref.stage}/{ref.key[:SHORT]}"


def artefact(store: Store, text: str) -> Ref:
    """The one artefact whose key starts so; ``STAGE/`` may stand before it.

    Raises
    ------
    InputError
        If there is none, or more than one.
    """
    found = artefacts(store, text)
    if not found:
        raise InputError(f"{store.location} holds no result whose key starts with {text!r}")
    if len(found) > 1:
        several = ", ".join(short(ref) for ref in found[:5])
        raise InputError(f"{len(found)} results have a key that starts with {text!r}: {several}")
    return found[0]


def artefacts(store: Store, text: str) -> list[Ref]:
    """All artefacts whose key starts so; ``STAGE/`` may stand before it."""
    stage, _, start = text.rpartition("/")
    if not start or set(stage) & {"/", "\\"} or stage in (".", "..") or text.startswith("/"):
        return []  # a path, which would lead out of the store
    refs = store.refs(stage) if stage else store.refs()
    return [ref for ref in refs if ref.key.startswith(start)]
