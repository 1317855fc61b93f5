"""Stimuli on points and over time: totals that do not jump, pulses read as published and as exact means."""

from __future__ import annotations

import itertools
import math
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from stages.electrophysiology import stimuli
from stages.electrophysiology.point_cells import PointCells, disc_below
from stages.electrophysiology.pulse_train import PulseTrain
from stages.electrophysiology.sources import sources
from stages.electrophysiology.stimuli.base import AnyStimulus, Stimulus
from stages.electrophysiology.stimuli.disc_current import DiscCurrent
from stages.electrophysiology.stimuli.edge_flux import EdgeFlux
from stages.electrophysiology.stimuli.patch_current import PatchCurrent
from stages.numerics.patches import Patch
from stages.time_laws.base import TimeLaw
from stages.time_laws.ramp import Ramp
from stages.time_laws.smooth_pulse import SmoothPulse
from stages.time_laws.table import Table
from tests.electrophysiology.test_monodomain import advance
from tests.mechanics.test_recipes import follow
from tests.paper import S1
from workflows.coupled_film import CoupledFilmConfig
from workflows.request import Request

LENGTH, WIDTH = 3.5, 2.0
ONCE: dict[str, Any] = {"start": 1.0, "duration": 5.0}
lengths = st.floats(0.0, 1.0)


def film(elements: tuple[int, int] = (14, 8), degree: int = 2) -> Patch:
    return Patch.rectangle(LENGTH, WIDTH).refine(degree, elements)


def edge_total(extent: tuple[float, float] | None, patch: Patch) -> float:
    """Flux over the edge X = 0: values times the intervals that the points stand for."""
    (source,) = sources((EdgeFlux(edge="X=0", extent=extent, flux=2.0, **ONCE),), patch)
    y = PointCells.of(patch).y
    bounds = np.concatenate((y[:1], 0.5 * (y[:-1] + y[1:]), y[-1:]))
    return float(source.boundary[: y.size] @ np.diff(bounds))


def current_total(stimulus: Stimulus, patch: Patch) -> float:
    """Current over the film: values times the cells of the inner points."""
    (source,) = sources((stimulus,), patch)
    cells = PointCells.of(patch)
    sizes = []
    for at in (cells.x, cells.y):
        bounds = np.concatenate((at[:1], 0.5 * (at[1:-2] + at[2:-1]), at[-1:]))
        sizes.append(np.diff(bounds))
    inner = source.interior.reshape(cells.x.size, cells.y.size)[1:-1, 1:-1]
    return float(sizes[0] @ inner @ sizes[1])


def pulses(law: TimeLaw | None = None, starts: tuple[float, ...] = (1.0,)) -> PulseTrain:
    return PulseTrain(starts, 5.0, law)


@given(lengths, lengths, st.integers(2, 4))
def test_the_flux_through_a_part_of_an_edge_is_its_length_times_the_flux(
    a: float, b: float, degree: int
) -> None:
    low, high = sorted((WIDTH * a, WIDTH * b))
    if high - low > 1e-9:
        total = edge_total((low, high), film(degree=degree))
        assert total == pytest.approx(2.0 * (high - low), abs=1e-12)


def test_an_edge_without_an_extent_takes_the_flux_at_every_point_of_it() -> None:
    (source,) = sources((S1,), film())
    on_edge = np.zeros((16, 10))
    on_edge[0] = S1.flux
    np.testing.assert_array_equal(source.boundary, on_edge.ravel())  # to the last bit, as ever
    (whole,) = sources((S1.model_copy(update={"extent": (0.0, WIDTH)}),), film())
    np.testing.assert_array_equal(whole.boundary, source.boundary)


@given(lengths, lengths, lengths, lengths)
def test_the_current_into_a_rectangle_is_its_area_times_the_current(
    a: float, b: float, c: float, d: float
) -> None:
    (left, right), (low, high) = sorted((LENGTH * a, LENGTH * b)), sorted((WIDTH * c, WIDTH * d))
    if right - left > 1e-9 and high - low > 1e-9:
        current = PatchCurrent(x=(left, right), y=(low, high), current=20.0, **ONCE)
        assert current_total(current, film()) == pytest.approx(
            20.0 * (right - left) * (high - low), abs=1e-11
        )


