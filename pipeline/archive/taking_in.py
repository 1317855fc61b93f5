"""Taking the artefacts of an archive into a store."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pipeline.archive.form import ArchiveError
from pipeline.archive.reading import Contents, Reader, reading
from pipeline.durable import remove_tree, storing
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.store.labels import RunLabel
from pipeline.store.protocol import Store


@dataclass(frozen=True)
class Taken:
    """What became of the artefacts of an archive.

    Attributes
    ----------
    new
        Those that were published now.
    present
        Those that the store held already, just the same.
    other
        Those of which the store held another version, which stays: the same statement computed with
        other last bits, as another processor does.
    """

    new: tuple[Ref, ...]
    present: tuple[Ref, ...]
    other: tuple[Ref, ...]


def take_in(store: Store, path: Path, contents: Contents, label: RunLabel) -> Taken:
    """Publish the artefacts of an archive that :func:`~pipeline.archive.reading.check` found sound.

    Each becomes visible at once and whole, inputs first. If this is killed, what was published stays
    and the same call goes on after it.

    Parameters
    ----------
    store
        Where they go.
    path, contents
        The archive, and what checking it gave.
    label
        Run that they are registered under, so that they stay.

    Raises
    ------
    ArchiveError
        If the file changed since it was checked.
    StoreError
        If the store cannot be written, or what it holds of these is damaged.
    """
    kept: dict[str, list[Ref]] = {"new": [], "present": [], "other": []}
    store.begin(label)
    with reading(path) as reader:
        if reader.header != contents.header:
            raise ArchiveError(path, "it changed while it was read", "import it again")
        for ref, manifest in contents.manifests.items():
            if reader.manifest(ref, {}) != manifest:
                raise ArchiveError(path, "it changed while it was read", "import it again")
            found = store.find(ref, label)
            how = "present"
            if found is None:
                found, how = _published(store, reader, manifest)
            else:
                for _ in reader.files(manifest):
                    pass
            kept[how if found.content == manifest.content else "other"].append(ref)
    store.finish(label)
    return Taken(tuple(kept["new"]), tuple(kept["present"]), tuple(kept["other"]))


def _published(store: Store, reader: Reader, manifest: Manifest) -> tuple[Manifest, str]:
    with store.writing(manifest.ref, lambda holder: None) as work:
        found = store.find(manifest.ref)
        if found is not None:  # somebody computed it while we waited
            for _ in reader.files(manifest):
                pass
            return found, "present"
        work.begin(resume=False)
        try:
            with storing(work.data):
                for entry, contents in reader.files(manifest):
                    target = work.data / entry.path
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(contents)
            return work.publish(manifest), "new"
        except BaseException:
            remove_tree(work.folder)
            raise
