"""Edges of the film that supports hold, as pictures show them."""

from __future__ import annotations

from typing import get_args

from stages.configuration import Edge
from workflows.experiment import Experiment

WORDS = {
    "clamped": "clamped",
    "clamped-normal": "clamped",
    "hinged": "hinged",
    "symmetry": "mirrored",
    "displacement": "moved",
}
"""What stands beside an edge, by the kind of its support; other kinds hold no edge."""


def held_edges(experiment: Experiment) -> dict[str, str]:
    """Word for every held edge, in the order of the edges.

    Examples
    --------
    >>> from types import SimpleNamespace as Table
    >>> supports = {"a": Table(kind="hinged", edge="Y=0"), "b": Table(kind="free", edge="X=L1")}
    >>> film = Table(mechanics=Table(supports=supports))
    >>> held_edges(Experiment(film, load=lambda stage: None))
    {'Y=0': 'hinged'}
    """
    supports = experiment.config.mechanics.supports.values()
    held = {one.edge: WORDS[one.kind] for one in supports if one.kind in WORDS}
    return {edge: held[edge] for edge in get_args(Edge) if edge in held}