@given(lengths, lengths, st.floats(1e-3, 1.0))
def test_the_current_into_a_disc_is_its_area_times_the_current(
    a: float, b: float, r: float
) -> None:
    centre = (r + a * (LENGTH - 2 * r), r + b * (WIDTH - 2 * r))
    disc = DiscCurrent(centre=centre, radius=r, current=20.0, **ONCE)
    assert current_total(disc, film()) == pytest.approx(20.0 * math.pi * r**2, abs=1e-10)


@given(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))
def test_the_part_of_a_disc_below_a_corner_is_its_area(x: float, y: float) -> None:
    # midpoint rule on 4000 chords: error of the square root at the ends about n^-1.5
    u = (np.arange(4000) + 0.5) / 2000 - 1.0
    s = np.sqrt(1 - u**2)
    chords = np.clip(np.minimum(s, y) + s, 0.0, None)
    exact = float((chords * (u <= x)).sum() / 2000)
    assert float(disc_below(np.array(x), np.array(y))) == pytest.approx(exact, abs=2e-3)


def test_a_region_between_the_points_still_stimulates() -> None:
    small = PatchCurrent(x=(1.0, 1.001), y=(0.7, 0.701), current=1e3, **ONCE)
    (source,) = sources((small,), film())
    assert np.count_nonzero(source.interior) == 1
    (flux,) = sources((EdgeFlux(edge="Y=L2", extent=(1.0, 1.001), flux=2.0, **ONCE),), film())
    assert np.count_nonzero(flux.boundary) == 1


def test_the_published_scheme_reads_a_pulse_at_the_levels_after_its_beginning() -> None:
    times = np.arange(12) * 0.5
    on = pulses(starts=(1.0, 4.0)).amplitude  # pulses of 5 ms would overlap; the later one counts
    assert PulseTrain((1.0, 4.0), 1.0).amplitude(times).tolist() == [
        *(0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0)
    ]
    assert on(np.array([0.0, 1.0, 1.0 + 1e-8, 9.0, 9.0 + 1e-8])).tolist() == [0, 0, 1, 1, 0]


def test_levels_that_miss_a_pulse_by_rounding_are_on_time() -> None:
    step = 0.1
    times = np.arange(1, 80) * step  # 60 * 0.1 = 6.000000000000001
    assert pulses().amplitude(times).sum() == 50


@given(st.floats(0.01, 3.0), st.integers(0, 40))
def test_the_mean_of_a_plain_pulse_is_the_part_of_the_step_that_it_covers(
    step: float, k: int
) -> None:
    t0 = k * step
    covered = max(min(t0 + step, 6.0) - max(t0, 1.0), 0.0)
    mean = pulses().mean(np.array([t0]), np.array([t0 + step]))[0]
    assert mean == pytest.approx(covered / step, abs=1e-9 / step)  # the tolerance of times


def test_means_add_up_to_the_whole_train_whatever_the_step() -> None:
    train = pulses(starts=(1.0, 11.0, 21.0))
    for step in (0.02, 0.7, 3.0, 8.0):
        edges = np.arange(0.0, 40.0 + step, step)
        means = train.mean(edges[:-1], edges[1:])
        assert float(means.sum() * step) == pytest.approx(15.0, abs=1e-9)
    inside = train.mean(np.array([2.0, 11.0]), np.array([2.7, 16.0]))
    assert inside.tolist() == [1.0, 1.0]  # to the last bit
    late = pulses(starts=(float(np.nextafter(1.0, 2.0)),))  # and if rounding makes a pulse late
    assert late.mean(np.array([1.0]), np.array([1.5])).tolist() == [1.0]


