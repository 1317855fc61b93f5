"""What became of the cases of a sweep, kept as it happens: a crash costs the last line at most."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import IO, Any

from workflows.exports.files import ExportError

NAME = "journal.jsonl"


@dataclass(frozen=True)
class Failure:
    """A case that failed.

    Attributes
    ----------
    case
        Its name when it failed.
    id
        Digest of what it is.
    stage
        Stage that failed; empty if its numbers could not be read.
    error
        Message.
    code
        Digest of the code that failed: with other code the case is tried again.
    """

    case: str
    id: str
    stage: str
    error: str
    code: str


class Journal:
    """Lines of JSON, one per event, only ever added to.

    Parameters
    ----------
    folder
        Output folder of the sweep.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / NAME
        self.failures: dict[str, Failure] = {}
        for entry in self._entries():
            self._remember(entry)
        self._file: IO[bytes] | None = None

    def failed(self, failure: Failure) -> None:
        """Note a case that failed."""
        self.failures[failure.id] = failure
        self._add("failed", vars(failure), durable=True)

    def done(self, case: str, id: str) -> None:
        """Note a case that is done; needed only if it failed before."""
        if self.failures.pop(id, None) is not None:
            self._add("done", {"case": case, "id": id}, durable=True)

    def began(self, command: str, cases: int) -> None:
        """Note the beginning of a call."""
        self._add("began", {"command": command, "cases": cases}, durable=False)

    def ended(self, how: str, counts: Mapping[str, int]) -> None:
        """Note the end of a call."""
        self._add("ended", {"how": how, **counts}, durable=True)

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def _entries(self) -> Iterator[Mapping[str, Any]]:
        """Entries of earlier calls; a line that a crash cut short is left out."""
        try:
            lines = self._path.read_bytes().splitlines()
        except FileNotFoundError:
            return
        except OSError as error:
            raise ExportError(self._path, (error.strerror or str(error)).lower()) from error
        for line in lines:
            try:
                entry = json.loads(line)
            except (ValueError, RecursionError):
                continue
            if isinstance(entry, dict):
                yield entry

    def _remember(self, entry: Mapping[str, Any]) -> None:
        if entry.get("event") == "done":
            self.failures.pop(str(entry.get("id")), None)
        if entry.get("event") == "failed":
            names = Failure.__dataclass_fields__
            failure = Failure(**{name: str(entry.get(name, "")) for name in names})
            self.failures[failure.id] = failure

    def _add(self, event: str, facts: Mapping[str, Any], *, durable: bool) -> None:
        entry = {"event": event, "at": datetime.now(UTC).isoformat(timespec="seconds"), **facts}
        try:
            file = self._file = self._file or self._opened()
            file.write(json.dumps(entry).encode() + b"\n")
            file.flush()
            if durable:
                os.fsync(file.fileno())
        except OSError as error:
            raise ExportError(self._path, (error.strerror or str(error)).lower()) from error

    def _opened(self) -> IO[bytes]:
        """The file at its end, which becomes the end of a line."""
        file = open(self._path, "ab+")  # noqa: SIM115 - closed by close()
        if file.tell():
            file.seek(-1, os.SEEK_END)
            if file.read(1) != b"\n":
                file.write(b"\n")
        return file
