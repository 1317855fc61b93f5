"""What contradicts between the film, its materials and the places on it, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches

from stages.electrophysiology.stimuli.base import Stimulus
from stages.geometry.config import FilmConfig
from stages.geometry.shapes.base import Elements
from stages.mechanics.config import ShellConfig
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


def unusable_layers(film: FilmConfig, shell: ShellConfig) -> Iterator[str]:
    """Layers of an unknown material, or none that an activation could act in."""
    for i, layer in enumerate(film.layers):
        if layer.material not in shell.all_materials:
            near = get_close_matches(layer.material, shell.all_materials, n=1, cutoff=0.3)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            yield (
                f"geometry.layers.{i} ({layer.name}): no material is called {layer.material!r}{hint} "
                f"(there are: {', '.join(sorted(shell.all_materials))}; further ones are tables "
                f"mechanics.materials.NAME)"
            )
    if not any(layer.activity for layer in film.lay_up) and not shell.is_acted_on:
        yield (
            "geometry.layers: no layer is active, so nothing would move the film: give one an "
            "activity above 0, or load the film (mechanics.loads)"
        )


def acting_off_the_film(film: FilmConfig, shell: ShellConfig) -> Iterator[str]:
    """Points that are held, moved, loaded or waited for and do not lie on the film."""
    until = getattr(getattr(shell, "control", None), "until", None)
    if until is not None:
        yield from off_the_film("mechanics.control.until.position", until.position, film)
    for section, tables in (("supports", shell.supports), ("loads", shell.loads)):
        for label, table in tables.items():
            place = getattr(table, "position", None) or (0.0, 0.0)
            yield from off_the_film(f"mechanics.{section}.{label}.position", place, film)
            if table.kind != "free":
                edge = getattr(table, "edge", None)
                yield from _at_a_seam(f"mechanics.{section}.{label}", edge, film)


def unfit_meshes(film: FilmConfig, meshes: Mapping[str, tuple[int, Elements]]) -> Iterator[str]:
    """Meshes, by their section with degree and elements, that the film's shape does not allow."""
    for section, (degree, elements) in meshes.items():
        for problem in film.shape.unfit_mesh(degree, elements):
            yield f"{section}.elements: {problem}"


def stimulus_off_the_film(name: str, stimulus: Stimulus, film: FilmConfig) -> Iterator[str]:
    """A stimulus, by the name of its parameter, of which a part does not lie on the film."""
    for problem in stimulus.off_the_film(film.length, film.width):
        yield f"{name}: {problem}"
    yield from _at_a_seam(name, stimulus.on_edge(), film)


def _at_a_seam(name: str, edge: str | None, film: FilmConfig) -> Iterator[str]:
    if edge is not None and film.shape.closed["XY".index(edge[0])]:
        others = " and ".join(("Y=0", "Y=L2") if edge[0] == "X" else ("X=0", "X=L1"))
        yield (
            f"{name}: there is no edge {edge}, since the film closes there to a {film.shape.name}; its "
            f"edges are {others}"
        )


def off_the_film(name: str, place: tuple[float, float], film: FilmConfig) -> Iterator[str]:
    """A point that does not lie on the film, by the name of its parameter."""
    x, y = place
    if not (0 <= x <= film.length and 0 <= y <= film.width):
        yield f"{name} = ({exact(x)}, {exact(y)}) mm lies outside the film {extent(film)}"


def extent(film: FilmConfig) -> str:
    """The film's rectangle."""
    return f"{interval((0, film.length))} x {interval((0, film.width))} mm"


def interval(ends: Sequence[float]) -> str:
    """Two ends in brackets, with all their digits."""
    return f"[{exact(ends[0])}, {exact(ends[1])}]"
