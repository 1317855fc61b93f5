"""Configuration of the electrophysiology stage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Count, quantity, setting, unkeyed
from stages.electrophysiology.cell_config import CellConfig
from stages.electrophysiology.limits import n_steps_needed
from stages.electrophysiology.schemes.base import AnyScheme
from stages.electrophysiology.stimuli.base import AnyStimulus
from stages.electrophysiology.stimulus_library import with_named_stimuli


class ElectrophysiologyConfig(CellConfig):
    """Monodomain problem on the active layer: mesh, time grid, cells, tension, stimuli.

    A workflow fills in what ``preset`` or ``accuracy`` pick, before this is read.
    """

    picks: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "preset": ("accuracy", "elements", "degree", "n_steps", "scheme"),
        "accuracy": ("preset", "elements", "degree", "n_steps", "scheme"),
    }

    preset: str | None = unkeyed(
        "name of a measured setting that picks elements, degree, n_steps and scheme; none: as given",
        default=None,
    )
    accuracy: float | None = unkeyed(
        "error of activation times to stay below, for which the cheapest measured setting picks elements, "
        "degree, n_steps and scheme; none: as given",
        unit="ms",
        gt=0,
        default=None,
    )
    elements: tuple[Count, Count] = setting("knot spans along X and along Y", "sec. 4.3")
    degree: int = setting("degree of the splines; C1 is needed, so 2 or more", "sec. 4.3", ge=2)
    n_steps: int = setting("number of time steps", "sec. 4.3", ge=1, le=10**9)
    duration: float = quantity("ms", "simulated time", "sec. 4.3", gt=0)
    output_interval: float = quantity(
        "ms", "time between stored frames, rounded to whole time steps", "this project", gt=0
    )
    output_tolerance: float | None = quantity(
        "mV",
        "frames are left out whose potential those around them give by interpolation to within this; "
        "none: every frame is stored",
        "this project",
        gt=0,
        default=None,
    )
    output_stress_tolerance: float | None = quantity(
        "kPa", "the same for the active stress", "this project", gt=0, default=None
    )
    activation_threshold: float = quantity(
        "mV", "potential whose upward crossing is the activation time", "this project"
    )
    conductivity: float = quantity("nF/ms", "tissue conductivity D", "Table 3", gt=0)
    transverse_conductivity: float | None = quantity(
        "nF/ms",
        "conductivity across the fibres, where `conductivity` is that along them; none: the same",
        "eq. 8, D as a tensor",
        gt=0,
        default=None,
    )
    diffusion_angle: float | None = quantity(
        "degree",
        "angle from X of the fibres that conduct better; none: that of the active layer's fibres",
        "eq. 8, D as a tensor",
        ge=-180,
        le=180,
        default=None,
    )
    membrane_capacitance: float = quantity("nF/mm^2", "membrane capacitance C_m", "Table 3", gt=0)
    scheme: AnyScheme = setting(
        "scheme in time by name", "sec. 3.4", default="cn-ab2", validate_default=True
    )
    stimuli: tuple[AnyStimulus, ...] = setting(
        "stimuli that are applied: names from the library, or tables", "sec. 4.3"
    )
    stimulus_library: dict[str, AnyStimulus] = unkeyed(
        "named stimuli that `stimuli` may refer to", default_factory=dict
    )
    allow_coarse_mesh: bool = unkeyed(
        "whether to go on where the mesh is too coarse for a front", default=False
    )
    allow_unstable_step: bool = unkeyed(
        "whether to go on where the explicit part of the scheme is unstable", default=False
    )

    @model_validator(mode="before")
    @classmethod
    def _look_up_stimuli(cls, data: Any) -> Any:
        """Replace names in ``stimuli`` by their tables in ``stimulus_library``."""
        return with_named_stimuli(data)

    @model_validator(mode="after")
    def _angle_has_a_meaning(self) -> ElectrophysiologyConfig:
        if self.diffusion_angle is not None and self.transverse_conductivity is None:
            raise PydanticCustomError(
                "angle_without_fibres",
                "diffusion_angle has no meaning without transverse_conductivity: the tissue conducts "
                "alike in all directions",
                {},
            )
        return self

    @model_validator(mode="after")
    def _tolerances_go_together(self) -> ElectrophysiologyConfig:
        if (self.output_tolerance is None) != (self.output_stress_tolerance is None):
            raise PydanticCustomError(
                "output_tolerance",
                "give output_tolerance and output_stress_tolerance both, or neither: a frame is left out "
                "only where both fields are known without it",
                {},
            )
        return self

    @model_validator(mode="after")
    def _the_explicit_part_is_stable(self) -> ElectrophysiologyConfig:
        needed = None if self.allow_unstable_step else n_steps_needed(self)
        if needed is not None:
            raise PydanticCustomError(
                "unstable_step",
                "n_steps = {given}: steps of {step} ms are beyond the stability of the explicit part of "
                "the scheme {scheme} with these cells; {needed} steps would do, or the scheme strang "
                "(allow_unstable_step = true computes all the same)",
                {
                    "given": self.n_steps,
                    "step": f"{self.step:.4g}",
                    "scheme": self.scheme.name,
                    "needed": needed,
                },
            )
        return self

    @property
    def tolerances(self) -> dict[str, float] | None:
        """How well frames that are left out must be known, by field; none: every frame is stored."""
        if self.output_tolerance is None or self.output_stress_tolerance is None:
            return None
        return {
            "potential": self.output_tolerance,
            "active_stress": self.output_stress_tolerance,
        }

    @property
    def is_isotropic(self) -> bool:
        """Whether the tissue conducts alike in all directions."""
        return self.transverse_conductivity in (None, self.conductivity)

    @property
    def step(self) -> float:
        """Time step, ms."""
        return self.duration / self.n_steps

    @property
    def steps_per_frame(self) -> int:
        """Time steps between stored frames: the output interval in whole steps, one at least."""
        return max(round(self.output_interval / self.step), 1)

    @property
    def frame_steps(self) -> list[int]:
        """Steps after which a frame is stored: 0, then every ``steps_per_frame``, and the last."""
        return [*range(0, self.n_steps, self.steps_per_frame), self.n_steps]
