"""Tags of the artefacts in a local store: empty files ``tags/<stage>/<key>/<tag>``."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from urllib.parse import quote, unquote

from pipeline.errors import InputError
from pipeline.keys import Ref

LONGEST = 60
"""Characters of a tag: it is a column of lists."""


def checked(tag: str) -> str:
    """A tag that can be told and typed.

    Raises
    ------
    InputError
        If it is empty, too long, or holds spaces, commas or slashes.

    Examples
    --------
    >>> checked("figure-9")
    'figure-9'
    """
    if not tag or len(tag) > LONGEST or not tag.isprintable() or set(tag) & set(" ,/"):
        raise InputError(
            f"{tag!r} cannot be a tag: give up to {LONGEST} characters without spaces, commas and slashes"
        )
    return tag


def read_tags(folder: Path) -> dict[Ref, tuple[str, ...]]:
    """Tags of all artefacts that have any, sorted."""
    found: dict[Ref, list[str]] = {}
    for parent, _, names in os.walk(folder):
        key, stage = Path(parent).name, Path(parent).parent.name
        for name in names:
            found.setdefault(Ref(stage, key), []).append(unquote(name))
    return {ref: tuple(sorted(tags)) for ref, tags in found.items()}


def add_tag(folder: Path, ref: Ref, tag: str) -> None:
    """Give an artefact a tag."""
    path = _path(folder, ref, tag)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()


def remove_tag(folder: Path, ref: Ref, tag: str) -> None:
    """Take a tag away, if it is there."""
    path = _path(folder, ref, tag)
    path.unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        path.parent.rmdir()  # fails if there are others


def _path(folder: Path, ref: Ref, tag: str) -> Path:
    return folder / ref.stage / ref.key / quote(checked(tag), safe="")
