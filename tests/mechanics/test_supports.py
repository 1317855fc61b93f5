"""Supports: what they hold, what they leave free, and what they refuse."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from stages.mechanics.body.body import Body
from stages.mechanics.body.constraints import constrain
from stages.mechanics.body.rigid import FreeMotionError, check_is_held
from stages.mechanics.config import EquilibriumConfig
from stages.mechanics.supports.base import Support
from stages.mechanics.supports.clamped import Clamped
from stages.mechanics.supports.clamped_normal import ClampedNormal
from stages.mechanics.supports.displacement import Displacement
from stages.mechanics.supports.free import Free
from stages.mechanics.supports.hinged import Hinged
from stages.mechanics.supports.point import Point
from stages.mechanics.supports.symmetry import Symmetry
from stages.numerics.bsplines import Array
from stages.numerics.collocation import EDGES
from stages.numerics.newton import newton
from stages.numerics.patches import Patch
from stages.numerics.shapes import cylindrical_panel
from stages.numerics.surface_geometry import frame_on_grid
from stages.time_laws.constant import Constant
from tests.mechanics import films

ROTATIONS = st.integers(0, 1000).map(films.rotation)


def fixed_by(patch: Patch, support: Support) -> Array:
    ties = constrain(patch, {"support": support}).ties
    assert not ties.slaves.size
    return ties.dependent.reshape(patch.control_points.shape)


def turned(patch: Patch, rotation: Array) -> Patch:
    return patch.with_net(patch.control_points @ rotation.T)


def moved_at_random(patch: Patch, supports: dict[str, Support], size: float = 1.0) -> Patch:
    """The film after a random displacement that its supports admit."""
    ties = constrain(patch, supports).ties
    u = size * np.random.default_rng(0).normal(size=3 * patch.size)
    u = ties.admissible(u, np.zeros(ties.offsets.shape[1]))
    return patch.with_net(patch.control_points + u.reshape(patch.control_points.shape))


@pytest.mark.parametrize(
    ("edge", "rows"),
    [("X=0", np.s_[:2]), ("X=L1", np.s_[-2:]), ("Y=0", np.s_[:, :2]), ("Y=L2", np.s_[:, -2:])],
)
def test_a_clamp_holds_two_rows_of_control_points(edge: str, rows: Any) -> None:
    fixed = fixed_by(films.flat((4, 3)), Clamped(edge=edge))
    expected = np.zeros_like(fixed)
    expected[rows] = True
    np.testing.assert_array_equal(fixed, expected)


def test_a_clamp_of_the_normal_lets_the_edge_stretch() -> None:
    fixed = fixed_by(films.flat((4, 2)), ClampedNormal(edge="X=0"))
    assert fixed[0].all()
    assert fixed[1, :, 2].all()
    assert not fixed[1, :, :2].any()
    assert not fixed[2:].any()


@settings(deadline=None, max_examples=20)
@given(rotation=ROTATIONS, edge=st.sampled_from(EDGES))
def test_a_clamped_normal_keeps_the_edge_from_turning_whatever_its_direction(
    rotation: Array, edge: str
) -> None:
    """To first order: the change of the normal across the edge is a_3 . u_,across."""
    patch = turned(films.flat((3, 4)), rotation)
    moved = moved_at_random(patch, {"clamp": ClampedNormal(edge=edge)}, size=1e-6)
    along = np.linspace(0, 1, 7)
    theta = ([float(edge == "X=L1")], along) if edge[0] == "X" else (along, [float(edge == "Y=L2")])
    before, after = (frame_on_grid(p, *map(np.asarray, theta)) for p in (patch, moved))
    # displacements of 1e-6 turn by their square
    assert np.abs(after.normal - before.normal).max() < 1e-9
    assert np.abs(after.position - before.position).max() < 1e-15 * 4


def test_a_clamped_normal_on_a_curved_edge_holds_its_rotation_at_the_greville_points() -> None:
    patch = cylindrical_panel(2.0, 3.0, (-40.0, 40.0)).refine(3, (4, 5))
    moved = moved_at_random(patch, {"clamp": ClampedNormal(edge="X=0")}, size=1e-6)
    theta = np.zeros(1), patch.second.greville()
    before, after = (frame_on_grid(p, *theta) for p in (patch, moved))
    # displacements of 1e-6 turn by their square
    assert np.abs(after.normal - before.normal).max() < 1e-9


@settings(deadline=None, max_examples=20)
@given(rotation=ROTATIONS, edge=st.sampled_from(EDGES))
def test_a_symmetric_film_goes_on_smoothly_as_its_mirror_image(rotation: Array, edge: str) -> None:
    """After any displacement the tangent across the edge stands on the plane, and the edge lies in it."""
    patch = turned(films.flat((3, 4)), rotation)
    moved = moved_at_random(patch, {"mirror": Symmetry(edge=edge)}, size=0.05)
    normal = rotation @ np.eye(3)[0 if edge[0] == "X" else 1]
    along = np.linspace(0, 1, 7)
    place = np.array([float(edge in ("X=L1", "Y=L2"))])
    theta = (place, along) if edge[0] == "X" else (along, place)
    frame = frame_on_grid(moved, *theta)
    assert np.ptp(frame.position @ normal) < 1e-13
    across = frame.tangents[:, 0 if edge[0] == "X" else 1]
    assert np.abs(across - np.outer(across @ normal, normal)).max() < 1e-12
    assert np.abs(frame.normal @ normal).max() < 1e-12


def test_an_edge_that_its_film_meets_at_an_angle_is_no_edge_of_symmetry() -> None:
    net = films.flat((3, 3)).control_points.copy()
    net[..., 0] += 0.3 * net[..., 1]
    skewed = films.flat((3, 3)).with_net(net)
    with pytest.raises(ValueError, match=r"'mirror' \(symmetry\): the edge Y=0 is no edge of sym"):
        constrain(skewed, {"mirror": Symmetry(edge="Y=0")})


def test_a_hinge_holds_the_edge_and_nothing_else() -> None:
    fixed = fixed_by(films.flat((4, 3)), Hinged(edge="Y=0", components=("z", "x")))
    assert fixed[:, 0, [0, 2]].all()
    assert fixed.sum() == 2 * fixed.shape[0]


def test_a_point_inside_the_film_is_moved_to_where_it_should_be() -> None:
    patch = films.uneven()
    support = Point(position=(1.23, 0.77), x=0.1, z=-0.2, time_law=Constant())
    constraints = constrain(patch, {"grip": support})
    u = np.random.default_rng(0).normal(size=3 * patch.size)
    u = constraints.ties.admissible(u, np.array([0.5]))
    moved = patch.with_net(patch.control_points + u.reshape(patch.control_points.shape))
    gap = moved.evaluate([1.23 / 3.5], [0.77 / 2.0]) - [1.23 + 0.05, 0.77, -0.1]
    # the point is found to 1e-10 of the film's size
    assert np.abs(gap[0, [0, 2]]).max() < 1e-9
    assert abs(gap[0, 1]) > 1e-3


def test_a_point_outside_the_film_is_refused() -> None:
    with pytest.raises(ValueError, match=r"support 'grip' \(point\): the point .* does not lie on"):
        constrain(films.flat(), {"grip": Point(position=(4.0, 1.0), z=0.0)})


def test_supports_that_meet_in_a_corner_agree() -> None:
    supports: dict[str, Support] = {
        "clamp": Clamped(edge="X=0"),
        "mirror": Symmetry(edge="Y=0"),
        "far": Symmetry(edge="X=L1"),
    }
    body = Body.held(films.shell(films.flat((3, 3))), supports)
    check_is_held(body)


def test_supports_that_contradict_each_other_are_named() -> None:
    supports: dict[str, Support] = {
        "clamp": Clamped(edge="X=0"),
        "pull": Displacement(edge="X=0", x=0.1, time_law=Constant()),
    }
    with pytest.raises(ValueError, match="'pull' moves what support 'clamp' holds or moves other"):
        constrain(films.flat((3, 2)), supports)


def test_a_support_that_adds_nothing_is_named() -> None:
    supports: dict[str, Support] = {"clamp": Clamped(edge="X=0"), "hinge": Hinged(edge="X=0")}
    with pytest.raises(ValueError, match="'hinge' holds nothing that other supports do not hold"):
        constrain(films.flat((3, 2)), supports)


@pytest.mark.parametrize(
    ("supports", "motion"),
    [
        ({}, "shift along X, shift along Y, shift along Z, turn about"),
        ({"free": Free()}, "shift along X"),
        ({"hinge": Hinged(edge="X=0")}, r"turn about the line through \(0, 1, 0\) mm along Y"),
        ({"roller": Clamped(edge="X=0"), "x": Free()}, None),
        ({"mirror": Symmetry(edge="Y=0")}, "shift along X, shift along Z, turn about"),
        ({"a": Hinged(edge="X=0", components=("x", "z")), "b": Hinged(edge="X=L1", components=("z",))}, "shift along Y"),
        ({"grip": Point(position=(1.0, 0.5), x=0.0, y=0.0, z=0.0)}, r"0\.5, 0\) mm along X, turn about the line through \(1, .*, 0\) mm along Y, turn .* \(1, 0\.5, 0\) mm along Z"),
    ],
)  # fmt: skip
def test_a_rigid_motion_that_is_free_is_named(
    supports: dict[str, Support], motion: str | None
) -> None:
    body = Body.held(films.shell(films.flat((3, 2))), supports)
    if motion is None:
        check_is_held(body)
    else:
        with pytest.raises(FreeMotionError, match=motion) as failure:
            check_is_held(body)
        assert "mechanics.supports" in failure.value.remedy


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("support", [Clamped, ClampedNormal])
def test_a_clamped_film_has_no_rigid_motion_left(support: type[Any], edge: str) -> None:
    patch = turned(films.flat((3, 2)), films.rotation(3))
    check_is_held(Body.held(films.shell(patch), {"clamp": support(edge=edge)}))


def test_a_film_that_can_deform_for_nothing_is_refused() -> None:
    """Fewer Gauss points than the configuration allows leave an hourglass."""
    from stages.mechanics.shell.shell import build_shell

    thin = build_shell(films.flat((3, 3)), films.two_layers(), films.MATERIALS, plane_points=1)
    with pytest.raises(FreeMotionError, match="can deform without resistance"):
        check_is_held(Body.held(thin, films.CLAMP))


def test_a_moved_edge_takes_the_film_along_in_one_smooth_step() -> None:
    """The film is turned by a large lift of its far edge; no element is torn, and Newton goes home."""
    supports: dict[str, Support] = {
        "clamp": Clamped(edge="X=0"),
        "lift": Displacement(edge="X=L1", z=0.5, time_law=Constant()),
    }
    body = Body.held(films.shell(films.flat((8, 2))), supports)
    start = np.zeros(body.shell.size)
    for part in np.linspace(0.1, 1.0, 10):
        acting = body.nothing().towards(body.imposed_at(0.0, np.zeros(body.shell.points)), part)
        start = newton(
            lambda u, acting=acting: body.linearise(u, acting), start, films.controls(body.shell)
        ).x
    net = start.reshape(10, 4, 3)
    np.testing.assert_allclose(net[-1, :, 2], 0.5, rtol=1e-14)
    assert np.all(np.diff(net[1:, 1, 2]) > 0)
    assert np.all(net[-1, :, 0] < -0.02)  # it is drawn in: an inextensible line of length 3.5


@pytest.mark.parametrize("name", ["flat", "roof"])
def test_a_moved_edge_may_keep_its_direction(name: str) -> None:
    roof = cylindrical_panel(2.0, 3.0, (-40.0, 40.0)).refine(3, (4, 5))
    patch = films.flat((3, 4)) if name == "flat" else roof
    support = Displacement(edge="X=L1", x=1e-6, y=0.0, z=2e-6, rotation="held", time_law=Constant())
    constraints = constrain(patch, {"lift": support})
    u = 1e-6 * np.random.default_rng(0).normal(size=3 * patch.size)
    u = constraints.ties.admissible(u, np.ones(1))
    moved = patch.with_net(patch.control_points + u.reshape(patch.control_points.shape))
    theta = np.ones(1), patch.second.greville()
    before, after = (frame_on_grid(p, *theta) for p in (patch, moved))
    # displacements of 1e-6 turn by their square
    assert np.abs(after.normal - before.normal).max() < 1e-9
    np.testing.assert_allclose(after.position[:, 2] - before.position[:, 2], 2e-6, rtol=1e-8)


def test_the_first_correction_foresees_a_moved_support() -> None:
    """In a linear range one correction is enough, from a start that violates the constraint."""
    supports: dict[str, Support] = {
        "clamp": ClampedNormal(edge="X=0"),
        "pull": Displacement(edge="X=L1", x=1e-9, y=0.0, z=0.0, time_law=Constant()),
    }
    body = Body.held(films.shell(films.flat((4, 2))), supports)
    acting = body.imposed_at(0.0, np.zeros(body.shell.points))
    zero = np.zeros(body.shell.size)
    system = body.linearise(zero, acting)
    first = system.solve(-system.residual)
    again = body.linearise(first, acting)
    # the bending film's squares: (1e-8 mm / 22 um)^2 against a strain of 3e-10, and round-off
    assert np.abs(again.solve(-again.residual)).max() < 1e-4 * np.abs(first).max()
    np.testing.assert_allclose(
        body.rate(zero, body.nothing(), acting), first, rtol=1e-9, atol=1e-18
    )
    np.testing.assert_allclose(first.reshape(6, 4, 3)[-1, :, 0], 1e-9, rtol=1e-12)


def test_the_work_of_a_moved_support_is_the_energy_of_the_film() -> None:
    """Stretched by 1 per cent in ten parts; the trapezoidal rule is exact to the third order."""
    supports: dict[str, Support] = {
        "clamp": ClampedNormal(edge="X=0"),
        "pull": Displacement(edge="X=L1", x=0.035, y=0.0, z=0.0, time_law=Constant()),
    }
    body = Body.held(films.shell(films.flat((4, 2))), supports)
    silent = np.zeros(body.shell.points)
    u, acting, work = np.zeros(body.shell.size), body.nothing(), 0.0
    for part in np.linspace(0.1, 1.0, 10):
        last, before = u, acting
        acting = body.nothing().towards(body.imposed_at(0.0, silent), part)
        u = newton(
            lambda x, acting=acting: body.linearise(x, acting), last, films.controls(body.shell)
        ).x
        work += body.work_between(last, before, u, acting)
    energy = body.shell.respond(u, silent).energy
    # (strain per part)^2 of 1e-6, and the films' mild nonlinearity
    assert work == pytest.approx(energy, rel=1e-4)
    assert energy > 0


def config(**supports: Any) -> EquilibriumConfig:
    return EquilibriumConfig(
        elements=(3, 2),
        degree=2,
        n_steps=1,
        duration=1.0,
        supports=supports,
        substrate=films.PDMS,
        active=films.MUSCLE,
        tension_law="prescribed",
    )


@pytest.mark.parametrize(
    ("support", "message"),
    [
        ({"kind": "glued", "edge": "X=0"}, "choose one of: clamped, clamped-normal"),
        ({"kind": "clamped", "edge": "X=1"}, "edge"),
        ({"kind": "hinged", "edge": "X=0", "components": ("w",)}, "components"),
        ({"kind": "hinged", "edge": "X=0", "components": ()}, "holds nothing"),
        ({"kind": "displacement", "edge": "X=0"}, "prescribes nothing"),
        ({"kind": "displacement", "edge": "X=0", "x": 1.0}, "needs a time_law"),
        ({"kind": "point", "x": 0.0}, "position"),
    ],
)
def test_a_bad_support_is_refused(support: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        config(label=support)


def test_a_support_is_taken_away_with_all_that_it_was_given() -> None:
    taken = {"kind": "free", "edge": "X=L1", "z": 0.2, "time_law": {"name": "constant"}}
    clamp = {"kind": "clamped", "edge": "X=0"}
    assert config(clamp=clamp, tip=taken).supports["tip"] == Free(edge="X=L1")


def test_a_support_that_moves_by_nothing_holds() -> None:
    held = config(label={"kind": "point", "position": (1.0, 1.0), "x": 0.0}).supports["label"]
    assert held.law is None


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize(
    "patch", [films.rational(), films.arched()], ids=["rational", "polynomial"]
)
def test_a_moved_edge_that_keeps_its_rotation_may_deform_along_itself(
    patch: Patch, edge: Any
) -> None:
    """Z alone is prescribed; weights in no fixed ratio between the rows enter the slope of the edge."""
    support = Displacement(edge=edge, z=0.3, rotation="held", time_law=Constant())
    ties = constrain(patch, {"edge": support}).ties
    shaken = 0.1 * np.random.default_rng(1).normal(size=3 * patch.size)
    moved = ties.admissible(shaken, np.ones(1)).reshape(-1, 3)
    across = 0 if edge.startswith("X") else 1
    theta = [space.greville() for space in patch.spaces]
    theta[across] = theta[across][[0 if edge.endswith("=0") else -1]]
    points = np.stack([grid.ravel() for grid in np.meshgrid(*theta, indexing="ij")], axis=1)
    order = (1, 0) if across == 0 else (0, 1)
    slope = patch.functions(points, order) @ moved
    normal = frame_on_grid(patch, *theta).normal
    assert np.abs(slope).max() > 0.5
    # round-off of slopes of size one
    np.testing.assert_allclose(np.einsum("px,px->p", slope, normal), 0.0, atol=1e-13)
