"""Configuration of the mechanics stage."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Count, OneOf, Section, quantity, setting
from stages.mechanics.controls.base import Control
from stages.mechanics.controls.load import LoadControl
from stages.mechanics.loads.base import Load
from stages.mechanics.materials.base import Material
from stages.mechanics.supports.base import Support
from stages.mechanics.tension_laws.base import TensionLaw

AnyMaterial = Annotated[Material, OneOf("stages.mechanics.materials", Material)]
AnyTensionLaw = Annotated[TensionLaw, OneOf("stages.mechanics.tension_laws", TensionLaw)]
AnyLoad = Annotated[Load, OneOf("stages.mechanics.loads", Load, tag="kind")]
AnySupport = Annotated[Support, OneOf("stages.mechanics.supports", Support, tag="kind")]
AnyControl = Annotated[Control, OneOf("stages.mechanics.controls", Control, tag="kind")]


class ShellConfig(Section):
    """Shell on the film's mid-surface: mesh, time grid, supports, materials, quadrature, Newton."""

    elements: tuple[Count, Count] = setting("knot spans along X and along Y", "sec. 4.3")
    degree: int = setting("degree of the splines; C1 is needed, so 2 or more", "sec. 3.1", ge=2)
    n_steps: int = setting(
        "number of time steps; of a quasi-static run, of intervals between stored shapes",
        "sec. 4.3",
        ge=1,
        le=10**7,
    )
    duration: float = quantity("ms", "simulated time", "sec. 4.3", gt=0)
    supports: dict[str, AnySupport] = setting(
        "how the film is held: a table for each support, under any label", "sec. 4.1"
    )
    loads: dict[str, AnyLoad] = setting(
        "what loads the film besides its muscle: a table for each load, under any label",
        "eq. 47",
        default_factory=dict,
    )
    substrate: AnyMaterial = setting("material of the layer `substrate`", "Table 1, eq. 94")
    active: AnyMaterial = setting("material of the layer `active`", "Table 1, eq. 95")
    materials: dict[str, AnyMaterial] = setting(
        "further materials, by the names that `geometry.layers` may give", default_factory=dict
    )
    tension_law: AnyTensionLaw = setting(
        "from activation and fibre stretch to the active stress, by name", "eqs. 37, 96"
    )
    plane_points: int | None = setting(
        "in-plane Gauss points per element and direction; none: degree + 1",
        "sec. 3.1",
        ge=1,
        default=None,
    )
    layer_points: int = setting(
        "Gauss points through the thickness of each layer", "sec. 4", ge=1, default=3
    )
    displacement_tolerance: float = setting(
        "Newton: accepted correction, relative to the film's diagonal", gt=0, default=1e-7
    )
    energy_tolerance: float = setting(
        "Newton: accepted work of the correction, relative to the step's largest",
        gt=0,
        default=1e-8,
    )
    force_tolerance: float = setting(
        "Newton: accepted residual, relative to stiffness times the film's diagonal",
        gt=0,
        default=1e-9,
    )
    max_iterations: int = setting("Newton: iterations before giving up", ge=1, default=15)
    max_halvings: int = setting("how often a step that fails may be halved", ge=0, default=6)

    @model_validator(mode="after")
    def _names_are_free(self) -> ShellConfig:
        for name in ("substrate", "active"):
            if name in self.materials:
                raise PydanticCustomError(
                    "materials",
                    "materials.{name} is taken: give that material as mechanics.{name}",
                    {"name": name},
                )
        return self

    @model_validator(mode="after")
    def _enough_points(self) -> ShellConfig:
        """Fewer Gauss points than the degree leave motions without stiffness."""
        if self.points_per_element < self.degree:
            raise PydanticCustomError(
                "plane_points",
                "plane_points {points} is too few for degree {degree}: some motions would meet no "
                "resistance; give {degree} or more, or leave it out for degree + 1",
                {"points": self.plane_points, "degree": self.degree},
            )
        return self

    @property
    def all_materials(self) -> dict[str, Material]:
        """Materials that a layer may name."""
        return {"substrate": self.substrate, "active": self.active, **self.materials}

    @property
    def is_acted_on(self) -> bool:
        """Whether loads or moving supports act on the film, besides its muscle."""
        return bool(self.loads) or any(support.law for support in self.supports.values())

    @property
    def step(self) -> float:
        """Time step, ms."""
        return self.duration / self.n_steps

    @property
    def points_per_element(self) -> int:
        """In-plane Gauss points per element and direction."""
        return self.degree + 1 if self.plane_points is None else self.plane_points


class MechanicsConfig(ShellConfig):
    """Shell in motion: what inertia and damping need besides."""

    spectral_radius: float = quantity(
        "", "amplification rho_inf of infinitely fast modes", "eq. 67", ge=0, le=1
    )
    damping: float = quantity(
        "1/ms", "damping per mass c of C = c M; printed as 0.8 m/s, a rate", "eq. 105", ge=0
    )
    stiffness_damping: float = quantity(
        "ms", "damping per stiffness at rest (Rayleigh)", "sec. 3.2", ge=0
    )
    step_control: Literal["fixed", "adaptive"] = setting(
        "time steps: n_steps equal ones, halved where Newton fails; or within each of them as many as "
        "the error asks for",
        default="fixed",
    )
    error_tolerance: float = setting(
        "adaptive: accepted error that one step adds to any displacement, relative to the film's "
        "diagonal",
        gt=0,
        default=1e-5,
    )
    max_substeps: int = setting(
        "adaptive: the shortest step is duration / n_steps / max_substeps", ge=1, default=1000
    )


class EquilibriumConfig(ShellConfig):
    """Shell in equilibrium at every instant: its loading is so slow that nothing swings."""

    initial_increment: float = setting(
        "first load step, relative to the interval between two stored shapes; later ones adapt",
        gt=0,
        le=1,
        default=1.0,
    )
    control: AnyControl = setting(
        "what a run proceeds by: load (the time laws say what acts) or arc-length (past limit points)",
        default_factory=LoadControl,
    )
    buckling_modes: int = setting(
        "number of buckling modes, linearised at the film at rest; factors are those of what acts at "
        "the last instant",
        ge=0,
        le=1000,
        default=0,
    )

    @model_validator(mode="after")
    def _preload_ends_at_a_shape(self) -> EquilibriumConfig:
        preload = getattr(self.control, "preload", 0.0)
        frame = round(preload / self.step)
        if abs(preload - frame * self.step) > 1e-9 * self.duration or frame >= self.n_steps:
            raise PydanticCustomError(
                "preload",
                "control.preload = {preload} ms must be before the end, a multiple of duration / n_steps "
                "= {step} ms",
                {"preload": f"{preload:g}", "step": f"{self.step:g}"},
            )
        return self

    @model_validator(mode="after")
    def _is_held_at_all(self) -> EquilibriumConfig:
        """Without supports there is no equilibrium; what some supports leave free is found later."""
        if all(support.kind == "free" for support in self.supports.values()):
            raise PydanticCustomError(
                "not_held",
                "supports: nothing holds the film, so it has no equilibrium; give a table such as "
                '[mechanics.supports.clamp] with kind = "clamped" and edge = "X=0"',
            )
        return self
