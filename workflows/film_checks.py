"""What contradicts between the film and the places on it, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from stages.geometry.config import FilmConfig
from stages.postprocessing.config import ShapeConfig
from workflows.tables import exact


def places_off_the_film(film: FilmConfig, measured: ShapeConfig) -> Iterator[str]:
    """Probes and mid-axis that do not lie on the film."""
    for name, place in measured.probes.items():
        if isinstance(place, str):
            continue
        x, y = place
        if not (0 <= x <= film.length and 0 <= y <= film.width):
            yield (
                f"postprocessing.probes.{name} = ({exact(x)}, {exact(y)}) mm lies outside the film "
                f"{extent(film)}"
            )
    axis = measured.mid_axis
    if not isinstance(axis, str) and axis > film.width:
        yield f"postprocessing.mid_axis = {exact(axis)} mm lies outside the film {extent(film)}"


def extent(film: FilmConfig) -> str:
    """The film's rectangle."""
    return f"{interval((0, film.length))} x {interval((0, film.width))} mm"


def interval(ends: Sequence[float]) -> str:
    """Two ends in brackets, with all their digits."""
    return f"[{exact(ends[0])}, {exact(ends[1])}]"
