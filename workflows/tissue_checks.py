"""Whether mesh, threshold and stimuli suit the film and its cells, before anything is computed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.front import tissue_front
from stages.electrophysiology.limits import excitation
from stages.electrophysiology.stimuli.base import Stimulus
from stages.geometry.config import FilmConfig
from workflows.film_checks import stimulus_off_the_film, unfit_meshes
from workflows.tables import number

FEWEST = 3.0
"""Collocation points across a front: with fewer it is pinned to the mesh, or jumps from point to point."""


def unfit_tissue(film: FilmConfig, cells: ElectrophysiologyConfig) -> Iterator[str]:
    """A mesh or a threshold with which no front would run, or be seen, on the film."""
    yield from unfit_meshes(film, {"electrophysiology": (cells.degree, cells.elements)})
    yield from too_coarse(film, cells)
    yield from threshold_out_of_reach(cells)


def unfit_stimuli(film: FilmConfig, stimuli: Sequence[Stimulus], end: float) -> Iterator[str]:
    """Stimuli, or parts of them, that do not lie on the film or come after ``end`` (ms)."""
    for i, stimulus in enumerate(stimuli):
        name = f"electrophysiology.stimuli.{i}"
        yield from stimulus_off_the_film(name, stimulus, film)
        for problem in stimulus.outside_the_run(end):
            yield f"{name}: {problem}"


def too_coarse(film: FilmConfig, cells: ElectrophysiologyConfig) -> Iterator[str]:
    """Directions in which a front would pass between too few points, and the mesh that would do.

    The distance between points is their mean one, the side over elements + degree - 1. The front is the
    narrowest that the tissue carries, from 10 to 90 % of its rise; tissue that carries none is let pass.
    """
    front = tissue_front(cells)
    if front is None or cells.allow_coarse_mesh:
        return
    sides = (film.length, film.width)
    needed = [fewest_elements(side, cells.degree, front.width) for side in sides]
    enough = [max(n, least) for n, least in zip(cells.elements, needed, strict=True)]
    for axis, side, elements, least in zip("XY", sides, cells.elements, needed, strict=True):
        if elements < least:
            points = front.width * (elements + cells.degree - 1) / side
            yield (
                f"electrophysiology.elements = {list(cells.elements)}: a front, {front.width:.2g} mm wide, would "
                f"have {points:.2g} collocation points across it along {axis}, and below {FEWEST:g} it "
                f"does not run as it should; elements = {enough} would do "
                "(electrophysiology.allow_coarse_mesh = true goes on with fewer)"
            )
            return


def fewest_elements(side: float, degree: int, width: float) -> int:
    """Elements along a side that put enough points across a front of a width.

    Examples
    --------
    >>> fewest_elements(3.5, 2, 0.35), fewest_elements(0.1, 2, 0.35)
    (29, 1)
    """
    return max(math.ceil(FEWEST * side / width - 1e-9) - degree + 1, 1)


def threshold_out_of_reach(cells: ElectrophysiologyConfig) -> Iterator[str]:
    """An activation threshold that action potentials of these cells do not cross from below."""
    found, threshold = excitation(cells), cells.activation_threshold
    if found is None or found.start < threshold < found.peak:
        return
    middle = round(0.5 * (found.start + found.peak))
    yield (
        f"electrophysiology.activation_threshold = {number(threshold)} mV does not lie between rest "
        f"({number(found.start)} mV) and peak ({number(found.peak)} mV) of these cells: no activation "
        f"would be found; half way is {middle} mV"
    )


def tip_potential_out_of_reach(
    cells: ElectrophysiologyConfig, level: float | None
) -> Iterator[str]:
    """A potential (mV) that is to tell the tips of spirals, but that these cells do not pass through."""
    found = excitation(cells)
    if level is None or found is None or found.start < level < found.peak:
        return
    yield (
        f"postprocessing.tip_potential = {number(level)} mV does not lie between rest "
        f"({number(found.start)} mV) and peak ({number(found.peak)} mV) of these cells: no tip would be "
        f"found; half way is {round(0.5 * (found.start + found.peak))} mV"
    )
