"""The manifest of an artefact: its full key statement, its files, and how it came about."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.canonical import Canonical, digest
from pipeline.durable import files_below
from pipeline.keys import SCHEMA, Ref, key_of
from pipeline.seals import BLANK, is_sealed, sealed


@dataclass(frozen=True)
class FileEntry:
    """One data file, its path relative to the data folder."""

    path: str
    size: int
    sha256: str

    @property
    def part(self) -> str:
        """Part that the file belongs to: those of part ``p`` are ``p.h5`` or in the folder ``p.zarr``."""
        return self.path.partition("/")[0].rpartition(".")[0]


@dataclass(frozen=True)
class InputEntry:
    """Where an input came from; ``part`` is ``None`` for a whole record."""

    stage: str
    key: str
    part: str | None
    content: str


@dataclass(frozen=True)
class Manifest:
    """Everything that is known about an artefact.

    Attributes
    ----------
    schema, stage, key, config, code, modules, inputs
        The key statement: ``code`` is the digest of ``modules``, the digests of all source files.
    files, parts, content
        Data files; content id of each part and of the whole.
    seconds, cpu_seconds, peak_memory
        Cost, summed over interrupted runs; memory in bytes, of the process.
    started, finished
        Times in UTC, ISO 8601.
    environment
        Host, command line, versions, git state.
    warnings, notes
        What the stage reported.
    """

    stage: str
    key: str
    config: Canonical
    code: str
    modules: Mapping[str, str]
    inputs: Mapping[str, InputEntry]
    files: tuple[FileEntry, ...]
    parts: Mapping[str, str]
    content: str
    seconds: float
    cpu_seconds: float
    peak_memory: int
    started: str
    finished: str
    environment: Mapping[str, Any]
    warnings: tuple[str, ...] = ()
    notes: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    schema: int = SCHEMA

    @property
    def ref(self) -> Ref:
        """Name of the artefact in its store."""
        return Ref(self.stage, self.key)

    @property
    def size(self) -> int:
        """Bytes of all data files."""
        return sum(file.size for file in self.files)

    def content_of(self, part: str | None) -> str:
        """Content id of a part, or of the whole."""
        return self.content if part is None else self.parts[part]

    def stated_key(self) -> str:
        """Key recomputed from the statement; differs from ``key`` only in a damaged manifest."""
        inputs = {role: entry.content for role, entry in self.inputs.items()}
        return key_of(self.stage, self.config, self.code, inputs, self.schema)

    def to_json(self) -> bytes:
        """Readable JSON, sealed; the seal is among the environment, where any version reads past it."""
        fields = dataclasses.asdict(self)
        fields["environment"] = {"seal": BLANK, **fields["environment"]}
        return sealed(json.dumps(fields, indent=1, ensure_ascii=False).encode())

    @classmethod
    def from_json(cls, text: bytes) -> Manifest:
        """Manifest read back.

        Raises
        ------
        ValueError
            If the text is not a manifest, or not as it was written. Earlier versions wrote no seals.
        """
        try:
            data = json.loads(text)
            seal = data["environment"].pop("seal", None)
            if seal is not None and not is_sealed(text, seal):
                raise ValueError("it was edited after it had been written")
            if data["schema"] > SCHEMA:
                raise ValueError(f"its schema is {data['schema']}, known are those up to {SCHEMA}")
            data["files"] = tuple(FileEntry(**entry) for entry in data["files"])
            data["inputs"] = {role: InputEntry(**e) for role, e in data["inputs"].items()}
            data["warnings"] = tuple(data["warnings"])
            return cls(**data)
        except (TypeError, KeyError, AttributeError, RecursionError) as error:
            raise ValueError(f"not a manifest: {error}") from error


def hash_files(folder: Path) -> tuple[FileEntry, ...]:
    """Table of all files below a folder, sorted by path."""
    found = sorted(path.relative_to(folder).as_posix() for path in files_below(folder))
    return tuple(
        FileEntry(path, (folder / path).stat().st_size, sha256(folder / path)) for path in found
    )


def sha256(path: Path) -> str:
    """SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def content_ids(files: Iterable[FileEntry]) -> dict[str, str]:
    """Content id of each part: the digest of its file table, whatever the part is called."""
    tables: dict[str, list[list[Any]]] = {}
    for file in files:
        suffix = file.path.removeprefix(file.part)
        tables.setdefault(file.part, []).append([suffix, file.size, file.sha256])
    return {part: digest(sorted(table)) for part, table in sorted(tables.items())}


def whole_content(parts: Mapping[str, str]) -> str:
    """Content id of a whole record."""
    return digest(dict(parts))
