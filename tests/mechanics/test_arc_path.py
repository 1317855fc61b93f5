"""Quasi-static runs by arc length: past limit points, to their end, and on after a stop."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from pipeline.running.memory import MemoryRun
from pipeline.testing import interrupted_and_resumed
from stages.artefacts import Equilibria, Laminate, Layer, MidSurface, StressSamples
from stages.mechanics.actions.points import functions_over
from stages.mechanics.config import EquilibriumConfig
from stages.mechanics.stage import buckling, equilibrium
from stages.mechanics.statics.equilibrium import UnreachedShapeError
from tests.mechanics import films

ELEMENTS = (8, 1)
STEPS = 80
SURFACE = MidSurface(films.flat(ELEMENTS, width=0.5))
POINTS = 8 * 9
ONE_LAYER = Laminate((Layer("film", "substrate", 0.022, 0.0, activity=1.0),))
PASSIVE = Laminate((Layer("film", "substrate", 0.022, 0.0, activity=0.0),))

HINGE = {"kind": "hinged", "edge": "X=0"}
SLIDE = {"kind": "displacement", "edge": "X=L1", "y": 0.0, "z": 0.0}


def ramp(start: float, rise_time: float) -> dict[str, Any]:
    return {"name": "ramp", "start": start, "rise_time": rise_time}


PUSHED: dict[str, Any] = {
    "supports": {"hinge": HINGE, "push": {**SLIDE, "x": -0.0006, "time_law": ramp(0.0, 20.0)}},
    "loads": {
        # sends the film down while it is pushed together
        "bias": {
            "kind": "point",
            "position": (1.75, 0.25),
            "force": (0.0, 0.0, -1e-5),
            "time_law": ramp(0.0, 20.0),
        },
        # then pushes it up, next to its middle
        "poke": {
            "kind": "point",
            "position": (1.6, 0.25),
            "force": (0.0, 0.0, 3e-4),
            "time_law": ramp(20.0, 60.0),
        },
    },
}
ARC = {"kind": "arc-length", "preload": 20.0}


def config(**changes: Any) -> EquilibriumConfig:
    fields = {
        "elements": ELEMENTS,
        "degree": 2,
        "n_steps": STEPS,
        "duration": float(STEPS),
        "supports": {"clamp": {"kind": "clamped", "edge": "X=0"}},
        "substrate": films.PDMS,
        "active": films.MUSCLE,
        "tension_law": "prescribed",
    }
    return EquilibriumConfig(**fields | changes)


def samples(stress: float = 0.0, steps: int = STEPS) -> StressSamples:
    time = np.linspace(0.0, STEPS, steps + 1)
    return StressSamples(time, np.outer(stress * time / STEPS, np.ones(POINTS)))


def path(run: MemoryRun | None = None, **control: Any) -> Equilibria:
    settings = config(**PUSHED, control=ARC | control)
    return equilibrium.compute(settings, SURFACE, PASSIVE, samples(), run=run or MemoryRun())


@pytest.fixture(scope="module")
def snapped() -> tuple[Equilibria, list[str]]:
    """A whole path and its warnings."""
    run = MemoryRun()
    return path(run), run.warnings


def middle(found: Equilibria) -> Any:
    """Z of the film's middle: the mean over its middle control points."""
    z = np.asarray(found.displacement).reshape(-1, 10, 3, 3)[..., 2]
    return z[:, 4:6].mean(axis=(1, 2))


def test_a_film_that_snaps_through_is_followed_to_its_full_load(
    snapped: tuple[Equilibria, list[str]],
) -> None:
    found, warnings = snapped
    factor, unstable = np.asarray(found.load_factor), np.asarray(found.unstable_directions)
    assert (factor[0], factor[-1]) == (0.0, 1.0)
    assert (unstable[0], unstable[-1]) == (0.0, 0.0)
    assert len(factor) < STEPS + 1
    np.testing.assert_array_equal(found.time, np.arange(len(factor)))  # merely numbers
    assert np.diff(factor).min() < 0.0
    assert unstable.max() >= 1.0
    up = middle(found)
    assert up[0] < -0.01
    assert up[-1] > 0.01
    limits = np.asarray(found.limit_loads)
    assert len(limits) >= 2
    # the largest stored factor on the first rise lies just below the limit point
    first = factor[: int(np.argmax(np.diff(factor) < 0.0)) + 1].max()
    assert first <= limits[0] * (1 + 1e-6)
    assert sum("the load has a limit point" in warning for warning in warnings) == len(limits)


def test_control_by_load_ends_at_that_limit_point_and_names_the_way_past_it(
    snapped: tuple[Equilibria, list[str]],
) -> None:
    with pytest.raises(UnreachedShapeError) as failure:
        equilibrium.compute(config(**PUSHED), SURFACE, PASSIVE, samples())
    told = re.search(r"followed to t = ([\d.]+) ms .*poke times ([\d.]+)", str(failure.value))
    assert told is not None
    limit = float(np.asarray(snapped[0].limit_loads)[0])
    # a step of a 64th of an interval, 1/60 of the load
    assert float(told[2]) == pytest.approx(limit, abs=1.0 / 60 / 32)
    assert float(told[1]) == pytest.approx(20.0 + 60.0 * limit, abs=1.0 / 32)
    assert (
        "mechanics.control.kind = arc-length, mechanics.control.preload = " in failure.value.remedy
    )