@pytest.mark.parametrize(
    ("law", "integral"),
    [
        (Ramp(start=1.0, rise_time=2.0), 3.0),  # 0 for 1 ms, half of 2 ms, 1 for 2 ms
        (Table(time=(0.0, 1.0, 4.0), factor=(1.0, -1.0, 0.5)), 0.0 - 0.75 + 0.5),
        # int x^2 exp(1 - x^2) = e (sqrt(pi) erf(x)/4 - x exp(-x^2)/2), T = 2, x = 2.5
        (
            SmoothPulse(time_to_peak=2.0),
            2 * math.e * (math.sqrt(math.pi) * math.erf(2.5) / 4 - 2.5 * math.exp(-6.25) / 2),
        ),
    ],
    ids=["ramp", "table", "smooth pulse"],
)
def test_a_time_law_runs_from_the_beginning_of_its_pulse(law: TimeLaw, integral: float) -> None:
    source = pulses(law, starts=(1.0, 10.0))
    for step in (0.03, 1.1, 20.0):
        edges = np.arange(0.0, 20.0 + step, step)
        means = source.mean(edges[:-1], edges[1:])
        assert float(means.sum() * step) == pytest.approx(2 * integral, abs=1e-9)
    at = source.amplitude(np.array([1.0, 3.5, 12.5, 6.5]))
    assert at == pytest.approx([0.0, law.at(2.5), law.at(2.5), 0.0])


def test_a_pulse_acts_in_the_steps_that_it_has_a_part_of() -> None:
    """Nowhere before the first pulse, and not in a step that only touches one, up to rounding."""
    train = pulses(starts=(1.0, 6.0, 21.0))
    for step in (0.02, 0.1, 0.7, 3.0, 8.0):
        edges = np.arange(-2, round(40.0 / step)) * step
        before, after = edges[:-1], edges[1:]
        np.testing.assert_array_equal(
            train.acts(before, after), train.mean(before, after) > 0.0, strict=True
        )


def test_a_train_jumps_where_its_pulses_begin_and_end() -> None:
    train = pulses(starts=(1.0, 6.0, 20.0))  # of 5 ms
    step = 0.1
    levels = np.arange(-1, 300) * step
    found = levels[:-1][train.jumps(levels[:-1] - 0.5 * step, levels[:-1] + 0.5 * step)]
    np.testing.assert_allclose(found, [1.0, 6.0, 11.0, 20.0, 25.0], rtol=1e-12)
    assert not train.jumps(levels[:-1], levels[1:]).any()  # levels themselves, up to rounding


def test_a_train_is_its_pulses_and_a_constant_course_is_none() -> None:
    one = EdgeFlux(edge="X=0", extent=(0.3, 1.1), flux=2.0, start=1.0, duration=2.0)
    law = Table(time=(0.0, 2.0), factor=(1.0, 1.0))
    ways = (
        (one.model_copy(update={"repeats": 2, "period": 4.0}),),
        (one, one.model_copy(update={"start": 5.0})),
        (one.model_copy(update={"repeats": 2, "period": 4.0, "time_law": law}),),
    )
    first, *others = (advance(film((12, 6)), 200, stimuli=way).potential for way in ways)
    assert first.max() > -60.0
    for other in others:
        np.testing.assert_allclose(other, first, rtol=0, atol=1e-11)  # sums of two sources


def test_the_potential_varies_smoothly_with_the_end_of_a_part_of_an_edge() -> None:
    """No jump as the end of the extent passes a collocation point (at 0.75 mm, on spans of 1/4 mm)."""
    ends = 0.75 + np.array([-2e-3, -1e-3, 1e-3, 2e-3])
    found = [
        advance(
            film((14, 8)), 60, stimuli=(S1.model_copy(update={"extent": (0.0, float(end))}),)
        ).potential
        for end in ends
    ]
    below, across, above = (np.abs(b - a).max() for a, b in itertools.pairwise(found))
    assert across < 2.2 * max(below, above)
    assert below > 0.0


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"repeats": 3}, "3 pulses need a period"),
        ({"repeats": 2, "period": 4.0}, "5 ms overlap at a period of 4 ms"),
        ({"edge": "X=1"}, "'X=L1'"),
        ({"extent": (1.0, 0.5)}, "from a smaller to a larger value, not from 1 to 0.5 mm"),
    ],
)
def test_a_stimulus_that_makes_no_sense_is_refused(fields: dict[str, Any], message: str) -> None:
    given = {"kind": "edge-flux", "edge": "X=0", "flux": 2.0, **ONCE, **fields}
    with pytest.raises(ValidationError, match=message):
        TypeAdapter(AnyStimulus).validate_python(given)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"start": 10.0}, "begins at 10 ms, but the run ends at 10 ms"),
        (
            {"repeats": 4, "period": 1.5, "duration": 1.0, "start": 5.0},
            "the last of 4 pulses lasts until 10.5 ms.*set repeats to 3 at most",
        ),
    ],
)
def test_a_stimulus_outside_the_run_is_told(fields: dict[str, Any], message: str) -> None:
    late = EdgeFlux(**{"edge": "X=0", "flux": 2.0, **ONCE, **fields})
    (problem,) = late.outside_the_run(10.0)
    assert re.search(message, problem)


