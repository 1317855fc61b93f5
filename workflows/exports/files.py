"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import platform
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pipeline.errors import MyofilmError
from pipeline.store.registers import is_process


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


def temporary_sibling(path: Path) -> Path:
    """Hidden name beside a file, or a folder, for what is not finished; its suffix is the same."""
    return path.with_name(f".{path.stem}.{platform.node()}.{os.getpid()}{path.suffix}")


def remove_unfinished(folder: Path) -> None:
    """Remove what processes of this machine left in a folder that were killed while they wrote there."""
    pattern = re.compile(rf"\..+\.{re.escape(platform.node())}\.(\d+)(\.\w+)?")
    for name in os.listdir(folder):
        match = pattern.fullmatch(name)
        if match and not is_process(int(match[1])):
            path = folder / name
            with suppress(OSError):  # it is in nobody's way
                shutil.rmtree(path) if path.is_dir() else path.unlink()


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
