"""Shapes of films: areas, curvatures, lengths and places, and what no film can be."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from pipeline.canonical import canonical
from stages.geometry.bending import ring
from stages.geometry.config import FilmConfig, MeshConfig
from stages.geometry.films import active_mid_surface, film_patch
from stages.geometry.free_surface import FreeSurface
from stages.numerics.bsplines import Array
from stages.numerics.film_lengths import FilmLengths
from stages.numerics.patches import Patch
from stages.numerics.quadrature import quadrature_grid
from stages.numerics.surface_geometry import SurfaceFrame, frame_on_grid
from tests.problems import observed_orders

LENGTH, WIDTH = 3.5, 2.0
MESH = MeshConfig(elements=(40, 24), degree=3)
GRID = np.linspace(0.0, 1.0, 17)

SHAPES: dict[str, Mapping[str, Any]] = {
    "flat": {"name": "flat"},
    "scroll": {"name": "cylinder", "radius": 1.4, "axis": "Y"},
    "long scroll": {"name": "cylinder", "radius": 0.7, "axis": "Y", "inside": "bottom"},
    "gutter": {"name": "cylinder", "radius": 0.8, "axis": "X"},
    "tube": {"name": "tube", "axis": "X"},
    "ring": {"name": "tube", "axis": "Y", "inside": "bottom"},
    "sphere": {"name": "sphere-segment", "radius": 1.5},
    "ball": {"name": "sphere-segment", "radius": 1.5, "inside": "bottom"},
}


def film(shape: Mapping[str, Any], length: float = LENGTH, width: float = WIDTH) -> FilmConfig:
    return FilmConfig(
        length=length,
        width=width,
        substrate_thickness=0.018,
        active_thickness=0.004,
        fibre_angle=0.0,
        shape=dict(shape),
    )


def patch_of(name: str, mesh: MeshConfig = MESH) -> Patch:
    return film_patch(film(SHAPES[name]), mesh)


def frame_of(patch: Patch, theta: Array = GRID) -> SurfaceFrame:
    return frame_on_grid(patch, theta, theta)


def area(patch: Patch) -> float:
    grid = quadrature_grid(patch, 6)
    frame = frame_on_grid(patch, grid.theta1, grid.theta2)
    return float(frame.area @ np.outer(grid.weights1, grid.weights2).ravel())


def bends(frame: SurfaceFrame) -> Array:
    """Principal curvatures, in increasing order, shape ``(point, 2)``."""
    mixed = np.linalg.eigvals(frame.curvature @ frame.metric_con)
    return np.sort(mixed.real, axis=1)


@pytest.mark.parametrize("name", ["flat", "scroll", "long scroll", "gutter", "tube", "ring"])
def test_bending_keeps_the_area(name: str) -> None:
    # exact arcs to rounding; splines of the right length have the right area, too
    assert area(patch_of(name)) == pytest.approx(LENGTH * WIDTH, rel=1e-12)


def test_a_segment_of_a_sphere_has_its_area() -> None:
    exact = 1.5**2 * (LENGTH / 1.5) * 2.0 * math.sin(0.5 * WIDTH / 1.5)
    assert area(patch_of("sphere")) == pytest.approx(exact, rel=1e-10)  # Gauss rule


@pytest.mark.parametrize(
    ("name", "expected", "tolerance"),
    [
        ("flat", (0.0, 0.0), 1e-12),
        ("scroll", (0.0, 1 / 1.4), 1e-11),
        ("gutter", (0.0, 1 / 0.8), 1e-11),
        ("sphere", (1 / 1.5, 1 / 1.5), 1e-10),
        ("ball", (-1 / 1.5, -1 / 1.5), 1e-10),
        # cubic splines through an arc: second derivatives to h^2 k^2/12 or so, h k = 0.13 and 0.26
        ("long scroll", (-1 / 0.7, 0.0), 2e-3 / 0.7),
        ("tube", (0.0, math.pi), 6e-3 * math.pi),
        ("ring", (-2 * math.pi / LENGTH, 0.0), 3e-3 * math.pi),
    ],
)
def test_the_film_is_bent_towards_its_inner_face(
    name: str, expected: tuple[float, float], tolerance: float
) -> None:
    found = bends(frame_of(patch_of(name)))
    assert np.abs(found - expected).max() < tolerance


@pytest.mark.parametrize("name", ["flat", "scroll", "long scroll", "gutter", "sphere", "ball"])
def test_the_film_leaves_its_first_edge_as_a_flat_one(name: str) -> None:
    frame = frame_on_grid(patch_of(name), np.array([0.0]), np.array([0.5]))
    np.testing.assert_allclose(frame.position, [[0.0, 0.5 * WIDTH, 0.0]], atol=1e-14)
    # exact, but for the slope at the end of a cubic spline over 125 mrad a span: h^3/40 or so
    np.testing.assert_allclose(frame.normal, [[0.0, 0.0, 1.0]], atol=5e-5)
    assert frame.tangents[0, 0, 0] > 0


@pytest.mark.parametrize("name", SHAPES)
def test_the_muscle_lies_nine_micrometres_above_the_middle(name: str) -> None:
    mesh = MeshConfig(elements=(60, 40), degree=3)
    frame = frame_of(patch_of(name, mesh))
    cells = active_mid_surface(film(SHAPES[name]), mesh).patch
    gap = cells.evaluate(GRID, GRID) - frame.position
    # exact at the Greville points; between them a tube's spline is off by 9 um times h^4
    np.testing.assert_allclose(np.einsum("px,px->p", gap, frame.normal), 0.009, atol=2e-8)
    film_lengths, cell_lengths = (FilmLengths(p) for p in (patch_of(name, mesh), cells))
    assert cell_lengths.size == pytest.approx((LENGTH, WIDTH), rel=1e-14)
    for along, wanted in zip(cell_lengths.grid(), film_lengths.grid(), strict=True):
        # X and Y of the film: 9 um over radii above 0.3 mm would show; splines of tubes err by h^4
        np.testing.assert_allclose(along, wanted, rtol=0, atol=1e-6)


@given(st.floats(1.2, 20.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_x_and_y_are_lengths_along_a_cylinder(radius: float, x: float, y: float) -> None:
    shape = {"name": "cylinder", "radius": radius, "axis": "Y"}
    patch = film_patch(film(shape), MeshConfig(elements=(6, 3), degree=2))
    theta = FilmLengths(patch).parameters(np.array([(x * LENGTH, y * WIDTH)]))
    turn = x * LENGTH / radius
    exact = (radius * math.sin(turn), y * WIDTH, radius * (1.0 - math.cos(turn)))
    # rounding, and 1 - cos of small angles
    np.testing.assert_allclose(patch.evaluate_points(theta), [exact], atol=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_lengths_and_parameters_are_inverse_to_one_another(name: str) -> None:
    lengths = FilmLengths(patch_of(name))
    for direction, size in enumerate((LENGTH, WIDTH)):
        wanted = np.linspace(0.0, size, 23)
        theta = lengths.parameters_along(direction, wanted)
        np.testing.assert_allclose(lengths.along(direction, theta), wanted, atol=1e-13)


@pytest.mark.parametrize("name", SHAPES)
def test_parameters_mean_the_same_points_on_every_mesh(name: str) -> None:
    coarse = patch_of(name, MeshConfig(elements=(40, 24), degree=2))
    fine = patch_of(name, MeshConfig(elements=(102, 60), degree=3))
    gap = coarse.evaluate(GRID, GRID) - fine.evaluate(GRID, GRID)
    # exact shapes to rounding; a quadratic tube of 24 spans and radius 0.3 mm to h^3
    assert np.abs(gap).max() < (5e-5 if name in ("tube", "ring", "long scroll") else 1e-13)


def test_a_flat_film_is_what_it_always_was() -> None:
    mesh = MeshConfig(elements=(50, 10), degree=2)
    patch, exact = patch_of("flat", mesh), Patch.rectangle(LENGTH, WIDTH).refine(2, (50, 10))
    np.testing.assert_array_equal(patch.control_points, exact.control_points)
    assert (patch.weights, patch.extent, patch.closed) == (None, None, (False, False))


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_a_tube_is_smooth_across_its_seam(degree: int) -> None:
    mesh = MeshConfig(elements=(8, 24), degree=degree)
    for patch in (patch_of("tube", mesh), active_mid_surface(film(SHAPES["tube"]), mesh).patch):
        assert patch.closed == (False, True)
        ends = [frame_on_grid(patch, GRID, np.array([y])) for y in (0.0, 1.0)]
        for field in ("position", "tangents", "normal"):
            one, two = (getattr(end, field) for end in ends)
            np.testing.assert_allclose(one, two, atol=1e-12)  # rounding of the solves


def test_a_ring_is_round_to_the_fourth_power_of_the_mesh_size() -> None:
    errors = []
    for elements in (12, 24, 48):
        curve = ring(2.0 * math.pi, 2, elements)
        theta = np.linspace(0.0, 1.0, 301)
        points = curve.space.evaluate(theta) @ curve.points - (0.0, 1.0)
        errors.append(np.abs(np.linalg.norm(points, axis=1) - 1.0).max())
    assert observed_orders(np.array(errors)).min() > 3.8
    assert errors[-1] < (2.0 * math.pi / 48) ** 4 / 100  # h^4/128


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        (
            {"name": "cylinder", "radius": 0.5, "axis": "Y"},
            r"length of 3.5 mm goes 1.11 times around.*radius must be above 0.557 mm",
        ),
        ({"name": "cylinder", "radius": 0.3, "axis": "X"}, r"width of 2 mm goes 1.06 times"),
        ({"name": "cylinder", "radius": -1.0, "axis": "Y"}, "greater than 0"),
        (
            {"name": "sphere-segment", "radius": 1.0},
            r"length of 3.5 mm on a sphere of radius 1 mm opens by 200.5 degrees.*at least 1.18 mm",
        ),
        ({"name": "sfere"}, "choose one of: cylinder, flat, free-form, sphere-segment, tube"),
        ({"name": "free-form"}, "needs a file, or points, with 3 rows and 3 columns at least"),
    ],
)
def test_an_impossible_shape_is_refused(shape: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        film(shape)


def test_a_film_too_thick_to_be_bent_is_refused() -> None:
    with pytest.raises(
        ValidationError, match=r"0.022 mm thick is too thick .* radius of 0.09549 mm"
    ):
        film({"name": "tube", "axis": "X"}, length=3.5, width=0.6)


def points_of(name: str, rows: int = 14, columns: int = 9) -> tuple[tuple[Any, ...], ...]:
    """Grid of points on another shape, unevenly spaced."""
    uneven = [np.linspace(0.0, 1.0, n) ** 1.2 for n in (rows, columns)]
    grid = patch_of(name).evaluate(*uneven).reshape(rows, columns, 3)
    return tuple(tuple(tuple(map(float, point)) for point in row) for row in grid)


@pytest.mark.parametrize("name", ["flat", "scroll", "gutter"])
def test_a_surface_through_points_of_a_cylinder_is_near_to_it(name: str) -> None:
    free = film_patch(film({"name": "free-form", "points": points_of(name)}), MESH)
    exact = patch_of(name)
    lines = np.linspace(0.0, 3.5, 9), np.linspace(0.0, 2.0, 9)
    places = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
    found, wanted = (
        patch.evaluate_points(FilmLengths(patch).parameters(places)) for patch in (free, exact)
    )
    # cubics through 14 points over a turn of 2.5: (0.2)^4/24 or so
    assert np.abs(found - wanted).max() < 2e-4


@pytest.mark.parametrize(("name", "radius"), [("scroll", 1.4), ("gutter", 0.8)])
def test_a_surface_through_points_knows_its_smallest_radius(name: str, radius: float) -> None:
    # cubics through 9 and 14 uneven points; their second derivatives are off by h^2 at the ends
    assert FreeSurface.through(points_of(name)).smallest_radius() == pytest.approx(radius, rel=0.1)


def write_points(path: Path, points: tuple[tuple[Any, ...], ...]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("row", "column", "x", "y", "z"))
        rows = [(i, j, *p) for i, row in enumerate(points) for j, p in enumerate(row)]
        writer.writerows(reversed(rows))  # in any order


def test_the_points_enter_the_key_and_the_path_does_not(tmp_path: Path) -> None:
    points = points_of("scroll")
    for name in ("a.csv", "b.csv"):
        write_points(tmp_path / name, points)
    films = [film({"name": "free-form", "file": str(tmp_path / f)}) for f in ("a.csv", "b.csv")]
    given = film({"name": "free-form", "points": points})
    assert canonical(films[0]) == canonical(films[1]) == canonical(given)
    moved = (((0.0, 0.0, 0.01), *points[0][1:]), *points[1:])
    assert canonical(film({"name": "free-form", "points": moved})) != canonical(given)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no points"),
        ("0,0,1,2\n", "line 1, '0,0,1,2', is not five finite numbers"),
        ("row,column,x,y,z\n0,0,1,nan,3\n", "line 2, .* is not five finite numbers"),
        ("0.5,0,1,2,3\n", "does not begin with a row and a column"),
        ("0,0,1,2,3\n0,0,1,2,4\n", "gives row 0, column 0 a second time"),
        ("0,0,1,2,3\n1,1,1,2,4\n", "has no point in row 0, column 1"),
        ("2,0,1,2,3\n", "has no row 0 and no row 1"),
    ],
)
def test_a_file_that_is_no_grid_is_refused(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text(text)
    with pytest.raises(ValidationError, match=message):
        film({"name": "free-form", "file": str(path)})


def test_a_missing_file_and_wrong_lengths_are_told(tmp_path: Path) -> None:
    with pytest.raises(ValidationError, match="cannot be read: No such file"):
        film({"name": "free-form", "file": str(tmp_path / "none.csv")})
    with pytest.raises(ValidationError, match=r"length of the surface .* is 3\.5.* set it to 3\.5"):
        film({"name": "free-form", "points": points_of("flat")}, length=3.0)
    twice = (points_of("flat")[0],) * 3
    with pytest.raises(ValidationError, match=r"points of rows 0 and 1 .* coincide"):
        film({"name": "free-form", "points": twice})
