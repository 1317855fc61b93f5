"""What ``store show`` tells: a result or a run, what it was made from, and how all of that was made."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from pipeline.lineage import Lineage
from workflows.progress import duration, size
from workflows.provenance.facts import Row, about_result, about_run, configuration, how_made
from workflows.provenance.picture import write_picture
from workflows.provenance.subject import subject
from workflows.provenance.tree import tree_rows
from workflows.request import open_store
from workflows.tables import aligned
from workflows.upkeep.names import short

MANY = 60
"""Results from which on a run is told stage by stage: a tree of more is no longer read."""


def show(name: str, location: str | None, picture: Path | None = None) -> None:
    """Everything about a result or a run, and a picture of what it was made from.

    Raises
    ------
    InputError
        If there is no such result or run, or the picture cannot be made.
    """
    store = open_store(location)
    found = subject(store, name)
    lines = found.lines
    if picture is not None:
        if len(lines.manifests) > MANY:
            raise _too_many(name, len(lines.manifests))
        write_picture(lines, picture)
    if found.runs:
        _print(about_run(found.runs))
    else:
        _print(row for manifest in lines.kept[-1:] for row in about_result(store, manifest))
    _title(f"made from: {len(lines.manifests)} results, {size(lines.size)}")
    if len(lines.manifests) > MANY:
        _print_stages(lines)
        print("\nfor one of them: myofilm store show KEY; for a list: myofilm store ls --run NAME")
        return
    for line in aligned(list(tree_rows(lines))):
        print(line)
    for ref, problem in lines.problems.items():
        print(f"damaged: {short(ref)}: {problem}")
    for manifest in reversed(lines.kept):
        _title(f"{manifest.stage}/{manifest.key}")
        _print([*how_made(manifest), *configuration(manifest)])
    if picture is not None:
        print(f"\npicture  {picture}")


def _too_many(name: str, count: int) -> Exception:
    from pipeline.errors import InputError

    return InputError(
        f"{name!r} is {count} results, too many for a picture; give the key of one of them "
        f"(a picture shows up to {MANY})"
    )


def _title(text: str) -> None:
    print(f"\n{text}")


def _print(rows: Iterable[Row]) -> None:
    for line in aligned(list(rows)):
        print(line)


def _print_stages(lines: Lineage) -> None:
    counts = Counter(ref.stage for ref in lines.manifests)
    rows = [("STAGE", "RESULTS", "SIZE", "COMPUTED IN")]
    for stage, count in counts.items():
        of_it = [manifest for manifest in lines.kept if manifest.stage == stage]
        seconds = duration(sum(manifest.seconds for manifest in of_it))
        rows.append((stage, str(count), size(sum(m.size for m in of_it)), seconds))
    for line in aligned(rows):
        print(line)
