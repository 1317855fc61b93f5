"""The stage: records in and out, a stopped run that goes on, inputs that do not fit."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from pydantic import ValidationError

from pipeline.errors import StageError
from pipeline.runner import run as compute
from pipeline.running.memory import MemoryRun, Stopped
from pipeline.store import LocalStore
from stages.artefacts import Laminate, Layer, MidSurface, StressSamples
from stages.geometry.config import FilmConfig, GeometryStageConfig, MeshConfig
from stages.geometry.stage import geometry
from stages.mechanics.config import EquilibriumConfig, MechanicsConfig
from stages.mechanics.stage import equilibrium, mechanics
from tests.mechanics import films
from tests.mechanics.sources import JumpConfig, jump

SURFACE = MidSurface(films.flat((6, 2)))
FIELDS: dict[str, Any] = {
    "elements": (6, 2),
    "degree": 2,
    "n_steps": 8,
    "duration": 40.0,
    "spectral_radius": 0.5,
    "damping": 0.8,
    "stiffness_damping": 0.0,
    "supports": {"clamp": {"kind": "clamped", "edge": "X=0"}},
    "substrate": films.PDMS,
    "active": films.MUSCLE,
    "tension_law": "prescribed",
}
POINTS = 18 * 6


def config(**changes: Any) -> MechanicsConfig:
    return MechanicsConfig(**{**FIELDS, **changes})


def static(**changes: Any) -> EquilibriumConfig:
    dynamic = {"spectral_radius", "damping", "stiffness_damping"}
    return EquilibriumConfig(**{k: v for k, v in FIELDS.items() if k not in dynamic} | changes)


def samples(steps: int = 8, duration: float = 40.0, points: int = POINTS) -> StressSamples:
    """A stress that rises from 0 to 4 kPa, more on one side of the film."""
    time = np.linspace(0.0, duration, steps + 1)
    side = np.linspace(0.5, 1.0, points)
    return StressSamples(time, 4.0 * (time / duration)[:, None] * side)


def test_the_motion_starts_at_rest_and_has_a_frame_for_every_step() -> None:
    motion = mechanics.compute(config(), SURFACE, films.two_layers(), samples())
    np.testing.assert_allclose(motion.time, np.arange(9) * 5.0, rtol=1e-15)
    displacement = np.asarray(motion.displacement)
    assert displacement.shape == (9, SURFACE.patch.size, 3)
    assert not displacement[0].any()
    assert np.asarray(motion.kinetic_energy)[0] == 0.0
    assert np.all(np.diff(np.asarray(motion.strain_energy)) > 0)  # it bends more and more
    assert np.all(np.asarray(motion.newton_iterations)[1:] >= 2)
    assert not displacement.reshape(9, 8, 4, 3)[:, :2].any()  # the clamp


def test_muscle_on_top_lifts_the_free_end() -> None:
    motion = mechanics.compute(config(), SURFACE, films.two_layers(angle=0.0), samples())
    tip = np.asarray(motion.displacement)[-1].reshape(8, 4, 3)[-1]
    assert np.all(tip[:, 2] > 0.01)
    assert np.all(tip[:, 0] < 0)


ADAPTIVE = {"step_control": "adaptive", "error_tolerance": 1e-5}


@pytest.mark.parametrize("changes", [{}, ADAPTIVE])
def test_a_stopped_run_goes_on_to_the_same_bits(changes: dict[str, Any]) -> None:
    arguments = config(**changes), SURFACE, films.two_layers(), samples()
    whole = mechanics.compute(*arguments)
    run = MemoryRun(stop_after=4)
    with pytest.raises(Stopped):
        mechanics.compute(*arguments, run=run)
    resumed = mechanics.compute(*arguments, run=run)
    for name in (f.name for f in fields(whole)):
        np.testing.assert_array_equal(
            np.asarray(getattr(resumed, name)), np.asarray(getattr(whole, name)), err_msg=name
        )
    if changes:  # so that it matters what the controller and the error estimate remember
        assert np.asarray(whole.sub_steps)[5:].min() > 1


def test_equilibria_begin_with_the_unloaded_film_and_have_a_frame_for_every_interval() -> None:
    found = equilibrium.compute(static(), SURFACE, films.two_layers(), samples())
    np.testing.assert_allclose(found.time, np.arange(9) * 5.0, rtol=1e-15)
    displacement = np.asarray(found.displacement)
    assert displacement.shape == (9, SURFACE.patch.size, 3)
    assert not displacement[0].any()
    assert np.all(np.diff(np.asarray(found.strain_energy)) > 0)
    assert not np.asarray(found.external_work).any()
    assert not np.asarray(found.unstable_directions).any()
    np.testing.assert_array_equal(found.load_step, 5.0)


def test_a_stress_that_acts_from_the_start_is_reached_from_the_unloaded_film() -> None:
    full = samples()
    late = StressSamples(full.time, np.repeat(full.active_stress[-1:], 9, axis=0))
    run, other = MemoryRun(), MemoryRun()
    found = equilibrium.compute(static(), SURFACE, films.two_layers(), late, run=run)
    grown = equilibrium.compute(static(), SURFACE, films.two_layers(), full, run=other)
    # one equilibrium by two ways: Newton's tolerance
    gap = np.asarray(found.displacement)[0] - np.asarray(grown.displacement)[-1]
    assert np.abs(gap).max() < 1e-9
    assert np.asarray(found.load_step)[0] < 5.0
    assert run.notes["divided_steps"] >= 1
    # to take a jump in several steps is no cause for concern: nothing is warned of but the coarse mesh
    assert run.warnings == other.warnings
    assert len(run.warnings) == sum("mesh is too coarse" in one for one in run.warnings) == 2
    assert "failed after" in run.lines[0]
    assert run.lines[0].startswith("from 0 to 100 % of what acts at t = 0 ms: ")
    assert any("acts at t = 0 ms: " in line and "iterations, max |R|" in line for line in run.lines)


def test_equilibria_of_a_stopped_run_go_on_to_the_same_bits() -> None:
    arguments = static(), SURFACE, films.two_layers(), samples()
    whole = equilibrium.compute(*arguments)
    run = MemoryRun(stop_after=4)
    with pytest.raises(Stopped):
        equilibrium.compute(*arguments, run=run)
    resumed = equilibrium.compute(*arguments, run=run)
    for name in ("displacement", "strain_energy", "newton_iterations", "fibre_stretch"):
        np.testing.assert_array_equal(
            np.asarray(getattr(resumed, name)), np.asarray(getattr(whole, name))
        )


LIFT = {
    "pull": {
        "kind": "edge-traction",
        "edge": "X=L1",
        "traction": (0.0, 0.0, 2e-5),
        "time_law": {"name": "ramp", "rise_time": 40.0},
    }
}


def silent() -> StressSamples:
    return StressSamples(samples().time, np.zeros((9, POINTS)))


def test_a_load_alone_bends_a_passive_film_and_does_the_work_that_the_film_stores() -> None:
    dead = Laminate((Layer("substrate", "substrate", 0.018, 0.0, activity=0.0),))
    found = equilibrium.compute(static(loads=LIFT), SURFACE, dead, silent())
    tip = np.asarray(found.displacement)[:, -1, 2]
    assert np.all(np.diff(tip) > 0)
    work, energy = np.asarray(found.external_work), np.asarray(found.strain_energy)
    assert work[0] == 0.0
    # trapezoidal rule over eight parts of a mildly nonlinear curve
    np.testing.assert_allclose(work[1:], energy[1:], rtol=1e-2)
    assert not np.asarray(found.active_stress).any()


def test_a_loaded_run_that_was_stopped_goes_on_to_the_same_bits() -> None:
    lifted = {
        "clamp": FIELDS["supports"]["clamp"],
        "lift": {
            "kind": "displacement",
            "edge": "X=L1",
            "z": 0.2,
            "time_law": {"name": "ramp", "rise_time": 40.0},
        },
    }
    load = {"wind": {"kind": "pressure", "pressure": 1e-5, "time_law": "constant"}}
    changes: dict[str, Any] = {"supports": lifted, "loads": load}
    for stage, settings in ((equilibrium, static(**changes)), (mechanics, config(**changes))):
        arguments = settings, SURFACE, films.two_layers(), samples()
        whole = stage.compute(*arguments)
        run = MemoryRun(stop_after=4)
        with pytest.raises(Stopped):
            stage.compute(*arguments, run=run)
        resumed = stage.compute(*arguments, run=run)
        for name in ("displacement", "strain_energy", "newton_iterations"):
            np.testing.assert_array_equal(
                np.asarray(getattr(resumed, name)), np.asarray(getattr(whole, name))
            )
        edge = np.asarray(whole.displacement).reshape(9, 8, 4, 3)[:, -1, :, 2]
        np.testing.assert_allclose(edge, 0.2 * np.arange(9)[:, None] / 8 * np.ones(4), atol=1e-15)


def test_an_equilibrium_needs_supports_that_leave_no_motion_free() -> None:
    with pytest.raises(ValidationError, match="nothing holds the film"):
        static(supports={"clamp": {"kind": "free", "edge": "X=0"}})
    hinge = {"hinge": {"kind": "hinged", "edge": "X=0"}}
    with pytest.raises(ValueError, match=r"turn about the line through \(0, 1, 0\) mm along Y"):
        equilibrium.compute(static(supports=hinge), SURFACE, films.two_layers(), samples())


def test_fibres_shorten_where_the_muscle_pulls() -> None:
    """A prescribed stress is what acts; a film held by its substrate shortens by some per cent."""
    found = equilibrium.compute(static(), SURFACE, films.two_layers(), samples())
    stress, stretch = np.asarray(found.active_stress), np.asarray(found.fibre_stretch)
    np.testing.assert_array_equal(stress, samples().active_stress.astype(np.float32))
    np.testing.assert_array_equal(stretch[0], 1.0)
    assert np.all(stretch[-1].mean() < 1.0)
    assert stretch.min() > 0.97


def test_the_fibre_stretch_of_a_pulled_film_is_that_of_the_pull() -> None:
    """Every point moved by u = (0.1 X, 0, 0): lambda_f = 1.1 along X, and no bending to add to it."""
    body = films.shell(films.flat((3, 2)), films.two_layers(angle=0.0))
    net = body.patch.control_points
    displacement = (net * [0.1, 0.0, 0.0]).ravel()
    frames = body.respond(displacement, np.zeros(body.points)).frames
    # round-off of a strain of 0.1
    np.testing.assert_allclose(body.fibres.stretch(body.reference, frames), 1.1, rtol=1e-14)


def test_a_step_taken_in_parts_is_told_and_counted() -> None:
    time = np.linspace(0.0, 40.0, 9)
    jump = StressSamples(time, np.where(time > 20.0, 9.0, 0.0)[:, None] * np.ones(POINTS))
    run = MemoryRun()
    mechanics.compute(config(max_iterations=4), SURFACE, films.two_layers(), jump, run=run)
    assert run.notes["halved_steps"] >= 1
    assert "time step 5 (to t = 25 ms) converged only in parts of" in run.warnings[0]
    assert run.steps[-1] == (8, 8)


def test_every_interval_of_a_motion_is_told() -> None:
    run, fine = MemoryRun(), MemoryRun()
    mechanics.compute(config(), SURFACE, films.two_layers(), samples(), run=run)
    assert [line.split(":")[0] for line in run.lines] == [f"to t = {5 * i} ms" for i in range(1, 9)]
    assert re.search(r": \d iterations, local error \d", run.lines[0])
    adaptive = config(step_control="adaptive", error_tolerance=1e-6)
    mechanics.compute(adaptive, SURFACE, films.two_layers(), samples(), run=fine)
    assert re.search(r": \d+ steps, the shortest [\d.]+ ms, \d+ iterations", fine.lines[-1])


def test_a_step_without_solution_is_told_in_full_and_what_was_computed_is_kept(
    tmp_path: Path,
) -> None:
    """Through the engine: no load for four steps, then far more than any film bears."""
    film = geometry(
        GeometryStageConfig(
            film=FilmConfig(
                length=3.5,
                width=2.0,
                substrate_thickness=0.018,
                active_thickness=0.004,
                fibre_angle=45.0,
            ),
            excitable_mesh=MeshConfig(elements=(6, 2), degree=2),
            shell_mesh=MeshConfig(elements=(6, 2), degree=2),
        )
    )
    stress = jump(JumpConfig(duration=40.0, n_steps=8, points=POINTS, step=4, stress=1e5))
    inputs = film.part("mid_surface"), film.part("laminate"), stress
    node = mechanics(config(max_halvings=1), *inputs)
    with pytest.raises(StageError) as failure:
        compute({"mechanics": node}, LocalStore(tmp_path / "store"))
    first, kept, remedy = str(failure.value).splitlines()
    assert first.startswith(
        "stage mechanics failed at step 5, t = 20 ms: no solution, even in parts of 2.5 ms: Newton's"
    )
    assert re.search(r"max \|R\| by iteration: \d\.\d\de[+-]\d\d", first)
    assert "mechanics.n_steps" in remedy
    assert "mechanics.max_halvings" in remedy
    assert failure.value.kept is not None
    assert str(failure.value.kept) in kept
    (found,) = failure.value.kept.rglob("displacement")
    stored = np.asarray(zarr.open_array(found, mode="r"))
    np.testing.assert_array_equal(stored[:5], 0.0)  # steps 0 to 4 had no load
    assert np.isnan(stored[5:]).all()  # and nothing was computed after


def test_a_mesh_that_is_not_the_configured_one_is_refused() -> None:
    with pytest.raises(ValueError, match="6 x 2 elements of degree 2, but mechanics is configured"):
        mechanics.compute(config(elements=(7, 2)), SURFACE, films.two_layers(), samples())


def test_a_stress_on_other_times_is_refused() -> None:
    with pytest.raises(ValueError, match="9 times from 0 to 30 ms, but the mechanics steps"):
        mechanics.compute(config(), SURFACE, films.two_layers(), samples(duration=30.0))


def test_a_stress_at_other_points_is_refused() -> None:
    with pytest.raises(ValueError, match="given at 48 points, but the shell integrates over 108"):
        mechanics.compute(config(), SURFACE, films.two_layers(), samples(points=48))


def test_a_film_without_muscle_is_refused() -> None:
    dead = Laminate((Layer("substrate", "substrate", 0.018, 0.0, 0.0),))
    with pytest.raises(ValueError, match="nothing would move the film: no layer of it is active"):
        mechanics.compute(config(), SURFACE, dead, samples())


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("degree", 1),
        ("n_steps", 0),
        ("duration", -1.0),
        ("spectral_radius", 1.5),
        ("damping", -0.1),
        ("supports", {"clamp": {"kind": "glued", "edge": "X=0"}}),
        ("substrate", "rubber"),
        ("max_halvings", -1),
    ],
)
def test_a_bad_value_is_refused_by_name(field: str, value: Any) -> None:
    with pytest.raises(ValidationError, match=field):
        config(**{field: value})
