"""Configuration of the film and of the two meshes laid over it."""

from __future__ import annotations

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Count, Section, quantity, setting

THICKEST = 0.2
"""Of the smaller side: beyond it Kirchhoff and Love's assumption (sec. 2.2) has no meaning."""


class FilmConfig(Section):
    """Flat rectangular film of two layers, clamped at X = 0 (sec. 4.1, Fig. 2)."""

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

    @model_validator(mode="after")
    def _is_thin(self) -> FilmConfig:
        """A shell is thin; a thickness in micrometres that was meant but not said is not."""
        for name in ("substrate_thickness", "active_thickness"):
            thickness, side = getattr(self, name), min(self.length, self.width)
            if thickness > THICKEST * side:
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
