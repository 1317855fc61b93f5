"""Whether an artefact is what was published, and the words for what is not."""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.durable import files_below, storing
from pipeline.errors import MyofilmError, StoreError
from pipeline.keys import Ref
from pipeline.manifest import FileEntry, Manifest, content_ids, sha256, whole_content

if TYPE_CHECKING:
    from pipeline.store.protocol import Store


class DamagedError(StoreError):
    """An artefact is not what was published; it is never used.

    Parameters
    ----------
    ref, place
        The artefact, and where it is.
    problems
        What is wrong with it.
    """

    def __init__(self, ref: Ref, place: Path | str, problems: Iterable[str]) -> None:
        self.ref, self.problems = ref, tuple(problems)
        super().__init__(
            f"artefact {ref} is damaged ({'; '.join(self.problems)})",
            path=place,
            remedy="run the same command with --recompute-damaged: it moves damaged artefacts aside "
            "and computes them again",
        )


@contextlib.contextmanager
def telling_damage(store: Store, refs: Iterable[Ref]) -> Iterator[None]:
    """Tell of damage to the artefacts that the block reads, instead of the failure it led to.

    Arrays are read when they are looked at: whoever computes with them meets whatever their codec
    says of a flipped bit or a missing chunk.

    Raises
    ------
    DamagedError
        If the block fails, and one of these artefacts is damaged.
    """
    try:
        yield
    except MyofilmError:
        raise
    except Exception as error:
        for ref in refs:
            with storing(Path(store.location)):
                problems = store.verify(ref, full=True)
            if problems:
                raise DamagedError(ref, store.where(ref), problems) from error
        raise


def wrong_checksum(path: str) -> str:
    """The problem of a file that does not hold what was published."""
    return f"the checksum of {path} is wrong"


def size_problem(data: Path, file: FileEntry) -> str | None:
    """The problem of a file whose size is not the published one, ``None`` if it is.

    Raises
    ------
    OSError
        If that cannot be found out: a file that may not be read is not damaged.
    """
    try:
        size = os.stat(os.path.join(data, file.path)).st_size
    except (FileNotFoundError, NotADirectoryError):
        return f"{file.path} is missing"
    return None if size == file.size else f"{file.path} has {size} bytes instead of {file.size}"


def folder_problems(
    ref: Ref, folder: Path, read: Callable[[Path], Manifest], *, full: bool
) -> Iterator[str]:
    """Problems of an artefact in a folder, whose manifest a function reads.

    Raises
    ------
    OSError
        As for :func:`size_problem`.
    """
    try:
        manifest = read(folder / "manifest.json")
    except (FileNotFoundError, NotADirectoryError):
        yield "manifest.json is missing"
        return
    except ValueError as error:
        yield f"unreadable manifest ({error})"
        return
    found = [p for file in manifest.files if (p := size_problem(folder / "data", file))]
    if manifest.ref != ref:
        found.append(f"its manifest belongs to {manifest.ref}")
    yield from found
    if full and not found:
        beside = {path.name for path in folder.iterdir()} - {"data", "manifest.json"}
        yield from (f"{name} does not belong to it" for name in sorted(beside))
        yield from full_problems(folder / "data", manifest)


def full_problems(data: Path, manifest: Manifest) -> Iterator[str]:
    """Problems of an artefact whose sizes are right: its files, checksums, contents and key."""
    found = {path.relative_to(data).as_posix() for path in files_below(data)}
    kept = {entry.path: entry.sha256 for entry in manifest.files}
    yield from (f"{path} does not belong to it" for path in sorted(found - kept.keys()))
    for path in sorted(kept):
        try:
            if sha256(data / path) != kept[path]:
                yield wrong_checksum(path)
        except OSError as error:
            if error.errno != errno.EIO:
                raise
            yield f"{path} cannot be read ({error.strerror})"  # the disk has lost it
    if manifest.stated_key() != manifest.key:
        yield "its key is not that of its statement"
    parts = content_ids(manifest.files)
    if manifest.parts != parts or manifest.content != whole_content(parts):
        yield "its content ids are not those of its files"
