"""Vulnerable window: the times at which a wave across the tail of another one comes round again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.protocols.config import WindowConfig, WindowProtocol
from stages.geometry.config import FilmConfig
from stages.paced_artefacts import REENTRY
from workflows.conduction import conducting
from workflows.film_checks import off_the_film
from workflows.film_quantities import listed
from workflows.surfaces import excitable_film
from workflows.tissue_checks import unfit_stimuli, unfit_tissue
from workflows.tissue_experiment import TissueExperiment
from workflows.workflow import Export, Quantity, Workflow

if TYPE_CHECKING:
    from pipeline.nodes import Node
    from stages.paced_artefacts import VulnerableWindow


class WindowWorkflowConfig(TissueExperiment):
    """All parameters of the experiment, section by section."""

    geometry: FilmConfig
    electrophysiology: ElectrophysiologyConfig
    protocol: WindowProtocol

    @model_validator(mode="after")
    def _sections_fit_together(self) -> WindowWorkflowConfig:
        for problem in _misfits(self):
            raise PydanticCustomError("misfit", "{problem}", {"problem": problem})
        return self


def _misfits(config: WindowWorkflowConfig) -> Iterator[str]:
    """What contradicts across sections, in words."""
    film, cells = config.geometry, config.electrophysiology
    if len(cells.stimuli) < 2:
        yield (
            "electrophysiology.stimuli names "
            f"{len(cells.stimuli)}, but the window takes two or more: those that are given at their own "
            "time, and the last, which is moved; for instance ['S1', 'S3']"
        )
        return
    last = config.protocol.times[-1]
    stimuli = (*cells.stimuli[:-1], cells.stimuli[-1].model_copy(update={"start": last}))
    yield from unfit_stimuli(film, stimuli, last + cells.duration)
    yield from unfit_tissue(film, cells)
    for name, place in config.protocol.probes.items():
        yield from off_the_film(f"protocol.probes.{name}", place, film)


def plan(config: WindowWorkflowConfig) -> Mapping[str, Node[Any]]:
    """The surface, and the sweep on it."""
    from stages.electrophysiology.protocols.stage import vulnerable_window

    tissue = conducting(config.electrophysiology, config.geometry)
    film = excitable_film(config.geometry, tissue)
    *fixed, moved = tissue.stimuli  # wherever the last one starts, the protocol moves it
    stimuli = (*fixed, moved.model_copy(update={"start": 0.0}))
    swept = WindowConfig(
        tissue=tissue.model_copy(update={"stimuli": stimuli}), protocol=config.protocol
    )
    return {
        "geometry": film,
        "vulnerable_window": vulnerable_window(swept, surface=film.part("excitable_surface")),
    }


def quantities(measured: VulnerableWindow) -> dict[str, Quantity]:
    """The borders of the window, and what was seen at each time."""
    start, end = widest_window(listed(measured.time), listed(measured.outcome))
    found = {
        "window_start": Quantity(
            start, "ms", "first time of S3 at which its wave comes round again, to the tolerance"
        ),
        "window_end": Quantity(end, "ms", "last time of S3 at which it does, to the tolerance"),
        "window_length": Quantity(
            end - start if start is not None and end is not None else None,
            "ms",
            "how long S3 may be early or late for that",
        ),
        "time": Quantity(listed(measured.time), "ms", "times of S3, case by case"),
        "outcome": Quantity(
            listed(measured.outcome),
            "",
            "what becomes of S3: 0 no further wave, 1 a wave that passes, 2 one that comes round again",
        ),
        "life_time": Quantity(
            listed(measured.life_time),
            "ms",
            "time from S3 to the last activation that it adds; at most the time watched",
        ),
    }
    for i, name in enumerate(measured.probe_names):
        found[f"{name}.activation_count"] = Quantity(
            listed(measured.activations[:, i]), "", f"how many activations S3 adds at {name}"
        )
    return found


def widest_window(
    times: Sequence[float | None], outcomes: Sequence[float | None]
) -> tuple[float | None, float | None]:
    """First and last time of the longest run of re-entry; an end of the sweep is no border: ``None``.

    Examples
    --------
    >>> widest_window([1.0, 2.0, 3.0, 4.0, 5.0], [0.0, 2.0, 0.0, 2.0, 2.0])
    (4.0, None)
    >>> widest_window([1.0, 2.0, 3.0], [0.0, 2.0, 1.0])
    (2.0, 2.0)
    >>> widest_window([1.0, 2.0], [0.0, 1.0])
    (None, None)
    """
    windows: list[tuple[int, int]] = []
    for i, outcome in enumerate(outcomes):
        if outcome != REENTRY:
            continue
        if windows and windows[-1][1] == i - 1:
            windows[-1] = (windows[-1][0], i)
        else:
            windows.append((i, i))
    if not windows:
        return None, None
    first, last = max(windows, key=lambda ends: (times[ends[1]] or 0.0) - (times[ends[0]] or 0.0))
    return (
        times[first] if first > 0 else None,
        times[last] if last < len(times) - 1 else None,
    )


def remarks(found: Mapping[str, Quantity]) -> Sequence[str]:
    """Where the sweep has missed a border."""
    outcomes, times = found["outcome"].value, found["time"].value
    assert isinstance(outcomes, list)
    assert isinstance(times, list)
    if REENTRY not in outcomes:
        return ["No wave came round again at any of these times: sweep others (protocol.times)."]
    said = []
    if outcomes[0] == REENTRY:
        said.append(f"The window begins before {times[0]:g} ms: add earlier protocol.times.")
    if outcomes[-1] == REENTRY:
        said.append(f"The window ends after {times[-1]:g} ms: add later protocol.times.")
    return said


WORKFLOW = Workflow(
    name="vulnerable-window",
    title="Vulnerable window: when a wave across the tail of another one comes round again",
    modules=(__name__,),
    config=WindowWorkflowConfig,
    plan=plan,
    quantities=lambda experiment: quantities(experiment.load("vulnerable_window")),
    measured=("vulnerable_window",),
    exports=(
        Export(
            files=("vulnerable-window.png", "vulnerable-window.svg"),
            modules=("workflows.figures.vulnerable_window",),
            stages=("vulnerable_window",),
            kind="picture",
            caption="What becomes of S3, by its time: how much of the film its wave activates, once and "
            "again; how often it activates the probes; and for how long.",
        ),
        Export(
            files=("vulnerable-window.csv",),
            modules=("workflows.exports.window",),
            stages=("vulnerable_window",),
            kind="data",
            caption="A row for each time of S3: outcome, shares of the film, life time, activations.",
        ),
    ),
    remarks=remarks,
)
