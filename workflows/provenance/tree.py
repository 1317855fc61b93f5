"""The lineage of results as a tree of text."""

from __future__ import annotations

from collections.abc import Iterator

from pipeline.keys import Ref
from pipeline.lineage import Lineage, Use
from workflows.progress import duration, size
from workflows.upkeep.names import short


def tree_rows(lines: Lineage) -> Iterator[tuple[str, str, str, str]]:
    """Rows of a table: the branches with stage and key, the parts read, size, computing time.

    Results stand above what they were made from. One that was read more than once is followed
    upstream where it comes first, and said to be above elsewhere.
    """
    drawn: set[Ref] = set()
    for end in reversed(lines.ends):
        yield from _rows(lines, end, "", "", "", drawn)


def _rows(
    lines: Lineage, ref: Ref, read: str, here: str, below: str, drawn: set[Ref]
) -> Iterator[tuple[str, str, str, str]]:
    if ref in drawn:
        yield f"{here}{short(ref)} (above)", read, "", ""
        return
    drawn.add(ref)
    yield f"{here}{short(ref)}", read, *_cost(lines, ref)
    uses = lines.sources(ref)
    for use in uses:
        last = use is uses[-1]
        yield from _rows(
            lines,
            use.source,
            _read(use),
            below + ("└─ " if last else "├─ "),
            below + ("   " if last else "│  "),
            drawn,
        )


def _read(use: Use) -> str:
    return ", ".join(use.parts)


def _cost(lines: Lineage, ref: Ref) -> tuple[str, str]:
    manifest = lines.manifests[ref]
    if manifest is None:
        return lines.problems.get(ref, "no longer kept"), ""
    told = duration(manifest.seconds)
    return size(manifest.size), told + (" DAMAGED" if ref in lines.problems else "")
