"""The records of one run, loaded when an export asks for them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stages.artefacts import (
        ActivationHistory,
        BucklingModes,
        Deformation,
        Equilibria,
        Measures,
        ShapeMeasures,
    )


@dataclass(frozen=True)
class Experiment:
    """Results of the stages by name; histories stay on disk and are read frame by frame.

    Attributes
    ----------
    config
        Configuration of the workflow.
    load
        Gives the record of a stage, by the stage's name.
    """

    config: Any
    load: Callable[[str], Any]

    @cached_property
    def geometry(self) -> Any:
        """Surfaces and lay-up of the film: a ``FilmGeometry``, without cells a ``ShellGeometry``."""
        return self.load("geometry")

    @cached_property
    def history(self) -> ActivationHistory:
        """Potential and active stress over time."""
        return self.load("electrophysiology")

    @cached_property
    def deformation(self) -> Deformation | Equilibria:
        """Shapes of the shell over time."""
        return self.load("mechanics")

    @cached_property
    def path(self) -> Equilibria:
        """The same of a quasi-static run."""
        return self.load("mechanics")

    @cached_property
    def buckling(self) -> BucklingModes:
        """Buckling modes, where they were asked for."""
        return self.load("buckling")

    @cached_property
    def measures(self) -> Measures:
        """Probe series, curvature and beats of a film with cells."""
        return self.load("postprocessing")

    @cached_property
    def shape(self) -> ShapeMeasures:
        """Probe series and curvature of a film under imposed activation."""
        return self.load("postprocessing")
