"""Files that appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pipeline.errors import MyofilmError
from workflows.unfinished import temporary_sibling


class ExportError(MyofilmError):
    """A file cannot be written into the output folder; what it shows is in the store.

    Parameters
    ----------
    path
        The file.
    cause
        Why not.
    """

    def __init__(self, path: Path, cause: str) -> None:
        self.path = path
        super().__init__(
            f"cannot write {path}: {cause}\n"
            "Remedy: run again with --out elsewhere; all results are kept, and nothing is computed "
            "again"
        )


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Temporary sibling that takes the place of ``path`` when the block ends well.

    Its name keeps the suffix, which tells some writers what to write.

    Raises
    ------
    ExportError
        If the disk is full or refuses the file.
    """
    temporary = temporary_sibling(path)
    try:
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        if error.filename not in (None, str(temporary), temporary):
            raise  # another file, read while this one was written
        raise ExportError(path, (error.strerror or str(error)).lower()) from error
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file in one go."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def holds(path: Path, text: str) -> bool:
    """Whether a file is there and holds a text already."""
    try:
        return path.read_bytes() == text.encode()
    except OSError:
        return False
