"""Configuration of the film and of the two meshes laid over it."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Count, Section, quantity, setting
from stages.geometry.shapes.base import AnyShape
from stages.geometry.shapes.flat import Flat

THICKEST = 0.2
"""Of the smaller side: beyond it Kirchhoff and Love's assumption (sec. 2.2) has no meaning."""


class LayerConfig(Section):
    """One layer of a film that is not the paper's; a passive one may leave fibres and activity out."""

    name: str = setting("what the layer is called in messages and results", "eqs. 34-35")
    material: str = setting(
        "its material: substrate, active, or a name in mechanics.materials", "eqs. 34-35"
    )
    thickness: float = quantity("mm", "thickness of the layer", "eqs. 34-35", gt=0)
    fibre_angle: float | None = quantity(
        "degree",
        "angle of its fibres from the X axis; none: geometry.fibre_angle",
        "eq. 38",
        ge=-180,
        le=180,
        default=None,
    )
    activity: float = quantity(
        "", "factor on the activation; 0: the layer is passive", "eq. 37", ge=0, default=0.0
    )


class FilmConfig(Section):
    """Rectangular film, flat or bent: of two layers (sec. 4.1, Fig. 2), or of the layers listed."""

    length: float = quantity("mm", "length L1 of the film, along X", "sec. 4.1", gt=0)
    width: float = quantity("mm", "width L2 of the film, along Y", "sec. 4.1", gt=0)
    substrate_thickness: float = quantity(
        "mm", "thickness d_s of the elastic substrate (bottom layer)", "sec. 4.1", gt=0
    )
    active_thickness: float = quantity(
        "mm", "thickness d_a of the muscle (top layer)", "sec. 4.1", gt=0
    )
    fibre_angle: float = quantity(
        "degree", "angle of the muscle fibres from the X axis", "sec. 4.1, 4.3", ge=-180, le=180
    )

    layers: tuple[LayerConfig, ...] = setting(
        "layers from bottom to top, in place of the two; none: substrate below, active above",
        "eqs. 34-35",
        default=(),
    )
    shape: AnyShape = setting(
        "how the film lies in space at rest, by name; lengths are along it",
        "sec. 4.1",
        default=Flat(),
    )

    @property
    def lay_up(self) -> tuple[LayerConfig, ...]:
        """Layers from bottom to top, with every fibre angle told."""
        if self.layers:
            return tuple(
                layer.model_copy(update={"fibre_angle": self.fibre_angle})
                if layer.fibre_angle is None
                else layer
                for layer in self.layers
            )
        angle = self.fibre_angle
        passive, muscle = self.substrate_thickness, self.active_thickness
        return (
            LayerConfig(
                name="substrate", material="substrate", thickness=passive, fibre_angle=angle
            ),
            LayerConfig(
                name="active", material="active", thickness=muscle, fibre_angle=angle, activity=1.0
            ),
        )

    @property
    def conducting_angle(self) -> float:
        """Angle of the fibres in the layer that carries the cells: the topmost active one."""
        active = [layer.fibre_angle for layer in self.lay_up if layer.activity != 0.0]
        angle = active[-1] if active else None
        return self.fibre_angle if angle is None else angle

    @model_validator(mode="after")
    def _layers_have_names(self) -> FilmConfig:
        names = [layer.name for layer in self.layers]
        for name in names:
            if names.count(name) > 1:
                raise PydanticCustomError(
                    "layer_names",
                    "{count} layers are called {name}: give each layer its own name",
                    {"count": names.count(name), "name": repr(name)},
                )
        return self

    @model_validator(mode="after")
    def _can_have_its_shape(self) -> FilmConfig:
        for problem in self.shape.problems(self.length, self.width):
            raise PydanticCustomError("shape", "shape: {problem}", {"problem": problem})
        radius = self.shape.smallest_radius(self.length, self.width)
        thickness = sum(layer.thickness for layer in self.lay_up)
        if radius is not None and thickness > THICKEST * radius:
            raise PydanticCustomError(
                "shape",
                "shape: a film {thickness} mm thick is too thick to be bent to a radius of {radius} mm: at "
                "most a fifth of the radius is a shell",
                {"thickness": f"{thickness:g}", "radius": f"{radius:.4g}"},
            )
        return self

    @model_validator(mode="after")
    def _is_thin(self) -> FilmConfig:
        """A shell is thin; a thickness in micrometres that was meant but not said is not."""
        for name, thickness in self._thicknesses():
            if thickness > THICKEST * min(self.length, self.width):
                raise PydanticCustomError(
                    "not_thin",
                    "{name} = {thickness} mm is not thin beside a film of {length} x {width} mm: at most "
                    "a fifth of the smaller side is a shell. Numbers are in mm; for micrometres write "
                    '"{thickness} um"',
                    {
                        "name": name,
                        "thickness": f"{thickness:g}",
                        "length": f"{self.length:g}",
                        "width": f"{self.width:g}",
                    },
                )
        return self

    def _thicknesses(self) -> Iterator[tuple[str, float]]:
        """What must be thin, by the names that a user knows: each layer, then all together."""
        if self.layers:
            for i, layer in enumerate(self.layers):
                yield f"layers.{i}.thickness ({layer.name})", layer.thickness
        else:
            yield "substrate_thickness", self.substrate_thickness
            yield "active_thickness", self.active_thickness
        yield "total thickness", sum(layer.thickness for layer in self.lay_up)


class MeshConfig(Section):
    """Uniform spline mesh of maximum continuity."""

    elements: tuple[Count, Count] = setting("knot spans along X and along Y")
    degree: int = setting("polynomial degree; 2 or more, since C1 is needed", ge=2)


class ShellGeometryConfig(Section):
    """What a film without cells needs: itself, and the shell's mesh."""

    film: FilmConfig
    shell_mesh: MeshConfig


class GeometryStageConfig(Section):
    """All that the geometry stage needs: the film, and the mesh of each sub-problem."""

    film: FilmConfig
    excitable_mesh: MeshConfig
    shell_mesh: MeshConfig
