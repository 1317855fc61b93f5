"""The runner computes what is missing, once, and keeps it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.errors import InputError, StageError, StoreError
from pipeline.events import (
    Event,
    StageFailed,
    StageFinished,
    StageHit,
    StageProgress,
    StageStarted,
    StageTold,
    StageWarned,
)
from pipeline.manifest import hash_files
from pipeline.nodes import Node, StageRun, source_node, stage
from pipeline.runner import run
from pipeline.store import LocalStore
from pipeline.testing import interrupted_and_resumed
from pipeline.testing.stores import forge
from tests.pipeline import toy


def plan(
    mesh: toy.MeshConfig | None = None, wave: toy.WaveConfig | None = None
) -> dict[str, Node[Any]]:
    film = toy.mesh(mesh or toy.MeshConfig())
    history = toy.wave(wave or toy.WaveConfig(), surface=film.part("surface"))
    peak = toy.peak(toy.MeshConfig(), history=history)
    return {"wave": history, "report": toy.report(toy.MeshConfig(), peak)}


def computed(events: list[Event]) -> list[str]:
    return [event.stage for event in events if isinstance(event, StageStarted)]


@pytest.fixture
def events() -> list[Event]:
    return []


def test_the_first_run_computes_all_in_order_and_the_second_nothing(
    store: LocalStore, events: list[Event]
) -> None:
    first = run(plan(), store, listen=events.append)
    assert computed(events) == ["mesh", "wave", "peak", "report"]
    assert [outcome.hit for outcome in first.values()] == [False, False]
    events.clear()
    second = run(plan(), store, listen=events.append)
    assert [type(event) for event in events] == [StageHit] * 4
    assert all(outcome.hit for outcome in second.values())
    assert {n: o.key for n, o in second.items()} == {n: o.key for n, o in first.items()}


def test_a_stored_history_is_the_one_computed_in_memory(store: LocalStore) -> None:
    stored = run(plan(), store)["wave"].load()
    film = toy.mesh.compute(toy.MeshConfig())
    plain = toy.wave.compute(toy.WaveConfig(), film.surface)
    np.testing.assert_array_equal(stored.potential[...], plain.potential, strict=True)
    np.testing.assert_array_equal(stored.energy[...], plain.energy, strict=True)
    assert stored.resumed is plain.resumed is False


def test_a_history_is_written_in_chunks_of_64_frames(store: LocalStore) -> None:
    potential = run(plan(), store)["wave"].load().potential
    assert potential.chunks == (64, toy.POINTS)
    assert potential.dtype == "float32"


def test_memory_holds_one_chunk_however_long_the_history(store: LocalStore) -> None:
    from pipeline.running.frames import FrameShapes
    from pipeline.running.streams import StoredHistory

    frames = FrameShapes(toy.Wave, 1000, {"potential": (toy.POINTS,), "energy": ()})
    history = StoredHistory(store.path / "record.zarr", frames, None)
    for frame in range(200):
        history.append(potential=np.full(toy.POINTS, frame), energy=frame)
    unwritten = {name: len(rows) for name, rows in history.saved().buffers.items()}
    assert unwritten == {"potential": 200 % 64, "energy": 200}  # numbers go into one chunk
    endless = FrameShapes(toy.Wave, 10**9, {"energy": ()}, fewer=True)
    history = StoredHistory(store.path / "endless.zarr", endless, None)
    for frame in range(100):
        history.append(energy=frame)
    assert [len(rows) for rows in history.saved().buffers.values()] == [100 % 64]


@pytest.mark.filterwarnings("error")
def test_a_frame_too_large_for_its_stored_type_becomes_infinite_without_a_warning() -> None:
    from pipeline.running.frames import FrameShapes

    frames = FrameShapes(toy.Wave, 1, {"potential": (2,), "energy": ()})
    frame = frames.checked({"potential": [1e300, 1.0], "energy": 1e300}, 0)
    assert frame["potential"].tolist() == [np.inf, 1.0]
    assert frame["energy"] == 1e300


def test_a_part_can_be_loaded_alone(store: LocalStore) -> None:
    outcome = run({"film": toy.mesh(toy.MeshConfig(label="x"))}, store)["film"]
    assert outcome.load("label") == toy.Label("x")
    assert outcome.load().label == toy.Label("x")
    assert outcome.parts.keys() == {"surface", "label"}


def test_another_part_does_not_disturb_its_neighbours_consumers(
    store: LocalStore, events: list[Event]
) -> None:
    run(plan(), store)
    run(plan(toy.MeshConfig(label="other")), store, listen=events.append)
    assert computed(events) == ["mesh"]


def test_an_input_that_comes_out_the_same_cuts_the_work_off(
    store: LocalStore, events: list[Event]
) -> None:
    # The peak is rounded to thousands, so both gains have the same one.
    run(plan(), store)
    run(plan(wave=toy.WaveConfig(gain=1.001)), store, listen=events.append)
    assert computed(events) == ["wave", "peak"]


def test_an_unkeyed_field_changes_nothing(store: LocalStore, events: list[Event]) -> None:
    run(plan(), store)
    run(plan(wave=toy.WaveConfig(pause=1e-9)), store, listen=events.append)
    assert computed(events) == []


def test_two_nodes_may_be_of_the_same_stage(store: LocalStore, events: list[Event]) -> None:
    a, b = (toy.mesh(toy.MeshConfig(label=label)) for label in "ab")
    again = toy.mesh(toy.MeshConfig(label="a"))
    outcomes = run({"a": a, "b": b, "again": again, "same": a}, store, listen=events.append)
    assert {n: o.load("label").text for n, o in outcomes.items()} == {
        "a": "a",
        "b": "b",
        "again": "a",
        "same": "a",
    }
    assert computed(events) == ["mesh", "mesh"]


def test_two_stores_and_two_processes_make_the_same_bytes(
    tmp_path: Path, output: Callable[..., str]
) -> None:
    here = LocalStore(tmp_path / "here")
    outcomes = run(plan(), here)
    output(
        "from tests.pipeline.test_runner import *\nrun(plan(), LocalStore('there'))",
        PYTHONHASHSEED="7",
    )
    there = LocalStore(tmp_path / "there")
    assert list(here.refs()) == list(there.refs())
    assert len(list(here.refs())) == 4
    for ref in here.refs():
        assert hash_files(here.data(ref)) == hash_files(there.data(ref))
    assert (
        outcomes["wave"].manifest.content == there.manifest(outcomes["wave"].manifest.ref).content
    )


def test_the_manifest_tells_how_a_result_came_about(store: LocalStore) -> None:
    manifest = run(plan(), store)["wave"].manifest
    config = {"gain": 1.0, "frames": toy.FRAMES, "fail_at": -1, "ends_at": -1}
    assert manifest.config == config
    assert manifest.modules.keys() >= {"tests.pipeline.toy"}
    assert manifest.inputs["surface"].stage == "mesh"
    assert manifest.inputs["surface"].part == "surface"
    assert manifest.notes.keys() == {"norm"}
    assert isinstance(manifest.notes["norm"], float)
    assert manifest.environment["versions"].keys() >= {"python", "numpy", "zarr", "h5py"}
    assert {"host", "argv", "git", "cpus", "lock_wait_seconds"} <= manifest.environment.keys()
    assert manifest.seconds > 0
    assert manifest.cpu_seconds > 0
    assert manifest.peak_memory > 1e6
    assert manifest.started < manifest.finished
    assert manifest.stated_key() == manifest.key
    assert store.verify(manifest.ref, full=True) == ()


def test_progress_is_told_at_its_end_but_not_at_every_step(
    store: LocalStore, events: list[Event]
) -> None:
    run(plan(wave=toy.WaveConfig(frames=5000)), store, listen=events.append)
    progress = [event for event in events if isinstance(event, StageProgress)]
    assert (progress[-1].done, progress[-1].total) == (5000, 5000)
    assert len(progress) < 1000


def test_the_duration_of_the_most_similar_past_run_is_expected(
    store: LocalStore, events: list[Event]
) -> None:
    past = run({"mesh": toy.mesh(toy.MeshConfig())}, store)["mesh"]
    run({"mesh": toy.mesh(toy.MeshConfig(height=3))}, store, listen=events.append)
    assert isinstance(events[0], StageStarted)
    assert events[0].expected_seconds == past.seconds


def test_a_failing_stage_tells_cause_place_remedy_and_keeps_its_frames(
    store: LocalStore, events: list[Event]
) -> None:
    with pytest.raises(StageError) as caught:
        run(plan(wave=toy.WaveConfig(fail_at=70)), store, listen=events.append)
    error = caught.value
    assert (error.stage, error.cause) == ("wave", "no convergence in frame 70")
    assert str(error).startswith(f"stage wave failed after 70 of {toy.FRAMES} steps: no conv")
    assert error.remedy == "choose another gain"
    assert error.exit_code == 1
    assert isinstance(events[-1], StageFailed)
    assert error.kept is not None
    import zarr

    potential: Any = zarr.open_group(error.kept / "data" / "record.zarr", mode="r")["potential"]
    finite = np.isfinite(potential[:, 0])
    assert finite.tolist() == [True] * 70 + [False] * (toy.FRAMES - 70)


class PlacedError(ArithmeticError):
    place = "t = 5 ms"


@stage
def failing_at_a_place(config: toy.MeshConfig, *, run: StageRun) -> toy.Label:
    run.progress(4, 8)
    raise PlacedError("no convergence")


def test_the_place_that_a_stage_tells_is_the_only_one(store: LocalStore) -> None:
    with pytest.raises(StageError) as caught:
        run({"x": failing_at_a_place(toy.MeshConfig())}, store)
    assert str(caught.value) == "stage failing_at_a_place failed at t = 5 ms: no convergence"


def flip_bit(path: Path) -> None:
    contents = bytearray(path.read_bytes())
    contents[len(contents) // 2] ^= 1
    path.write_bytes(contents)


@pytest.mark.parametrize(
    ("node", "file"),
    [
        ("mesh", "surface.h5"),
        ("wave", "record.zarr/zarr.json"),
        ("wave", "record.zarr/potential/zarr.json"),
        ("wave", "record.zarr/potential/c.1.0"),
    ],
)
def test_a_flipped_bit_is_never_used_silently(node: str, file: str, store: LocalStore) -> None:
    nodes = plan()
    nodes["mesh"] = source_node(nodes["wave"].inputs["surface"])
    outcome = run(nodes, store)[node]
    flip_bit(store.data(outcome.manifest.ref) / file)
    consumer = {
        "mesh": toy.wave(toy.WaveConfig(gain=2.0), nodes["mesh"].part("surface")),
        "wave": toy.peak(toy.MeshConfig(height=2.0), nodes["wave"]),
    }[node]
    told = rf"(?s)artefact {outcome.manifest.ref} is damaged \(the checksum of {file} is wrong\)"
    with pytest.raises(
        StoreError, match=rf"{told}.*{store.path}.*Remedy: run .* --recompute-damaged"
    ):
        run({"consumer": consumer}, store)
    if "/c." in file:  # read when it is looked at
        with pytest.raises(ValueError, match="checksum"):
            outcome.load().potential[...]
    else:
        with pytest.raises(StoreError, match=told):
            outcome.load()


def test_a_chunk_that_is_lost_after_it_was_looked_for_is_never_read_as_fill_values(
    store: LocalStore,
) -> None:
    nodes = plan()
    outcome = run(nodes, store)["wave"]
    history = outcome.load()
    (store.data(outcome.manifest.ref) / "record.zarr/potential/c.1.0").unlink()
    with pytest.raises(FileNotFoundError, match="a chunk of an array is missing"):
        history.potential[...]
    with pytest.raises(StoreError, match=r"record\.zarr/potential/c\.1\.0 is missing"):
        outcome.load()


@stage
def loses_its_input(config: toy.MeshConfig, history: toy.Wave) -> toy.Peak:
    """Meets damage that came after its input was opened."""
    path = Path(str(history.potential.store.root)) / "potential" / "c.1.0"
    path.write_bytes(path.read_bytes()[:-1])
    return toy.Peak(float(np.max(history.potential[...])))


def test_damage_that_comes_while_a_stage_reads_is_told_as_damage(store: LocalStore) -> None:
    wave = plan()["wave"]
    with pytest.raises(
        StoreError, match=r"wave/\w+ is damaged \(record\.zarr/potential/c\.1\.0 has"
    ):
        run({"peak": loses_its_input(toy.MeshConfig(), history=wave)}, store)


def test_a_damaged_part_does_not_keep_its_neighbours_from_being_loaded(store: LocalStore) -> None:
    outcome = run({"mesh": toy.mesh(toy.MeshConfig())}, store)["mesh"]
    flip_bit(store.data(outcome.manifest.ref) / "surface.h5")
    assert outcome.load("label") == toy.Label("flat")
    with pytest.raises(StoreError, match="checksum"):
        outcome.load("surface")


def test_finished_results_outlive_a_later_failure(store: LocalStore, events: list[Event]) -> None:
    with pytest.raises(StageError):
        run(plan(wave=toy.WaveConfig(fail_at=0)), store)
    assert [ref.stage for ref in store.refs()] == ["mesh"]
    assert list((store.path / "tmp").iterdir()) == []
    run(plan(), store, listen=events.append)
    assert computed(events) == ["wave", "peak", "report"]


@stage
def wrong_record(config: toy.MeshConfig) -> toy.Label:
    return toy.Peak(1.0)  # type: ignore[return-value]  # the mistake under test


@stage
def wrong_field(config: toy.MeshConfig) -> toy.Label:
    return toy.Label([1, 2])  # type: ignore[arg-type]  # the mistake under test


@stage
def unfinished(config: toy.MeshConfig, *, run: StageRun) -> toy.Wave:
    run.stream(toy.Wave, frames=2, shapes={"potential": (1,), "energy": ()})
    return toy.Wave(np.zeros((2, 1)), np.zeros(2), np.zeros(2))


@stage
def too_few(config: toy.MeshConfig, *, run: StageRun) -> toy.Wave:
    history = run.stream(toy.Wave, frames=2, shapes={"potential": (1,), "energy": ()})
    history.append(potential=[0.0], energy=0.0)
    return history.finish(time=np.zeros(1), resumed=False)


@stage
def not_streamable(config: toy.MeshConfig, *, run: StageRun) -> toy.Film:
    run.stream(toy.Surface, frames=2, shapes={})
    raise AssertionError


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (wrong_record, "returned a Peak, not a Label"),
        (wrong_field, r"Label\.text holds a list"),
        (unfinished, r"not what history\.finish"),
        (too_few, "ends after 1 of the 2 frames announced"),
        (not_streamable, "it is not kept as zarr"),
    ],
)
def test_a_stage_that_breaks_its_promise_is_told_so(
    bad: Any, message: str, store: LocalStore
) -> None:
    with pytest.raises(StageError, match=message):
        run({"bad": bad(toy.MeshConfig())}, store)
    assert list(store.refs()) == []


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        ({"potential": [0.0]}, "a frame of Wave holds potential, energy; got potential"),
        ({"potential": [0.0, 1.0], "energy": 0}, r"shape \(2,\), announced \(1,\)"),
    ],
)
def test_a_frame_of_another_form_than_announced_is_refused(
    frame: dict[str, Any], message: str, store: LocalStore
) -> None:
    @stage
    def bad_frame(config: toy.MeshConfig, *, run: StageRun) -> toy.Wave:
        history = run.stream(toy.Wave, frames=2, shapes={"potential": (1,), "energy": ()})
        history.append(**frame)
        raise AssertionError

    with pytest.raises(StageError, match=message):
        run({"bad": bad_frame(toy.MeshConfig())}, store)


@stage
def chatty(config: toy.MeshConfig, *, run: StageRun) -> toy.Label:
    run.warn("thin film")
    run.warn("thin film")
    run.tell("assembled")
    run.note("solver", {"iterations": np.int64(5), "residuals": np.array([1.0, 0.5])})
    return toy.Label("done")


def test_warnings_and_notes_are_kept_with_the_result(
    store: LocalStore, events: list[Event]
) -> None:
    manifest = run({"x": chatty(toy.MeshConfig())}, store, listen=events.append)["x"].manifest
    assert manifest.warnings == ("thin film",)
    assert manifest.notes == {"solver": {"iterations": 5, "residuals": [1.0, 0.5]}}
    assert [type(event) for event in events][1:4] == [StageWarned, StageWarned, StageTold]
    assert events[3] == StageTold("x", "chatty", "assembled")
    assert isinstance(events[-1], StageFinished)
    assert store.find(manifest.ref) == manifest


def test_a_hit_computed_with_other_library_versions_is_told(
    store: LocalStore, events: list[Event]
) -> None:
    node = toy.mesh(toy.MeshConfig())
    ref = run({"mesh": node}, store)["mesh"].manifest.ref
    about = store.manifest(ref).environment
    installed = about["versions"]["scipy"]
    forge(store, ref, environment={**about, "versions": {**about["versions"], "scipy": "0.1"}})
    run({"mesh": node}, store, listen=events.append)
    assert [event.message for event in events if isinstance(event, StageWarned)] == [
        f"the stored result is of scipy 0.1 (installed: {installed})"
    ]


def test_a_stage_without_a_source_file_cannot_be_run(store: LocalStore) -> None:
    namespace: dict[str, Any] = {"__name__": "nowhere"}
    exec(
        "from tests.pipeline.toy import *\n"
        "@stage\ndef typed_in(config: MeshConfig) -> Label: return Label('')\n",
        namespace,
    )
    with pytest.raises(InputError, match="'nowhere' has no source file"):
        run({"x": namespace["typed_in"](toy.MeshConfig())}, store)


@pytest.mark.parametrize("after", [1, 64, 100])
def test_a_stage_can_be_shown_to_resume(after: int) -> None:
    film = toy.mesh.compute(toy.MeshConfig())
    resumed = interrupted_and_resumed(toy.wave, toy.WaveConfig(), film.surface, after=after)
    plain = toy.wave.compute(toy.WaveConfig(), film.surface)
    np.testing.assert_array_equal(resumed.potential, plain.potential)
