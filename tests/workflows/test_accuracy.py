"""A preset or an accuracy picks mesh, step and scheme of the cells, by measured settings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.canonical import digest
from pipeline.errors import InputError
from stages.artefacts import ExcitableSurface
from stages.electrophysiology.front import tissue_front
from stages.electrophysiology.stage import electrophysiology
from stages.numerics.patches import Patch
from stages.postprocessing.beats import arrival_times
from tests.workflows.conftest import invoke
from workflows.accuracy import measured_settings
from workflows.conduction import conducting
from workflows.request import Request

CELLS = "electrophysiology"
ANY_FILM = (
    "postprocessing.probes.A=centre",
    "postprocessing.probes.B=tip",
    "postprocessing.probes.C=corner",
    "postprocessing.mid_axis=middle",
    "postprocessing.velocity_window=[0, 1]",
)


def configured(*settings: str, workflow: str = "planar-waves", file: Path | None = None) -> Any:
    return Request.read(workflow, file, settings).config


def test_without_either_the_published_setting_is_as_it_was() -> None:
    cells = configured().electrophysiology
    assert (cells.elements, cells.degree, cells.n_steps) == ((102, 60), 2, 100_000)
    assert cells.scheme.name == "cn-ab2"


def test_a_preset_picks_mesh_degree_step_and_scheme() -> None:
    cells = configured(f"{CELLS}.preset=economical").electrophysiology
    assert (cells.elements, cells.degree, cells.scheme.name) == ((43, 25), 6, "strang")
    assert cells.n_steps == 5200  # 13 steps from 0 to 5 ms, where S1 ends


def test_explaining_a_run_tells_what_was_picked(tmp_path: Path) -> None:
    asking = ("explain", "planar-waves", "--store", tmp_path)
    told = invoke(*asking, "--set", f"{CELLS}.preset=economical").output
    assert "preset economical picks 43 x 25 spans of degree 6, 5200 steps" in told
    assert "picks" not in invoke(*asking).output


def test_however_numbers_were_picked_equal_ones_give_equal_keys() -> None:
    requests = [
        (f"{CELLS}.preset=economical",),
        (f'{CELLS}.accuracy="0.12 ms"',),
        (
            f"{CELLS}.elements=[43, 25]",
            f"{CELLS}.degree=6",
            f"{CELLS}.n_steps=5200",
            f"{CELLS}.scheme=strang",
        ),
    ]
    keys = {digest(configured(*settings).electrophysiology) for settings in requests}
    assert len(keys) == 1


def test_a_higher_accuracy_costs_more_and_the_cheapest_one_that_does_is_taken() -> None:
    costs = [setting.cost for setting in measured_settings()]
    assert costs == sorted(costs)
    errors = [setting.error for setting in measured_settings()]
    assert errors == sorted(errors, reverse=True)  # else the dearer one would never be taken
    spans = [
        configured(f"{CELLS}.accuracy={accuracy}").electrophysiology.elements[0]
        for accuracy in (0.5, 0.2, 0.1, 0.03, 0.02)
    ]
    assert spans == sorted(spans)
    assert spans[0] < spans[-1]


@pytest.mark.parametrize(("name", "measured"), [("quick", 0.16), ("economical", 0.06)])
def test_an_accuracy_allows_for_waves_that_go_round_refractory_tissue(
    name: str, measured: float
) -> None:
    """Errors of crossed waves until 0.9 s on the paper's film, as docs/electrophysiology.md has them."""
    (setting,) = (one for one in measured_settings() if one.name == name)
    front = tissue_front(configured().electrophysiology)
    assert front is not None
    assert measured < setting.largest_error(front, 3.5, 2.0) < 3.0 * measured


def test_the_front_and_the_film_scale_the_setting() -> None:
    paper = configured(f"{CELLS}.preset=economical").electrophysiology
    larger = configured(
        f"{CELLS}.preset=economical", "geometry.length=7", "geometry.width=4"
    ).electrophysiology
    assert larger.elements == (86, 50)
    assert larger.n_steps == paper.n_steps
    # four times the conductivity: a front twice as wide and as fast, with the same rise time
    wider = configured(f"{CELLS}.preset=economical", f"{CELLS}.conductivity=0.008")
    assert wider.electrophysiology.elements == (22, 13)
    assert wider.electrophysiology.n_steps == paper.n_steps
    across = configured(f"{CELLS}.preset=economical", f"{CELLS}.transverse_conductivity=0.0005")
    assert across.electrophysiology.elements == (
        86,
        50,
    )  # the front across the fibres is half as wide


