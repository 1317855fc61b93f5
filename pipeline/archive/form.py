"""The form of an archive: a plain tar whose first member says what follows.

archive.json                                version, run, refs
objects/<stage>/<key>/manifest.json         one artefact after another, inputs before
objects/<stage>/<key>/data/...              what was made from them
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from pipeline.errors import InputError
from pipeline.keys import SCHEMA, Ref
from pipeline.manifest import Manifest, content_ids, whole_content

VERSION = 1
"""Version of the form of archives."""

HEADER = "archive.json"
LARGEST_TEXT = 1 << 28
"""Bytes of a header or a manifest that are read at most."""


class ArchiveError(InputError):
    """An archive cannot be used; nothing was taken from it.

    Parameters
    ----------
    path
        The archive.
    cause
        What is wrong.
    remedy
        What to do about it.
    """

    def __init__(self, path: Path, cause: str, remedy: str = "ask for the file again") -> None:
        super().__init__(f"the archive {path} cannot be used: {cause}\nRemedy: {remedy}")


@dataclass(frozen=True)
class Header:
    """What an archive holds.

    Attributes
    ----------
    name, workflow, config, command
        Of the run that was exported; empty for a single result.
    refs
        The artefacts, each after those that it was made from.
    """

    refs: tuple[Ref, ...]
    name: str = ""
    workflow: str = ""
    config: str = ""
    command: tuple[str, ...] = field(default=())

    def to_json(self) -> bytes:
        """Readable JSON."""
        told: dict[str, Any] = {
            "version": VERSION,
            "schema": SCHEMA,
            "name": self.name,
            "workflow": self.workflow,
            "config": self.config,
            "command": list(self.command),
            "refs": [[ref.stage, ref.key] for ref in self.refs],
        }
        return json.dumps(told, indent=1, ensure_ascii=False).encode()

    @classmethod
    def from_json(cls, text: bytes, path: Path) -> Header:
        """Header read back.

        Raises
        ------
        ArchiveError
            If it is not one, or that of a newer version.
        """
        try:
            data = json.loads(text)
            for name, known in (("version", VERSION), ("schema", SCHEMA)):
                if int(data[name]) > known:
                    raise ArchiveError(
                        path,
                        f"its {name} is {data[name]}, and this program knows those up to {known}",
                        "update myofilm",
                    )
            words = {name: str(data[name]) for name in ("name", "workflow", "config")}
            refs = tuple(Ref(str(stage), str(key)) for stage, key in data["refs"])
            command = tuple(str(word) for word in data["command"])
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise ArchiveError(path, f"its header cannot be read ({error})") from error
        if wrong := next((ref for ref in refs if not is_plain(ref)), None):
            raise ArchiveError(path, f"{str(wrong)!r} is not the name of a result")
        if len(set(refs)) != len(refs) or not refs:
            raise ArchiveError(path, "its header names no results, or one of them twice")
        return cls(refs, command=command, **words)


def folder_of(ref: Ref) -> str:
    """Folder of an artefact in an archive."""
    return f"objects/{ref.stage}/{ref.key}"


def is_plain(ref: Ref) -> bool:
    """Whether the name of an artefact leads nowhere else when it is a path.

    Examples
    --------
    >>> is_plain(Ref("geometry", "0a" * 20)), is_plain(Ref("../up", "0a" * 20))
    (True, False)
    """
    return bool(
        re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", ref.stage)
        and re.fullmatch(r"[0-9a-f]{40}", ref.key)
    )


def is_inside(path: str) -> bool:
    """Whether a path stays in the folder that it is relative to.

    Examples
    --------
    >>> [is_inside(path) for path in ("record.zarr/time/c.0", "../x", "/x", "a/./b", "a\\\\b", "")]
    [True, False, False, False, False, False]
    """
    parts = path.split("/")
    plain = not set(path) & {"\\", "\0", ":"} and not {"", ".", ".."} & set(parts)
    return plain and not PurePosixPath(path).is_absolute()


def problem_of(manifest: Manifest, ref: Ref, earlier: Mapping[Ref, Manifest]) -> str | None:
    """What is wrong with the manifest of an artefact in an archive, ``None`` if nothing is.

    ``earlier`` are the manifests before it, among which its inputs may be.
    """
    paths = [file.path for file in manifest.files]
    if manifest.ref != ref:
        return f"the manifest of {ref} belongs to {manifest.ref}"
    if outside := next((path for path in paths if not is_inside(path)), None):
        return f"{ref} has a file {outside!r}, which is outside of its folder"
    folders = {str(parent) for path in paths for parent in PurePosixPath(path).parents}
    if len(set(paths)) != len(paths) or folders & set(paths):
        return f"{ref} has two files of one name"
    if manifest.stated_key() != manifest.key:
        return f"the key of {ref} is not that of its statement"
    parts = content_ids(manifest.files)
    if manifest.parts != parts or manifest.content != whole_content(parts):
        return f"the content ids of {ref} are not those of its files"
    for role, entry in manifest.inputs.items():
        source = earlier.get(Ref(entry.stage, entry.key))
        if source is None:
            continue
        content = source.content if entry.part is None else source.parts.get(entry.part)
        if content != entry.content:
            return f"the {role} that {ref} was made from is not the {source.ref} of this archive"
    return None
