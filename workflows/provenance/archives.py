"""What ``store export`` and ``store import`` do."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from pathlib import Path

from pipeline.archive.export import export
from pipeline.archive.form import Header
from pipeline.archive.reading import Contents, check
from pipeline.archive.taking_in import Taken, take_in
from pipeline.errors import InputError, StoreError
from pipeline.fingerprint.sources import Sources
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.provenance import version_changes
from pipeline.store import Store
from pipeline.store.labels import RunLabel
from workflows.progress import size
from workflows.provenance.subject import Subject, subject
from workflows.request import open_store
from workflows.upkeep.names import short


def export_archive(name: str, path: Path, location: str | None) -> None:
    """Write a result or the results of a run, and all that they were made from, to an archive.

    Raises
    ------
    InputError
        If there is no such result or run, or the file cannot be made.
    StoreError
        If one of the results is damaged or gone.
    """
    store = open_store(location)
    found = subject(store, name)
    missing = [ref for ref in found.lines.roots if found.lines.manifests[ref] is None]
    if missing:
        raise StoreError(
            f"{len(missing)} results of {name!r} are not there, as {short(missing[0])}",
            path=store.location,
            remedy="run the experiment to its end, then export it",
        )
    refs = tuple(ref for ref, manifest in found.lines.manifests.items() if manifest is not None)
    written = export(store, _header(found, refs), path)
    print(f"{_results(refs)} in {path}, {size(written)}")
    print(f"to take them into another store: myofilm store import {shlex.quote(path.name)}")


def import_archive(path: Path, name: str | None, location: str | None) -> None:
    """Check an archive, take its results in, and say what is to be done with them.

    Raises
    ------
    InputError
        If the archive is not sound, or there is a run of its name already.
    StoreError
        If the store cannot be written.
    """
    contents = check(path)
    store = open_store(location)
    header = contents.header
    label = RunLabel(
        name=name or _free_name(path, header),
        named=True,
        folder=None,
        workflow=header.workflow,
        config=header.config,
        command=header.command or ("myofilm", "store", "import", path.name),
    )
    RunLabel.of(label.name, path.parent)  # checks the name
    _refuse_other(store, label, header)
    taken = take_in(store, path, contents, label)
    print(f"{_results(taken.new)} taken in ({size(_size(contents, taken.new))}), ", end="")
    print(f"{len(taken.present) + len(taken.other)} there already; kept as the run {label.name!r}")
    _tell_differences(contents, taken)
    print(f"about them: myofilm store show {shlex.quote(label.name)}")
    if header.command:
        print(f"they are of the command: {shlex.join(header.command)}")


def _header(found: Subject, refs: tuple[Ref, ...]) -> Header:
    if not found.runs:
        return Header(refs)
    label = found.runs[-1].label
    command = ("myofilm", *label.command[1:]) if label.command else ()
    # The name of a run without one is its folder, which says nothing elsewhere.
    return Header(refs, label.name if label.named else "", label.workflow, label.config, command)


def _free_name(path: Path, header: Header) -> str:
    return header.name or path.name.partition(".")[0] or "imported"


def _refuse_other(store: Store, label: RunLabel, header: Header) -> None:
    """A name stands for one set of results; taking the same ones in again is no harm."""
    for run in store.upkeep.runs():
        if run.label.name == label.name and run.finished is not None:
            used = set(store.upkeep.used_by(run.label))
            if used - set(header.refs):
                raise InputError(
                    f"a run {label.name!r} with other results is there already; choose another "
                    "name with --name"
                )


def _tell_differences(contents: Contents, taken: Taken) -> None:
    for ref in taken.other:
        print(
            f"Warning: {short(ref)} is there already with other bits, computed on another machine or "
            "with other libraries. It stays, and what the archive made from its own is not found by "
            "runs here; to use all of the archive, import it into an empty store with --store"
        )
    manifests = contents.manifests.values()
    if others := sorted(_other_code(manifests)):
        more = f" and {len(others) - 3} more" if len(others) > 3 else ""
        print(
            f"Warning: computed with other code than is installed here ({', '.join(others[:3])}"
            f"{more}). Runs here compute anew what depends on it; `myofilm explain` tells what"
        )
    changes = {
        change
        for manifest in manifests
        for change in version_changes(manifest.environment.get("versions", {}))
    }
    if changes:
        print(f"Note: computed with {', '.join(sorted(changes))}")


def _other_code(manifests: Iterable[Manifest]) -> set[str]:
    """Modules whose code here is not that of the results."""
    sources = Sources()
    stated = {pair for each in manifests for pair in each.modules.items()}
    here = {name: sources.read(name) for name, _ in stated}
    return {name for name, digest in stated if (at := here[name]) is None or at.digest != digest}


def _results(refs: tuple[Ref, ...]) -> str:
    return f"{len(refs)} result{'' if len(refs) == 1 else 's'}"


def _size(contents: Contents, refs: Iterable[Ref]) -> int:
    return sum(contents.manifests[ref].size for ref in refs)
