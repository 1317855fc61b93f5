"""Quasi-static bending under uniform active stress, against the closed form of a wide film."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stages.mechanics.shell.shell import Shell
from stages.mechanics.statics.equilibrium import UnreachedShapeError
from stages.mechanics.statics.loading import Loading
from stages.numerics.newton import newton
from stages.numerics.patches import Patch
from stages.numerics.quadrature import quadrature_grid
from stages.numerics.stepping import Attempt
from stages.numerics.surface_geometry import frame_on_grid
from tests.mechanics import films
from tests.mechanics.load_path import Equilibrium, LoadPath
from workflows.theory.bilayer import Bend, Ply, cylindrical, prescribed


def path(
    body: Shell, stress: float, increments: int, iterations: int = 15, max_halvings: int = 5
) -> LoadPath:
    held = films.clamped(body)
    return LoadPath(
        held,
        held.under(np.full(body.points, stress)),
        increments,
        films.controls(body, max_iterations=iterations),
        max_halvings,
    )


def bend(body: Shell, stress: float, increments: int) -> Equilibrium:
    *_, last = path(body, stress, increments).follow()
    return last.state


def closed_form(stress: float) -> Bend:
    """The paper's film (Table 1), far from its edges."""
    muscle = Ply(0.004, 0.767, 21.0, 5.5, prescribed(stress))
    return cylindrical([Ply(0.018, 500.0), muscle])


def mean_curvature(body: Shell, displacement: np.ndarray, theta1: float) -> float:
    """Curvature along X, averaged over the width."""
    net = body.patch.control_points
    moved = Patch(body.patch.first, body.patch.second, net + displacement.reshape(net.shape))
    grid = quadrature_grid(body.patch, 3)
    frame = frame_on_grid(moved, np.array([theta1]), grid.theta2)
    return float(grid.weights2 @ (frame.curvature[:, 0, 0] / frame.metric_cov[:, 0, 0]))


def test_the_closed_form_of_cylindrical_bending_is_in_balance_at_every_point() -> None:
    """The shell's section law, evaluated on the exact cylinder: N11 = M11 = N22 = 0."""
    stress = 12.2
    bent = closed_form(stress)
    lx, ly, k = bent.stretch_x, bent.stretch_y, bent.curvature_x
    body = films.shell(films.flat((12, 1), degree=5), films.two_layers(angle=0.0))
    grid = body.patch.evaluate(body.patch.first.greville(), body.patch.second.greville())
    arc = k * lx * grid[:, 0]
    shape = np.stack((np.sin(arc) / k, ly * grid[:, 1], (1 - np.cos(arc)) / k), axis=1)
    displacement = body.patch.interpolate(shape).control_points - body.patch.control_points
    found = body.respond(displacement.ravel(), np.full(body.points, stress)).resultants
    force = found.force * [3.5**2, 2.0**2, 7.0]  # components in mm instead of theta
    moment = found.moment * [3.5**2, 2.0**2, 7.0]
    scale = stress * 0.004
    # quintics over 0.3 mm reproduce an arc of radius 1.8 mm to 3e-9 in strain; times 2000 kPa * 22 um
    assert np.abs(force).max() < 1e-5 * scale
    assert np.abs(moment[:, 0]).max() < 1e-5 * scale * 0.009
    assert np.abs(moment[:, 1]).min() > 1e-2 * scale * 0.009  # the moment that keeps k2 = 0


def test_a_film_bends_as_the_closed_form_says_but_for_its_edges() -> None:
    """Along its sides a strip of order sqrt(R d) = 0.2 mm curls more; so the mean is a little higher."""
    body = films.shell(films.flat((8, 6), degree=3, length=2.0), films.two_layers(angle=0.0))
    last = bend(body, 12.2, increments=14)
    k = closed_form(12.2).curvature_x
    excess = mean_curvature(body, last.displacement, 0.6) / k - 1.0
    # a strip on each of the two sides of a 2 mm film, with at most a third more curvature in it
    assert 0.0 < excess < 2 * 0.2 / 2.0 / 3.0


