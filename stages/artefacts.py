"""Records that the stages hand to one another: array shapes, axis names and units.

A record is a frozen dataclass. An array field names its unit and its axes; ``stored`` narrows the
number format on disk where full precision carries no information. ``stored_as`` says in which format
a record is kept: HDF5 for geometry and tables, zarr for fields that grow with time.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:  # records are described, not made, when a run is only planned
    from stages.numerics.bsplines import Array
    from stages.numerics.patches import Patch


def array(unit: str, *axes: str, stored: str | None = None) -> Any:
    """Array field of a record, with its unit and the names of its axes."""
    return field(metadata={"unit": unit, "axes": axes, "stored": stored})


@dataclass(frozen=True)
class ExcitableSurface:
    """Mid-surface of the active layer on the electrophysiology mesh (eqs. 1, 13)."""

    patch: Patch


@dataclass(frozen=True)
class MidSurface:
    """Mid-surface of the undeformed shell on the mechanics mesh (eqs. 12, 40)."""

    patch: Patch


@dataclass(frozen=True)
class Layer:
    """One layer of the film.

    ``material`` is the name of its material in the mechanics; ``thickness`` is in mm, ``fibre_angle``
    in degrees from X; ``activity`` is a factor on the activation, 0 for a passive layer.
    """

    name: str
    material: str
    thickness: float
    fibre_angle: float
    activity: float

    @property
    def active(self) -> bool:
        """Whether the layer pulls at all."""
        return self.activity != 0.0


@dataclass(frozen=True)
class Laminate:
    """Layers from the bottom (theta3 = -d/2) to the top (theta3 = d/2)."""

    layers: tuple[Layer, ...]

    @property
    def thickness(self) -> float:
        """Total thickness d, mm."""
        return sum(layer.thickness for layer in self.layers)


@dataclass(frozen=True)
class FilmGeometry:
    """What the geometry stage makes: three parts, each used by other stages on its own."""

    excitable_surface: ExcitableSurface
    mid_surface: MidSurface
    laminate: Laminate


@dataclass(frozen=True)
class ShellGeometry:
    """The same without cells: what a shell alone needs."""

    mid_surface: MidSurface
    laminate: Laminate


@dataclass(frozen=True)
class ActivationHistory:
    """Potential and active stress at the collocation points over time (eqs. 10, 11, 85).

    Collocation points are numbered as the control points of the excitable surface. Maps have a row per
    point and a column per beat of that point, filled up with NaN. A beat begins with an upward
    crossing of the activation threshold. Repolarisation is the first fall, after the beat's peak, to
    the level at 90 % of the way from that peak to rest; ``apd90`` and ``apd50`` are the times from
    activation to 90 and 50 %, NaN where the next beat or the end of the run came first.
    ``conduction_velocity`` is that of the front, NaN where none is defined.
    """

    stored_as: ClassVar[str] = "zarr"

    time: Array = array("ms", "time")
    potential: Array = array("mV", "time", "point", stored="float32")
    active_stress: Array = array("kPa", "time", "point", stored="float32")
    activation_times: Array = array("ms", "point", "beat")
    repolarisation_times: Array = array("ms", "point", "beat")
    apd50: Array = array("ms", "point", "beat")
    apd90: Array = array("ms", "point", "beat")
    peak_potential: Array = array("mV", "point", "beat")
    conduction_velocity: Array = array("mm/ms", "point", "beat", "xyz")


@dataclass(frozen=True)
class StressSamples:
    """Active stress at the in-plane quadrature points of the shell, at the mechanics times (eq. 87).

    Quadrature points form a tensor grid: all points of direction 1 (element by element) times all
    points of direction 2, direction 2 fastest.
    """

    stored_as: ClassVar[str] = "zarr"

    time: Array = array("ms", "time")
    active_stress: Array = array("kPa", "time", "quadrature_point")


@dataclass(frozen=True)
class Deformation:
    """Motion of the shell's control points, and what its fibres feel (eqs. 41, 53-67).

    The fibres are those at mid-depth of the topmost active layer, at the in-plane quadrature points
    (numbered as in :class:`StressSamples`).

    Energies are since the start: ``strain_energy`` is the passive one, ``external_work`` that of loads and
    moved supports, ``dissipated_energy`` what viscous damping took, and ``energy_imbalance`` = kinetic +
    strain + dissipated - active and external work what the method made (or, negative, lost).
    ``sub_steps`` is the number of time steps since the frame before, ``shortest_step`` the shortest of
    them, and ``local_error`` the largest error that one of them added to a displacement, relative to
    the film's diagonal.
    """

    stored_as: ClassVar[str] = "zarr"

    time: Array = array("ms", "time")
    displacement: Array = array("mm", "time", "control_point", "xyz")
    velocity: Array = array("mm/ms", "time", "control_point", "xyz")
    acceleration: Array = array("mm/ms^2", "time", "control_point", "xyz")
    kinetic_energy: Array = array("kPa mm^3", "time")
    strain_energy: Array = array("kPa mm^3", "time")
    active_work: Array = array("kPa mm^3", "time")
    external_work: Array = array("kPa mm^3", "time")
    dissipated_energy: Array = array("kPa mm^3", "time")
    energy_imbalance: Array = array("kPa mm^3", "time")
    newton_iterations: Array = array("1", "time")
    sub_steps: Array = array("1", "time")
    shortest_step: Array = array("ms", "time")
    local_error: Array = array("1", "time")
    fibre_stretch: Array = array("1", "time", "quadrature_point", stored="float32")
    active_stress: Array = array("kPa", "time", "quadrature_point", stored="float32")


@dataclass(frozen=True)
class Equilibria:
    """Quasi-static shapes of the shell, one for each frame of its loading (eqs. 45, 52).

    ``time`` orders the loading and has no inertia to act on. What acts in a frame is what the time laws
    say at its time, and ``load_factor`` is 1. Control by arc length is different: what acts is the preload plus
    ``load_factor`` times what is added to it up to the last instant, ``time`` merely numbers the points of the
    path by i duration/n_steps, and ``limit_loads`` and ``bifurcation_loads`` are the load factors of the critical points
    passed, in their order. ``external_work`` is what loads and moved
    supports have done since the unloaded film, ``strain_energy`` is the passive one. ``load_step`` is
    the smallest part of a frame's interval that had to be taken on its own (NaN by arc length), and
    ``unstable_directions`` the number of negative pivots of the tangent: zero where the shape is
    stable. Fibres as in :class:`Deformation`.
    """

    stored_as: ClassVar[str] = "zarr"

    time: Array = array("ms", "time")
    displacement: Array = array("mm", "time", "control_point", "xyz")
    strain_energy: Array = array("kPa mm^3", "time")
    external_work: Array = array("kPa mm^3", "time")
    newton_iterations: Array = array("1", "time")
    load_step: Array = array("ms", "time")
    load_factor: Array = array("1", "time")
    unstable_directions: Array = array("1", "time")
    limit_loads: Array = array("1", "limit_point")
    bifurcation_loads: Array = array("1", "bifurcation")
    fibre_stretch: Array = array("1", "time", "quadrature_point", stored="float32")
    active_stress: Array = array("kPa", "time", "quadrature_point", stored="float32")


@dataclass(frozen=True)
class BucklingModes:
    """Factors of a loading that buckle the film, smallest modulus first, and how it buckles.

    Negative factors belong to the reversed loading. The largest displacement of a mode is 1.
    """

    factors: Array = array("1", "mode")
    shapes: Array = array("1", "mode", "control_point", "xyz")


@dataclass(frozen=True)
class ShapeMeasures:
    """What an experimenter would read off a film under imposed activation, over time.

    ``tip`` is the displacement of the middle of the free edge, ``turning`` the largest angle between
    two tangents of the mid-axis, ``mean_active_stress`` a mean over the film. ``load_factor`` is that of
    :class:`Equilibria`, 1 for a film in motion.
    """

    probe_names: tuple[str, ...]
    time: Array = array("ms", "time")
    load_factor: Array = array("1", "time")
    probe_points: Array = array("mm", "probe", "xyz")
    displacement: Array = array("mm", "time", "probe", "xyz")
    fibre_stretch: Array = array("1", "time", "probe")
    active_stress: Array = array("kPa", "time", "probe")
    tip: Array = array("mm", "time", "xyz")
    projected_length: Array = array("mm", "time")
    curvature: Array = array("1/mm", "time")
    turning: Array = array("degree", "time")
    mean_active_stress: Array = array("kPa", "time")

    @property
    def along_path(self) -> bool:
        """Whether the frames are points of a path along which the load factor varies."""
        return bool((self.load_factor != 1.0).any())


@dataclass(frozen=True)
class StudyTable:
    """Result of a verification study: named columns with units, and perhaps a field to look at.

    ``sampled`` holds X, Y, Z and the field on a grid of parameters.
    """

    columns: tuple[str, ...]
    units: tuple[str, ...]
    values: Array = array("", "row", "column")
    sampled: Array | None = field(
        default=None, metadata={"unit": "", "axes": ("theta1", "theta2", "xyzv")}
    )

    def column(self, name: str) -> Array:
        """One column, shape ``(row,)``."""
        found: Array = self.values[:, self.columns.index(name)]
        return found


@dataclass(frozen=True)
class TipPaths:
    """Tips of spiral waves, followed through the frames: a row per tip and frame, path by path.

    ``number`` counts the paths from 1, ``chirality`` is 1 for a wave that turns counter-clockwise
    (seen against **a**3) and -1 for one that turns clockwise, ``heading`` the direction of the
    potential's gradient at the tip, in degrees from the first tangent towards the second; along a path
    it is unwrapped, so that one turn of the wave adds 360 or takes away as much.
    """

    time: Array = array("ms", "row")
    number: Array = array("1", "row")
    position: Array = array("mm", "row", "xyz")
    chirality: Array = array("1", "row")
    heading: Array = array("degree", "row")


@dataclass(frozen=True)
class Measures:
    """What an experimenter would read off the film: tables over time and over probes.

    Beats of a probe are interpolated between the collocation points around it; see
    :class:`ActivationHistory` for what is measured. ``tips`` has no rows where none were looked for.
    """

    probe_names: tuple[str, ...]
    tips: TipPaths
    time: Array = array("ms", "time")
    probe_points: Array = array("mm", "probe", "xyz")
    displacement: Array = array("mm", "time", "probe", "xyz")
    active_stress: Array = array("kPa", "time", "probe")
    potential: Array = array("mV", "time", "probe")
    projected_length: Array = array("mm", "time")
    curvature: Array = array("1/mm", "time")
    activation_times: Array = array("ms", "probe", "beat")
    repolarisation_times: Array = array("ms", "probe", "beat")
    apd50: Array = array("ms", "probe", "beat")
    apd90: Array = array("ms", "probe", "beat")
    peak_potential: Array = array("mV", "probe", "beat")
    peak_active_stress: Array = array("kPa", "probe", "beat")
    conduction_velocity: Array = array("mm/ms", "beat")
