"""What is known of every artefact of a store without opening each manifest again.

Reading ten thousand manifests takes a second, asking for their times thirty milliseconds. So a few values
of each manifest are kept in one file. That file is never trusted: which artefacts there are is asked
of the store, and a line counts only if it is as it was written, by its checksum, and the manifest is still
the one that it was made from.
"""

from __future__ import annotations

import contextlib
import datetime
import json
import os
import zlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.durable import write_atomically
from pipeline.errors import StoreError
from pipeline.keys import Ref
from pipeline.manifest import Manifest

SPARE_LINES = 1000
"""Lines of removed artefacts that the file may hold, beside as many as there are artefacts."""


@dataclass(frozen=True)
class Row:
    """What lists and the removal of artefacts need to know of one.

    Attributes
    ----------
    ref
        Its name.
    size
        Bytes of its data.
    seconds
        What computing it took.
    finished
        When that ended, seconds since 1970.
    inputs
        What it was computed from.
    problem
        Why its manifest cannot be read, empty if it can.
    """

    ref: Ref
    size: int
    seconds: float
    finished: float
    inputs: tuple[Ref, ...] = ()
    problem: str = ""


def row_of(manifest: Manifest) -> Row:
    """Row of an artefact."""
    inputs = {Ref(entry.stage, entry.key): None for entry in manifest.inputs.values()}
    finished = datetime.datetime.fromisoformat(manifest.finished).timestamp()
    return Row(manifest.ref, manifest.size, manifest.seconds, finished, tuple(inputs))


def catalogue(
    cache: Path, present: Iterable[tuple[Ref, str]], load: Callable[[Ref], Manifest]
) -> list[Row]:
    """Rows of all artefacts, read from the manifests only where the cache does not know them.

    Parameters
    ----------
    cache
        File of JSON lines; missing, damaged and outdated lines are added where it may be written.
    present
        The artefacts that there are, each with a stamp that changes with its manifest.
    load
        Reads a manifest; an artefact that is gone by then is left out.
    """
    lines, known = _read(cache)
    rows, added = [], []
    for ref, stamp in present:
        line = known.get((ref.stage, ref.key, stamp))
        if line is not None:
            rows.append(_row(line))
            continue
        try:
            row = row_of(load(ref))
        except FileNotFoundError:
            continue
        except (StoreError, ValueError) as error:
            rows.append(Row(ref, 0, 0.0, 0.0, problem=getattr(error, "cause", str(error))))
            continue
        rows.append(row)
        added.append(_line(row, stamp))
        known[ref.stage, ref.key, stamp] = json.loads(added[-1])
    with contextlib.suppress(OSError):  # only a cache
        if lines + len(added) > 2 * len(rows) + SPARE_LINES:
            wanted = {(row.ref.stage, row.ref.key) for row in rows}
            kept = [json.dumps(line) for key, line in known.items() if key[:2] in wanted]
            write_atomically(cache, b"".join(_sealed(line) for line in kept))
        elif added:
            _append(cache, added)
    return rows


def note(cache: Path, manifest: Manifest, stamp: str) -> None:
    """Add an artefact that was published just now; whatever goes wrong, it is only a cache."""
    with contextlib.suppress(OSError, ValueError):
        _append(cache, [_line(row_of(manifest), stamp)])


def _append(cache: Path, lines: list[str]) -> None:
    descriptor = os.open(cache, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
    try:
        # A line that another process did not finish must not spoil the first of these.
        os.write(descriptor, b"\n" + b"".join(_sealed(line) for line in lines))
    finally:
        os.close(descriptor)


def _read(cache: Path) -> tuple[int, dict[tuple[str, str, str], list[Any]]]:
    """Number of lines, and those that can be read, by artefact and stamp."""
    try:
        lines = cache.read_bytes().split(b"\n")
    except OSError:
        return 0, {}
    written = [line for line in lines if line]
    whole = [line[9:] for line in written if line[:9] == _checksum(line[9:])]
    return len(written), {(line[0], line[1], line[2]): line for line in _parsed(whole)}


def _sealed(line: str) -> bytes:
    """A line of the file: the wrong inputs of a result would let others be removed that are needed."""
    return b"%s%s\n" % (_checksum(line.encode()), line.encode())


def _checksum(line: bytes) -> bytes:
    return b"%08x " % zlib.crc32(line)


def _parsed(lines: list[bytes]) -> Iterator[list[Any]]:
    """All lines at once, which is five times as fast as one by one, unless one is damaged."""
    try:
        parsed = json.loads(b"[" + b",".join(lines) + b"]")
    except ValueError:
        parsed = []
        for line in lines:
            with contextlib.suppress(ValueError):
                parsed.append(json.loads(line))
    yield from (line for line in parsed if _is_line(line))


def _is_line(line: Any) -> bool:
    return isinstance(line, list) and [type(item) for item in line] == _TYPES


_TYPES = [str, str, str, int, float, float, list]


def _line(row: Row, stamp: str) -> str:
    inputs = [[ref.stage, ref.key] for ref in row.inputs]
    return json.dumps(
        [row.ref.stage, row.ref.key, stamp, row.size, float(row.seconds), row.finished, inputs]
    )


def _row(line: list[Any]) -> Row:
    stage, key, _, size, seconds, finished, inputs = line
    return Row(Ref(stage, key), size, seconds, finished, tuple(Ref(*each) for each in inputs))