def test_a_path_that_was_stopped_goes_on_to_the_same_bits(
    snapped: tuple[Equilibria, list[str]],
) -> None:
    settings = config(**PUSHED, control=ARC)
    whole, _ = snapped
    resumed = interrupted_and_resumed(
        equilibrium, settings, SURFACE, PASSIVE, samples(), after=len(whole.time) // 2
    )
    for name in (
        "displacement",
        "load_factor",
        "external_work",
        "limit_loads",
        "newton_iterations",
    ):
        np.testing.assert_array_equal(
            np.asarray(getattr(resumed, name)), np.asarray(getattr(whole, name))
        )


def test_a_path_may_end_at_a_displacement(
    snapped: tuple[Equilibria, list[str]],
) -> None:
    end = {"position": (1.6, 0.25), "component": "z", "displacement": 0.01}
    found = path(until=end)
    z = np.asarray(found.displacement)[-1, :, 2]
    assert float(functions_over(SURFACE.patch, (1.6, 0.25)) @ z) == pytest.approx(0.01, rel=1e-9)
    assert len(found.time) < len(snapped[0].time)


def test_a_path_that_does_not_reach_its_end_says_so_and_is_kept() -> None:
    run = MemoryRun()
    settings = config(**PUSHED, control=ARC, n_steps=40, duration=80.0)
    found = equilibrium.compute(settings, SURFACE, PASSIVE, samples(steps=40), run=run)
    assert len(found.time) == 41
    assert "the path is not at its end after 40 points" in run.warnings[-1]
    assert "mechanics.n_steps" in run.warnings[-1]


def test_both_controls_lead_to_the_same_shape_where_the_load_only_grows() -> None:
    by_arc = equilibrium.compute(
        config(control={"kind": "arc-length"}), SURFACE, ONE_LAYER, samples(4.0)
    )
    by_load = equilibrium.compute(config(n_steps=4), SURFACE, ONE_LAYER, samples(4.0, steps=4))
    np.testing.assert_array_equal(by_load.load_factor, 1.0)
    assert by_arc.load_factor[-1] == 1.0
    gap = np.asarray(by_arc.displacement)[-1] - np.asarray(by_load.displacement)[-1]
    assert np.abs(gap).max() < 1e-9  # Newton's tolerance
    assert by_arc.limit_loads.size == by_arc.bifurcation_loads.size == 0


def test_a_path_needs_something_to_grow() -> None:
    with pytest.raises(ValueError, match="nothing is added to the loading up to its last instant"):
        equilibrium.compute(
            config(control={"kind": "arc-length"}), SURFACE, ONE_LAYER, samples(0.0)
        )


@pytest.mark.parametrize(
    ("control", "message"),
    [
        ({"preload": 20.5}, "control.preload = 20.5 ms must be before the end, a multiple"),
        ({"preload": 80.0}, "must be before the end"),
        ({"target": 0.0}, "target must not be 0"),
        (
            {
                "target": 1.0,
                "until": {"position": (1.0, 0.1), "component": "z", "displacement": 1.0},
            },
            "gives two ends of the path",
        ),
        ({"first_load": 0.0}, "first_load"),
    ],
)
def test_a_control_that_makes_no_sense_is_refused(control: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        config(control=ARC | control)


def test_a_strip_pushed_at_its_end_buckles_like_eulers_column() -> None:
    squeeze = {
        "kind": "edge-traction",
        "edge": "X=L1",
        "traction": (-1e-3, 0.0, 0.0),
        "time_law": "constant",
    }
    solid = {
        "name": "st-venant-kirchhoff",
        "density": 1.0,
        "young_modulus": 1500.0,
        "poisson_ratio": 0.0,
    }
    settings = config(
        supports={"hinge": HINGE, "slide": SLIDE},
        loads={"squeeze": squeeze},
        substrate=solid,
        buckling_modes=2,
    )
    run = MemoryRun()
    found = buckling.compute(settings, SURFACE, PASSIVE, samples(), run=run)
    force = np.pi**2 * 1500.0 * 0.022**3 / 12 / 3.5**2  # kPa mm, per width
    # bending by quadratic elements: an error of (wave number h)^2 / 12
    assert found.factors[0] == pytest.approx(force / 1e-3, rel=1.5 * (np.pi / 8) ** 2 / 12)
    assert found.factors[1] == pytest.approx(4 * force / 1e-3, rel=1.5 * (np.pi / 4) ** 2 / 12)
    np.testing.assert_allclose(np.linalg.norm(found.shapes, axis=2).max(axis=1), 1.0, rtol=1e-14)
    assert run.warnings == []


def test_modes_of_a_film_that_bends_at_once_come_with_a_warning() -> None:
    run = MemoryRun()
    buckling.compute(config(buckling_modes=1), SURFACE, films.two_layers(), samples(4.0), run=run)
    assert "not to be relied on" in run.warnings[0]
    assert "arc-length" in run.warnings[0]


def test_there_are_no_modes_where_nothing_acts() -> None:
    with pytest.raises(Exception, match="nothing acts at the last instant"):
        buckling.compute(config(buckling_modes=1), SURFACE, ONE_LAYER, samples(0.0))