@pytest.mark.slow
def test_the_edge_effect_fades_with_the_width_of_the_film() -> None:
    k = closed_form(12.2).curvature_x
    excess = []
    for width, elements in ((2.0, 8), (4.0, 16)):
        patch = films.flat((8, elements), degree=4, length=2.0, width=width)
        body = films.shell(patch, films.two_layers(angle=0.0))
        last = bend(body, 12.2, increments=14)
        excess.append(mean_curvature(body, last.displacement, 0.6) / k - 1.0)
    # side strips of fixed width: their share falls as 1/width, up to the clamp's influence
    assert excess[0] / excess[1] == pytest.approx(2.0, rel=0.1)


def test_the_end_of_the_path_does_not_depend_on_the_increments() -> None:
    body = films.shell(films.flat((6, 2)), films.two_layers(angle=0.0))
    few, many = bend(body, 6.0, increments=10), bend(body, 6.0, increments=17)
    # Newton leaves about the square of its last correction (4e-7 mm), times a factor of 1e2
    assert np.abs(few.displacement - many.displacement).max() < 1e-9


def test_one_increment_that_is_far_too_large_is_taken_in_steps_that_adapt() -> None:
    body = films.shell(films.flat((6, 2)), films.two_layers(angle=0.0))
    told: list[Attempt] = []
    (only,) = replace(path(body, 9.0, 1), listen=told.append).follow()
    assert only.state.factor == 1.0
    assert any(attempt.failure for attempt in told)
    assert only.smallest_step < 0.5
    found = [attempt for attempt in told if attempt.failure is None]
    assert found[-1].end == 1.0
    assert only.iterations == sum(len(attempt.history) for attempt in told)
    reference = bend(body, 9.0, increments=20)
    # as above
    assert np.abs(only.state.displacement - reference.displacement).max() < 1e-9


def test_a_small_first_step_grows() -> None:
    body = films.shell(films.flat((6, 2)), films.two_layers(angle=0.0))
    told: list[Attempt] = []
    list(replace(path(body, 9.0, 2), initial_increment=0.05, listen=told.append).follow())
    widths = [attempt.end - attempt.start for attempt in told]
    assert widths[0] == pytest.approx(0.025)
    assert max(widths) > 2.0 * widths[0]


def test_predicted_forces_in_the_tangent_save_iterations_and_change_no_result() -> None:
    """Three increments to 9 kPa, too large for the common tangent."""
    body = films.shell(films.flat((6, 2)), films.two_layers(angle=0.0))
    held = films.clamped(body)
    controls = films.controls(body)
    imposed = held.under(np.full(body.points, 3.0))
    start = np.zeros(body.size)
    loading = Loading(held, held.nothing(), imposed)
    predicted = newton(lambda u: loading.linearise(u, 1.0), start, controls)
    many = replace(controls, max_iterations=100)
    common = newton(lambda u: held.linearise(u, imposed), start, many)
    assert 2 * predicted.iterations < common.iterations
    assert np.abs(predicted.x - common.x).max() < 1e-9


def test_a_path_that_cannot_be_followed_keeps_what_was_found_and_says_where_it_ended() -> None:
    body = films.shell(films.flat((6, 2)), films.two_layers(angle=0.0))
    short = path(body, 4000.0, 2, iterations=4, max_halvings=1)
    with pytest.raises(UnreachedShapeError, match=r"a load step of 0\.25 ms leads on") as failure:
        next(short.follow())
    assert failure.value.place == "shape 1 (t = 0.5 ms)"
    assert failure.value.history
    assert "mechanics.max_halvings" in failure.value.remedy


def test_without_activation_nothing_moves() -> None:
    body = films.shell(films.flat((6, 2)))
    assert not bend(body, 0.0, increments=2).displacement.any()


def test_reflecting_the_lay_up_reflects_the_shape() -> None:
    """Fibres at +30 and -30 degrees give mirror images about the film's long axis."""
    patch = films.flat((5, 4))
    shapes = []
    for angle in (30.0, -30.0):
        body = films.shell(patch, films.two_layers(angle=angle))
        shapes.append(bend(body, 4.0, increments=8).displacement.reshape(7, 6, 3))
    mirrored = shapes[1][:, ::-1] * [1.0, -1.0, 1.0]
    # the same equations in mirrored order: Newton's tolerance and round-off
    assert np.abs(shapes[0] - mirrored).max() < 1e-9