def test_an_error_grows_with_the_way_so_that_a_larger_film_needs_more() -> None:
    def spans_per_mm(length: float) -> float:
        film = f"geometry.length={length}", f"geometry.width={length / 2}"
        asked = f"{CELLS}.accuracy=0.15"
        return configured(*film, *ANY_FILM, asked).electrophysiology.elements[0] / length

    assert spans_per_mm(20.0) > spans_per_mm(3.5)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (("preset=economic",), r"no preset is called 'economic' \(did you mean 'economical'\?\)"),
        (("preset=economical", "degree=3"), "preset picks .*degree is given, too: leave one"),
        (("accuracy=0.1", "elements=[9, 9]"), "accuracy picks .*elements is given, too"),
        (("accuracy=0.1", "preset=quick"), "preset picks .*accuracy is given, too"),
        (("accuracy=0.0001",), "accuracy = 0.0001 ms: no measured setting .* reaches 0.013 ms"),
        (("accuracy=0",), r"^electrophysiology.accuracy = 0: must be greater than 0 ms$"),
        (("accuracy=-1 us",), r"^electrophysiology.accuracy = .*: must be greater than 0 ms$"),
        (("accuracy=nan",), "^electrophysiology.accuracy = NaN: must be a finite number$"),
        (
            ("accuracy=1 mm",),
            "^electrophysiology.accuracy = \"1 mm\": .*'mm' has another dimension$",
        ),
        (("accuracy=0.1", "cell_model.a=0.6"), "carry no front"),
    ],
)
def test_what_cannot_be_picked_is_refused(settings: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        configured(*(f"{CELLS}.{setting}" for setting in settings))


def test_a_later_choice_replaces_an_earlier_one(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(f'[{CELLS}]\npreset = "quick"\n')
    assert configured(file=file).electrophysiology.elements == (35, 20)
    asked = configured(f"{CELLS}.accuracy=0.02", file=file).electrophysiology
    assert asked.preset is None
    assert asked.elements[0] > 60


def test_steps_meet_the_stimuli() -> None:
    cells = configured(f"{CELLS}.accuracy=0.2").electrophysiology
    for stimulus in cells.stimuli:
        for time in (stimulus.start, stimulus.start + stimulus.duration):
            assert time / cells.step == pytest.approx(round(time / cells.step), abs=1e-9)


def test_mistakes_elsewhere_in_the_section_are_told_as_ever() -> None:
    with pytest.raises(InputError, match=r"electrophysiology.conductivity") as refusal:
        configured(f"{CELLS}.preset=economical", f"{CELLS}.conductivity=-1")
    assert "elements" not in str(refusal.value)


def arrivals(config: Any, fractions: tuple[float, ...]) -> np.ndarray:
    """Activation times at these parts of the length, on the edges and inside, ``(place, beat)``."""
    cells, film = conducting(config.electrophysiology, config.geometry), config.geometry
    patch = Patch.rectangle(film.length, film.width).refine(cells.degree, cells.elements)
    quiet = cells.model_copy(update={"output_interval": cells.duration})
    history = electrophysiology.compute(quiet, ExcitableSurface(patch))
    places = np.array([(x, y) for x in fractions for y in (0.0, 0.45, 1.0)])
    return arrival_times(patch, np.asarray(history.activation_times), places)


CASES = {
    "a small film": ("planar-waves", ("geometry.length=1.6", "geometry.width=1.1")),
    "a large film": ("planar-waves", ("geometry.length=6", "geometry.width=0.9")),
    "crossed waves": ("spiral-wave", (f"{CELLS}.duration=900",)),
    "a low threshold": (
        "planar-waves",
        (f"{CELLS}.cell_model=aliev-panfilov-low-threshold",),
    ),
    "slow conduction": ("planar-waves", (f"{CELLS}.conductivity=0.001",)),
    "fibres": (  # along X, which the fast solver takes
        "planar-waves",
        (f"{CELLS}.transverse_conductivity=0.0008", "geometry.fibre_angle=0"),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("accuracy", [0.3, 0.1])
@pytest.mark.parametrize("case", CASES)
def test_the_error_stays_below_the_one_asked_for(case: str, accuracy: float) -> None:
    """Against the most accurate measured setting, on films, protocols and cells that were not measured."""
    workflow, settings = CASES[case]
    coarse, fine = (
        configured(
            *(
                f"{CELLS}.duration=760",
                "mechanics.duration=700",
                *ANY_FILM,
                *settings,
                f"{CELLS}.accuracy={asked}",
            ),
            workflow=workflow,
        )
        for asked in (accuracy, 0.02)
    )
    # S3 runs along tissue that S1 has left refractory near X = 0.7 mm: which cells there a wave still
    # activates, and when, is far more sensitive than anything else
    fractions = (0.5, 0.8, 1.0) if case == "crossed waves" else (0.2, 0.62, 1.0)
    found, exact = (arrivals(one, fractions) for one in (coarse, fine))
    assert np.array_equal(np.isfinite(found), np.isfinite(exact))
    assert np.nanmax(np.abs(found - exact)) < accuracy - 0.02  # the error of the reference
