"""The shell obstacle course: published tables, Fourier series, and one model against another."""

from __future__ import annotations

import numpy as np
import pytest

from stages.artefacts import Laminate, Layer, StudyTable
from stages.mechanics.body.constraints import constrain
from stages.mechanics.materials.st_venant_kirchhoff import StVenantKirchhoff
from stages.mechanics.shell.shell import build_shell
from stages.mechanics.supports.base import Support
from stages.mechanics.supports.hinged import Hinged
from stages.mechanics.supports.point import Point
from stages.mechanics.supports.symmetry import Symmetry
from stages.numerics.patches import Patch
from stages.numerics.shapes import cylindrical_panel, spherical_panel
from tests.verification.studies import broken_limits, table_of
from workflows.theory.pinched_cylinder import PinchedCylinder
from workflows.verification.linear_shells import area_load, point, solve
from workflows.verification.studies.hemisphere import Pole

ROOF = {
    2: (
        0.069489140101432,
        0.238098983889902,
        0.295702595727846,
        0.300237752650471,
        0.300558363037311,
    ),
    3: (
        0.279944686988951,
        0.300065498003107,
        0.300584157108943,
        0.300592331224518,
        0.300592454396341,
    ),
    4: (
        0.300000190520180,
        0.300589846259349,
        0.300592432120400,
        0.300592456541168,
        0.300592456632799,
    ),
}
"""Scordelis-Lo roof, 4 to 64 elements per side: data of J. Kiendl, as quoted by P. Krysl in
FinEtoolsFlexStructures.jl, scordelis_lo_examples.jl."""


def of_degree(table: StudyTable, degree: int, *, least: int = 0) -> np.ndarray:
    rows = (table.column("degree") == degree) & (table.column("elements") >= least)
    return table.column("displacement")[rows]


def test_the_scordelis_lo_roof_has_the_published_displacements_on_coarse_meshes() -> None:
    table = table_of("scordelis-lo", "elements=[4,8]")
    for degree, published in ROOF.items():
        # the stiffness of a shell 1/100 as thick as wide amplifies round-off by about 1e4
        np.testing.assert_allclose(of_degree(table, degree), published[:2], rtol=1e-10)


@pytest.mark.slow
def test_the_scordelis_lo_roof_has_the_published_displacements() -> None:
    table = table_of("scordelis-lo")
    for degree, published in ROOF.items():
        # round-off grows with the fourth power of the number of elements
        np.testing.assert_allclose(of_degree(table, degree, least=4), published, rtol=1e-10)
    assert broken_limits("scordelis-lo", table) == []
    # the metric of each depth changes the result by the square of thickness over radius
    change = table.column("varying_metric") / table.column("displacement") - 1.0
    assert np.abs(change).max() < 2 * (0.25 / 25.0) ** 2


def test_half_the_roof_with_a_plane_of_symmetry_is_the_whole_roof() -> None:
    """Quadratic splines are C1 over the middle knot: just what the tied rows of the half ones are."""
    whole = cylindrical_panel(25.0, 50.0, (-40.0, 40.0)).refine(2, (8, 6))
    half = cylindrical_panel(25.0, 25.0, (-40.0, 40.0)).refine(2, (4, 6))
    front, back = (Hinged(edge=edge, components=("y", "z")) for edge in ("X=0", "X=L1"))
    middle = Point(position=(25.0, 0.0), x=0.0)
    found = [
        sag(whole, {"front": front, "back": back, "middle": middle}, (0.5, 1.0)),
        sag(half, {"front": front, "middle": Symmetry(edge="X=L1")}, (1.0, 1.0)),
    ]
    # the same matrices but for round-off, amplified by the shell's condition
    assert found[0] == pytest.approx(found[1], rel=1e-9)


def sag(patch: Patch, supports: dict[str, Support], at: tuple[float, float]) -> float:
    solid = StVenantKirchhoff(density=1.0, young_modulus=4.32e8, poisson_ratio=0.0)
    laminate = Laminate((Layer("shell", "solid", 0.25, 0.0, 0.0),))
    shell = build_shell(patch, laminate, {"solid": solid})
    solution = solve(shell, supports, area_load(shell, (0.0, 0.0, -90.0)))
    return float(point(patch, at, (0.0, 0.0, -1.0)) @ solution)


def test_the_pole_has_the_same_planes_of_symmetry_as_edges_elsewhere() -> None:
    """On a patch with a hole the special support ties what the general one ties, but for the rim."""
    patch = spherical_panel(10.0, (0.0, 90.0), (0.0, 72.0)).refine(2, (3, 3))
    planes = constrain(patch, {"a": Symmetry(edge="X=0"), "b": Symmetry(edge="X=L1")}).ties
    pole = constrain(patch, {"pole": Pole()}).ties
    vector = np.random.default_rng(3).normal(size=3 * patch.size)
    vector.reshape(*patch.control_points.shape)[:, -2:] = 0.0
    np.testing.assert_allclose(planes.expand(vector), pole.expand(vector), rtol=0, atol=1e-15)


def test_the_fourier_series_of_the_pinched_cylinder_converges_at_second_order() -> None:
    case = PinchedCylinder(300.0, 600.0, 3.0, 3.0e6, 0.3, 1.0)
    sums = [case.partial_sum(waves) for waves in (80, 160, 320)]
    limit = case.displacement(320)
    rests = limit - np.array(sums)
    assert 3.7 < rests[0] / rests[1] < 4.3
    assert 3.7 < rests[1] / rests[2] < 4.3
    # the five digits of the literature are those of a sum that is not carried on
    assert case.partial_sum(130) == pytest.approx(1.8248e-5, rel=3e-5)


def test_a_coarse_pinched_cylinder_lies_below_the_series() -> None:
    """Fewer functions are stiffer: displacements under the load grow from mesh to mesh."""
    table = table_of("pinched-cylinder", "elements=[4,8]", "degrees=[3,4]")
    for degree in (3, 4):
        coarse, fine = of_degree(table, degree)
        assert coarse < fine < table.column("series")[0]


@pytest.mark.slow
def test_the_pinched_cylinder_settles_at_its_series() -> None:
    table = table_of("pinched-cylinder")
    assert broken_limits("pinched-cylinder", table) == []
    last = of_degree(table, 4)[-3:]
    # under a point force the error falls like the square of the mesh width, whatever the degree
    extrapolated = last[2] + (last[2] - last[1]) / 3
    assert extrapolated == pytest.approx(table.column("series")[0], rel=1e-4)


def test_a_coarse_quartic_hemisphere_is_right_to_one_per_cent() -> None:
    table = table_of("hemisphere", "elements=[8]", "degrees=[4]")
    assert table.column("displacement")[0] == pytest.approx(0.0924, rel=1e-2)


@pytest.mark.slow
def test_the_hemisphere_settles_at_the_published_value() -> None:
    table = table_of("hemisphere")
    assert broken_limits("hemisphere", table) == []
    assert of_degree(table, 3)[-1] == pytest.approx(of_degree(table, 4)[-1], rel=2e-5)


def test_a_hole_at_the_pole_makes_the_hemisphere_softer() -> None:
    """0.0940 of MacNeal and Harder; this shell settles at 0.09352."""
    table = table_of("hemisphere", "hole=18", "reference=0.094", "elements=[16]", "degrees=[4]")
    assert table.column("displacement")[0] == pytest.approx(0.0940, rel=1e-2)
