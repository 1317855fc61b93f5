"""Configuration of the measures taken on the moving film."""

from __future__ import annotations

import re
from typing import Literal, TypeAlias

from pydantic import field_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Section, quantity

Place: TypeAlias = tuple[float, float] | Literal["centre", "tip", "corner"]
"""A point (X, Y) in mm, or one that follows the film: its centre, the middle or the end of X = L1."""


class ShapeConfig(Section):
    """Where an experimenter would look: probes, and the mid-axis."""

    probes: dict[str, Place] = quantity(
        "mm",
        "points of the undeformed film that are followed, by name: (X, Y), or centre, tip, corner",
        "sec. 4.3, Fig. 9",
    )
    mid_axis: float | Literal["middle"] = quantity(
        "mm",
        "Y of the line along which the film's projection is measured; middle: half the width",
        "eq. 101, Fig. 2",
    )

    @field_validator("probes")
    @classmethod
    def _names_fit_a_table_heading(cls, probes: dict[str, Place]) -> dict[str, Place]:
        if not probes:
            raise PydanticCustomError("no_probes", "name at least one probe")
        for name in probes:
            if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
                raise PydanticCustomError(
                    "probe_name",
                    "the probe name {name} must start with a letter and hold only letters, digits, "
                    "- and _",
                    {"name": repr(name)},
                )
        return dict(sorted(probes.items()))  # the order is not part of the key

    @field_validator("mid_axis")
    @classmethod
    def _axis_is_on_the_film(cls, axis: float | Literal["middle"]) -> float | Literal["middle"]:
        if axis != "middle" and axis < 0:
            raise PydanticCustomError("mid_axis", "must be at least 0 mm, or middle")
        return axis


class PostprocessingConfig(ShapeConfig):
    """The same, the window of the front speed, and the tips of spirals."""

    velocity_window: tuple[float, float] = quantity(
        "mm", "from which X to which X the front is timed, along the mid-axis", "this project"
    )

    tip_potential: float | None = quantity(
        "mV",
        "potential of the line whose end is the tip of a spiral wave; none: no tips are looked for",
        "Fenton and Karma (1998)",
        default=None,
    )

    @field_validator("velocity_window")
    @classmethod
    def _window_runs_forward(cls, window: tuple[float, float]) -> tuple[float, float]:
        if not window[0] < window[1]:
            raise PydanticCustomError(
                "velocity_window",
                "the window must run from a smaller to a larger X, not from {low} to {high} mm",
                {"low": window[0], "high": window[1]},
            )
        return window
