"""Whether an artefact is what was published, and the words for what is not."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.durable import storing
from pipeline.errors import MyofilmError, StoreError
from pipeline.keys import Ref
from pipeline.manifest import FileEntry, Manifest, content_ids, hash_files, whole_content

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
    """The problem of a file whose size is not the published one, ``None`` if it is."""
    try:
        size = os.stat(os.path.join(data, file.path)).st_size
    except OSError:
        return f"{file.path} is missing"
    return None if size == file.size else f"{file.path} has {size} bytes instead of {file.size}"


def full_problems(data: Path, manifest: Manifest) -> Iterator[str]:
    """Problems of an artefact whose sizes are right: its files, checksums, contents and key."""
    found = {entry.path: entry for entry in hash_files(data)}
    kept = {entry.path: entry for entry in manifest.files}
    beside = {path.name for path in data.parent.iterdir()} - {data.name, "manifest.json"}
    foreign = sorted(found.keys() - kept.keys()) + sorted(beside)
    yield from (f"{path} does not belong to it" for path in foreign)
    for path in sorted(kept):
        if found[path].sha256 != kept[path].sha256:
            yield wrong_checksum(path)
    if manifest.stated_key() != manifest.key:
        yield "its key is not that of its statement"
    parts = content_ids(manifest.files)
    if manifest.parts != parts or manifest.content != whole_content(parts):
        yield "its content ids are not those of its files"
