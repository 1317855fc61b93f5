"""Runs of the parametric studies: label, workflow and parameters of each.

Each point of a figure is a run of its own, as in the paper, although a ramp to 30 kPa passes all lower
stresses: a point then has its own increments, and does not change when another one is added.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias


@dataclass(frozen=True)
class Run:
    """A run that a figure needs.

    Attributes
    ----------
    workflow
        What is run.
    overrides
        Parameters that make this run, over those of the user.
    defaults
        Tables that stand in for the workflow's own parameters; the user's are over them.
    """

    workflow: str
    overrides: tuple[str, ...] = ()
    defaults: Mapping[str, Any] = field(default_factory=dict)


Overrides: TypeAlias = tuple[str, ...]
Planned: TypeAlias = dict[str, Run]

STRESSES = (2.8, 7.0, 9.0, 12.0, 17.0, 21.6, 30.0)
"""Peak stresses P, kPa (Figs 3, 4 and 7; 9 kPa is that of Fig. 5)."""

SHAPES = (2.8, 7.0, 12.0, 17.0, 21.6, 30.0)
"""Those of Fig. 4."""

EXTREMES = (2.8, 21.6)
"""Smallest and largest peak stress that was measured (Fig. 6)."""

THICKNESSES = (13.0, 15.0, 18.0, 21.0, 24.0, 28.0)
"""Thicknesses of the substrate, um (sec. 4.1 names the range)."""

FIXED_STRESS = 9.0
"""Peak stress of Fig. 5, kPa."""

PULSE: Mapping[str, Any] = {
    "activation": {"time_law": {"name": "smooth-pulse", "time_to_peak": 210.0}},
    "mechanics": {"n_steps": 100, "duration": 500.0},
}
"""The law and the instants of sec. 4.2, for a quasi-static film."""

BIAS_THICKNESSES = (13.0, 18.0, 28.0)
BIAS_RATIOS = (0.05, 0.1, 0.17, 0.3, 0.571428571, 1.0, 2.0)
"""Width over length; 4/7 is the film of the paper, and below 0.05 the thickest is no thin shell."""

COARSE: Mapping[str, Any] = {
    "mechanics": {
        "n_steps": 21,
        "supports": {"clamp": {"kind": "clamped-normal", "edge": "X=0"}},
    }
}
"""Half the increments, since only the last shape counts and does not depend on them; and the clamp that
leaves the first elements free to bend, since their number is less than the paper's."""

LENGTH = 3.5
"""mm, sec. 4.1."""

ELEMENT = 0.25
"""mm across the film: quadratic elements of that size show how its sides curl, over 0.2 mm or so."""


def stresses() -> Planned:
    """Fig. 3."""
    return {_kpa(stress): Run("curling", _peak(stress)) for stress in STRESSES}


def shapes() -> Planned:
    """Fig. 4."""
    return {_kpa(stress): Run("curling", _peak(stress)) for stress in SHAPES}


def thicknesses() -> Planned:
    """Fig. 5."""
    return {f"{d:g} um": Run("curling", (*_peak(FIXED_STRESS), _thick(d))) for d in THICKNESSES}


def tips() -> Planned:
    """Fig. 6."""
    return _both(EXTREMES, PULSE)


def twitches() -> Planned:
    """Fig. 7; its quasi-static runs are those of Fig. 3."""
    return _both(STRESSES, {})


def widths() -> Planned:
    """The bias of strip formulas: films from narrow to wide, of three substrates."""
    return {
        f"{d:g} um, width/length {ratio:.3g}": Run(
            "curling", (*_peak(FIXED_STRESS), _thick(d), *_wide(ratio)), COARSE
        )
        for d in BIAS_THICKNESSES
        for ratio in BIAS_RATIOS
    }


def _both(values: tuple[float, ...], quasi_static: Mapping[str, Any]) -> Planned:
    dynamic: Planned = {f"{_kpa(p)}, dynamic": Run("twitch", _peak(p)) for p in values}
    return dynamic | {
        f"{_kpa(p)}, quasi-static": Run("curling", _peak(p), quasi_static) for p in values
    }


def _kpa(stress: float) -> str:
    return f"{stress:g} kPa"


def _peak(stress: float) -> Overrides:
    return (f"activation.peak_stress={stress}",)


def _thick(micrometres: float) -> str:
    return f'geometry.substrate_thickness="{micrometres:g} um"'


def _wide(ratio: float) -> Overrides:
    width = round(ratio * LENGTH, 6)
    across = max(4, round(width / ELEMENT))
    return (f"geometry.width={width}", f"mechanics.elements=[30, {across}]")
