"""Configuration of the measures taken on the beating film."""

from __future__ import annotations

import re

from pydantic import field_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Section, quantity


class PostprocessingConfig(Section):
    """Where an experimenter would look: probes, the mid-axis, the window of the front speed."""

    probes: dict[str, tuple[float, float]] = quantity(
        "mm", "points (X, Y) of the undeformed film that are followed, by name", "sec. 4.3, Fig. 9"
    )
    mid_axis: float = quantity(
        "mm", "Y of the line along which the film's projection is measured", "eq. 101, Fig. 2", ge=0
    )
    velocity_window: tuple[float, float] = quantity(
        "mm", "from which X to which X the front is timed, along the mid-axis", "this project"
    )

    @field_validator("probes")
    @classmethod
    def _names_fit_a_table_heading(
        cls, probes: dict[str, tuple[float, float]]
    ) -> dict[str, tuple[float, float]]:
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