def test_a_train_may_end_with_the_run() -> None:
    train = EdgeFlux(edge="X=0", flux=2.0, start=0.1, duration=0.9, repeats=3, period=4.5)
    assert list(train.outside_the_run(10.0)) == []
    assert train.starts == (0.1, 4.6, 9.1)


@pytest.mark.parametrize(
    ("stimulus", "message"),
    [
        (EdgeFlux(edge="Y=L2", extent=(0.0, 3.6), flux=1.0, **ONCE), r"edge Y=L2.* 0 to 3.5 mm"),
        (EdgeFlux(edge="X=0", extent=(0.0, 2.5), flux=1.0, **ONCE), r"edge X=0.* 0 to 2 mm"),
        (DiscCurrent(centre=(0.1, 1.0), radius=0.2, current=1.0, **ONCE), r"disc of radius 0.2"),
        (PatchCurrent(x=(3.0, 4.0), y=(0.0, 1.0), current=1.0, **ONCE), r"\[3, 4\] x \[0, 1\]"),
    ],
)
def test_what_lies_off_the_film_is_told(stimulus: Stimulus, message: str) -> None:
    (problem,) = stimulus.off_the_film(LENGTH, WIDTH)
    assert re.search(message, problem)


def test_a_stimulus_of_the_library_can_be_changed_in_place() -> None:
    config = Request.read(
        "planar-waves", overrides=["electrophysiology.stimuli.1.start=300"]
    ).config
    assert isinstance(config, CoupledFilmConfig)
    first, second = config.electrophysiology.stimuli
    changed = 'electrophysiology.stimuli=[{name="S1", extent=["100 um", 1], duration="6000 us"}]'
    part = Request.read("planar-waves", overrides=[changed]).config.electrophysiology.stimuli[0]
    assert (part.extent, part.duration, part.flux) == ((0.1, 1.0), 6.0, 2.0)
    assert (first.start, second.start, second.duration) == (0.0, 300.0, 5.0)


def test_a_kind_of_stimulus_is_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The recipe of the contributing guide, as printed."""
    follow(stimuli, "Current applied across the whole width", tmp_path, monkeypatch)
    fields = {"kind": "strip-current", "x": (0.31, 0.87), "current": 20.0, **ONCE}
    strip = TypeAdapter(AnyStimulus).validate_python(fields)
    assert current_total(strip, film()) == pytest.approx(20.0 * 0.56 * WIDTH, rel=1e-12)
    assert list(strip.off_the_film(LENGTH, WIDTH)) == []
    assert len(list(strip.off_the_film(0.5, WIDTH))) == 1


def test_the_printed_stimuli_are_read(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "electrophysiology.md").read_text()
    (table,) = re.findall(r"```toml\n(\[\[electrophysiology.stimuli\]\].*?)```", page, re.DOTALL)
    (tmp_path / "stimuli.toml").write_text(table)
    config = Request.read("planar-waves", tmp_path / "stimuli.toml").config
    assert isinstance(config, CoupledFilmConfig)
    (disc,) = config.electrophysiology.stimuli
    assert isinstance(disc, DiscCurrent)
    assert (disc.radius, disc.starts) == (0.15, (10.0, 510.0, 1010.0))
    for line in re.findall(r"^myofilm run planar-waves (.*stimuli.*)$", page, re.MULTILINE):
        settings = [part for part in shlex.split(line) if part != "--set"]
        assert Request.read("planar-waves", overrides=settings)
