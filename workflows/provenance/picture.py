"""The lineage of results as a picture: a small SVG that a browser shows, its text selectable."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

from pipeline.durable import write_atomically
from pipeline.errors import InputError
from pipeline.keys import Ref
from pipeline.lineage import Lineage, Use
from workflows.progress import duration, size
from workflows.provenance.layout import Layout, layout
from workflows.upkeep.names import SHORT

WIDTH, HEIGHT = 176.0, 70.0
"""A box: the longest stage name in 14 px, and three lines."""

GAP, SPACE, LANE, EDGE = 164.0, 26.0, 42.0, 12.0
"""Between columns, with room for the longest name of a part; between boxes; for a line; around all."""

LINE = 13.0
"""Height of a line of small text."""

STYLE = """
.lineage text { font: 12px system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; fill: #222; }
.lineage .stage { font-size: 14px; font-weight: 600; }
.lineage .key { font-family: ui-monospace, Menlo, Consolas, "DejaVu Sans Mono", monospace; }
.lineage .note { fill: #666; }
.lineage .box { fill: #f4f8fb; stroke: #0072b2; stroke-width: 1.2; }
.lineage .asked { fill: #dcecf7; stroke-width: 2.4; }
.lineage .gone { fill: #fff; stroke: #9a9a9a; stroke-dasharray: 5 3; }
.lineage .damaged { fill: #fdeee3; stroke: #d55e00; }
.lineage .line { fill: none; stroke: #777; stroke-width: 1.3; }
.lineage .tip { fill: #777; }
.lineage .read { fill: #555; text-anchor: end; paint-order: stroke; stroke: #fff; stroke-width: 3px; }
"""


def write_picture(lines: Lineage, path: Path) -> None:
    """Write the picture to a file.

    Raises
    ------
    InputError
        If the name of the file does not end in ``.svg``, or it cannot be written.
    """
    if path.suffix.lower() != ".svg":
        raise InputError(
            f"the picture is written as SVG, and {path.name!r} does not end in .svg; a browser "
            "shows such a file, and Inkscape turns it into other formats"
        )
    if not path.parent.is_dir():
        raise InputError(f"the folder {path.parent} of the picture is not there; make it first")
    try:
        write_atomically(path, picture(lines).encode())
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(
            f"cannot write the picture {path}: {reason}; choose another place"
        ) from error


def picture(lines: Lineage) -> str:
    """Text of the SVG; the same lineage gives the same text."""
    refs = list(lines.manifests)
    pairs = [(use.source, use.reader) for use in lines.uses]
    tall = {ref: max(HEIGHT, _side(lines, ref)) + SPACE for ref in refs}
    places = layout(refs, pairs, tall, LANE)
    right = max((_left(places, ref) + WIDTH for ref in refs), default=0.0) + EDGE
    low = max((places.heights[ref] + 0.5 * tall[ref] for ref in refs), default=0.0)
    bends = (bend + 0.5 * LANE for bent in places.bends.values() for bend in bent)
    bottom = max([low, *bends]) - 0.5 * SPACE + 2 * EDGE
    body = [*_lines(lines, places), *(_box(lines, places, ref) for ref in refs)]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" class="lineage" width="{right:.0f}" '
            f'height="{bottom:.0f}" viewBox="0 0 {right:.0f} {bottom:.0f}" role="img" '
            f'aria-label="{escape(_told(lines))}">',
            f"<style>{STYLE}</style>",
            *body,
            "</svg>\n",
        ]
    )


def _told(lines: Lineage) -> str:
    made = ", ".join(
        f"{use.reader.stage} reads {use.source.stage}"
        for ref in lines.manifests
        for use in lines.sources(ref)
    )
    return f"What the results were made from: {made or 'nothing else'}"


def _side(lines: Lineage, ref: Ref) -> float:
    """Height that the names of all that enters a box take."""
    return sum(_entry(use) for use in lines.sources(ref)) + 4.0


def _entry(use: Use) -> float:
    """Height of a line's end with the parts read above it."""
    return LINE * max(1, len(use.parts)) + 8.0


def _left(places: Layout[Ref], ref: Ref) -> float:
    return EDGE + places.columns[ref] * (WIDTH + GAP)


def _top(places: Layout[Ref], ref: Ref) -> float:
    return EDGE - 0.5 * SPACE + places.heights[ref]


def _box(lines: Lineage, places: Layout[Ref], ref: Ref) -> str:
    manifest = lines.manifests[ref]
    kind, note = "box", "no longer kept"
    if manifest is None:
        kind += " gone"
    else:
        note = f"{size(manifest.size)}, {duration(manifest.seconds)}"
    if ref in lines.problems:
        kind, note = "box damaged", "damaged"
    elif ref in lines.roots:
        kind += " asked"
    high = max(HEIGHT, _side(lines, ref))
    x, y = _left(places, ref), _top(places, ref) - 0.5 * high
    middle = _top(places, ref)
    return (
        f'<g><title>{escape(str(ref))}</title><rect class="{kind}" x="{x:.1f}" y="{y:.1f}" '
        f'width="{WIDTH:.0f}" height="{high:.1f}" rx="5"/>'
        f'<text class="stage" x="{x + 12:.1f}" y="{middle - 14:.1f}">{escape(ref.stage)}</text>'
        f'<text class="key" x="{x + 12:.1f}" y="{middle + 5:.1f}">{escape(ref.key[:SHORT])}</text>'
        f'<text class="note" x="{x + 12:.1f}" y="{middle + 22:.1f}">{escape(note)}</text></g>'
    )


def _lines(lines: Lineage, places: Layout[Ref]) -> Iterator[str]:
    leaving: dict[Ref, list[Use]] = {}
    for use in lines.uses:
        leaving.setdefault(use.source, []).append(use)
    for reader in lines.manifests:
        uses = sorted(lines.sources(reader), key=lambda use: _comes_from(places, use))
        y = _top(places, reader) - 0.5 * sum(_entry(use) for use in uses)
        for use in uses:
            y += _entry(use)
            others = sorted(leaving[use.source], key=lambda one: _goes_to(places, one))
            spread = (others.index(use) - 0.5 * (len(others) - 1)) * min(12.0, 48.0 / len(others))
            yield from _line(places, use, _top(places, use.source) + spread, y - 6.0)


def _comes_from(places: Layout[Ref], use: Use) -> float:
    bends = places.bends[use.source, use.reader]
    return bends[-1] if bends else places.heights[use.source]


def _goes_to(places: Layout[Ref], use: Use) -> float:
    bends = places.bends[use.source, use.reader]
    return bends[0] if bends else places.heights[use.reader]


def _line(places: Layout[Ref], use: Use, start: float, end: float) -> Iterator[str]:
    """A curve through the places of the line, straight where it passes a column."""
    x, y = _left(places, use.source) + WIDTH, start
    path = [f"M{x:.1f},{y:.1f}"]
    label = 6.6 * max((len(part) for part in use.parts), default=0)
    for i, bend in enumerate(places.bends[use.source, use.reader], start=1):
        left = _left(places, use.source) + i * (WIDTH + GAP)
        height = EDGE - 0.5 * SPACE + bend
        path += [_curve(x, y, left, height), f"H{left + WIDTH:.1f}"]
        x, y = left + WIDTH, height
    tip = _left(places, use.reader)
    flat = max(x + 36.0, tip - 10.0 - label)
    path += [_curve(x, y, flat, end), f"H{tip - 6:.1f}"]
    yield f'<path class="line" d="{" ".join(path)}"/>'
    yield f'<path class="tip" d="M{tip:.1f},{end:.1f} l-8,-4 v8 z"/>'
    for i, part in enumerate(reversed(use.parts)):
        yield (
            f'<text class="read" x="{tip - 10:.1f}" y="{end - 6 - i * LINE:.1f}">'
            f"{escape(part)}</text>"
        )


def _curve(x: float, y: float, to_x: float, to_y: float) -> str:
    half = 0.5 * (x + to_x)
    return f"C{half:.1f},{y:.1f} {half:.1f},{to_y:.1f} {to_x:.1f},{to_y:.1f}"
