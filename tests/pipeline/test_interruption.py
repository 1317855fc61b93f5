"""A killed or interrupted run goes on from its checkpoint and ends with the same bytes."""

from __future__ import annotations

import json
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pipeline.errors import StageError, StoreError
from pipeline.events import (
    Event,
    StageFinished,
    StageHit,
    StageProgress,
    StageStarted,
    StageStopping,
    StageWaiting,
    StageWarned,
)
from pipeline.manifest import hash_files
from pipeline.nodes import Node, StageRun, stage
from pipeline.runner import run
from pipeline.running import checkpoints, interrupts, storerun
from pipeline.store import LocalStore
from tests.pipeline import toy

Start = Callable[..., subprocess.Popen[str]]

# Runs the wave slowly and prints each frame, so that the test can kill it at a known place.
SLOW = """
import sys
from pipeline.running import storerun
from pipeline.events import *
from pipeline.runner import run
from tests.pipeline.test_interruption import *
storerun.PROGRESS_INTERVAL = 0.0
def listen(event):
    if isinstance(event, StageProgress):
        print(event.done)
    elif not isinstance(event, StageHit):
        print(type(event).__name__, getattr(event, "holder", ""))
save = storerun.StoreRun._save
def save_at(self, state):
    if self.histories["record"].frames_done in {saves}:
        save(self, state)
storerun.StoreRun._save = save_at
run(plan(pause={pause}, **{config}), LocalStore({store!r}), listen=listen, checkpoint_interval=0)
"""


def plan(pause: float = 0.0, **config: Any) -> dict[str, Node[Any]]:
    film = toy.mesh(toy.MeshConfig())
    return {"wave": toy.wave(toy.WaveConfig(pause=pause, **config), surface=film.part("surface"))}


def slow(store: LocalStore, saves: str = "range(1000)", pause: float = 0.01, **config: Any) -> str:
    return SLOW.format(store=str(store.path), saves=saves, pause=pause, config=config)


def read_until(process: subprocess.Popen[str], line: str) -> list[str]:
    assert process.stdout is not None
    lines: list[str] = []
    while not lines or not lines[-1].startswith(line):
        text = process.stdout.readline()
        assert text, f"{line!r} never came: {process.communicate()}"
        lines.append(text.strip())
    return lines


def kill_at(
    frame: int, store: LocalStore, start: Start, saves: str = "range(1000)", **config: Any
) -> None:
    process = start(slow(store, saves, **config))
    read_until(process, str(frame))
    process.send_signal(signal.SIGKILL)
    process.wait(timeout=30)


@pytest.fixture
def unbroken(tmp_path: Path) -> LocalStore:
    """A store with the result of an unbroken run."""
    store = LocalStore(tmp_path / "unbroken")
    run(plan(), store)
    return store


def assert_same_bytes(store: LocalStore, unbroken: LocalStore) -> None:
    refs = list(unbroken.refs())
    assert list(store.refs()) == refs
    for ref in refs:
        assert hash_files(store.data(ref)) == hash_files(unbroken.data(ref))
        assert store.verify(ref, full=True) == ()


def resumed_frames(store: LocalStore, **config: Any) -> int | None:
    events: list[Event] = []
    run(plan(**config), store, listen=events.append)
    return next(e for e in events if isinstance(e, StageStarted)).resumed_frames


@pytest.mark.parametrize("frame", [3, 64, 100])
def test_a_killed_run_resumes_and_ends_with_the_same_bytes(
    frame: int, store: LocalStore, unbroken: LocalStore, start: Start
) -> None:
    kill_at(frame, store, start)
    resumed = resumed_frames(store)
    # The frame that was printed is saved; the kill may come a few frames later.
    assert resumed is not None
    assert frame <= resumed < toy.FRAMES
    assert_same_bytes(store, unbroken)
    assert not any((store.path / "checkpoints").iterdir())
    assert not any((store.path / "tmp").iterdir())


def test_chunks_written_after_the_checkpoint_are_written_again(
    store: LocalStore, unbroken: LocalStore, start: Start
) -> None:
    # The checkpoint falls inside the second chunk, which is complete when the kill comes.
    kill_at(130, store, start, saves="[70]")
    assert resumed_frames(store) == 70
    assert_same_bytes(store, unbroken)


@pytest.mark.parametrize("end", [128, 100])
def test_a_history_that_ends_early_resumes_to_the_same_bytes(
    end: int, store: LocalStore, tmp_path: Path, start: Start
) -> None:
    unbroken = LocalStore(tmp_path / "unbroken")
    outcome = run(plan(ends_at=end), unbroken)["wave"]
    kill_at(70, store, start, ends_at=end)
    assert (resumed_frames(store, ends_at=end) or 0) >= 70
    assert_same_bytes(store, unbroken)
    assert outcome.load().potential.shape == (end, toy.POINTS)
    whole = run(plan(), unbroken)["wave"].load()
    np.testing.assert_array_equal(outcome.load().potential[...], whole.potential[:end])


def test_a_run_killed_twice_resumes_twice(
    store: LocalStore, unbroken: LocalStore, start: Start
) -> None:
    kill_at(40, store, start)
    kill_at(110, store, start)
    assert (resumed_frames(store) or 0) >= 110
    assert_same_bytes(store, unbroken)


def test_a_kill_without_checkpoint_starts_anew(
    store: LocalStore, unbroken: LocalStore, start: Start
) -> None:
    kill_at(100, store, start, saves="[]")
    assert resumed_frames(store) is None
    assert_same_bytes(store, unbroken)


def test_a_waiting_process_names_the_holder_and_uses_its_result(
    store: LocalStore, unbroken: LocalStore, start: Start
) -> None:
    first = start(slow(store))
    read_until(first, "1")
    first.send_signal(signal.SIGSTOP)  # however long the second one takes to start
    second = start(slow(store))
    waiting = read_until(second, "StageWaiting")
    first.send_signal(signal.SIGCONT)
    assert waiting[-1].startswith(f"StageWaiting process {first.pid} on ")
    assert waiting[-1].endswith("(stage wave)")
    assert first.wait(timeout=60) == 0
    out, err = second.communicate(timeout=60)
    assert (second.returncode, out) == (0, ""), err  # it computed nothing
    assert_same_bytes(store, unbroken)


def test_a_killed_holder_does_not_block_the_one_that_waits(
    store: LocalStore, unbroken: LocalStore, start: Start
) -> None:
    first = start(slow(store))
    read_until(first, "80")
    first.send_signal(signal.SIGSTOP)  # as above
    second = start(slow(store, pause=0.0))
    read_until(second, "StageWaiting")
    first.send_signal(signal.SIGKILL)
    out, err = second.communicate(timeout=60)
    assert second.returncode == 0, err
    assert out.split()[-2:] == [str(toy.FRAMES), "StageFinished"]
    assert_same_bytes(store, unbroken)


ALL = pytest.mark.parametrize("number", interrupts.SIGNALS)


@ALL
def test_a_run_that_is_asked_to_stop_saves_where_it_is_and_resumes_there(
    number: signal.Signals, store: LocalStore, unbroken: LocalStore, start: Start
) -> None:
    # No checkpoint is due for an hour; the signal makes one.
    process = start(slow(store).replace("checkpoint_interval=0", "checkpoint_interval=3600"))
    read_until(process, "70")
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert "StageStopping" in out
    assert err.splitlines()[-1].endswith(f"Stopped: {number.name}")
    assert (resumed_frames(store) or 0) >= 70
    assert_same_bytes(store, unbroken)


@ALL
def test_a_signal_is_deferred_only_where_checkpoints_are_made(
    number: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interrupts, "REPEATED", 0.0)
    before = [signal.getsignal(each) for each in interrupts.SIGNALS]
    with interrupts.deferred_interrupts() as asked:
        with pytest.raises(interrupts.Stopped) as caught:
            signal.raise_signal(number)
        assert caught.value.exit_code == 128 + number
        asked.deferrable = True
        signal.raise_signal(number)
        assert asked.requested == number
        with pytest.raises(interrupts.Stopped):
            signal.raise_signal(number)
    assert [signal.getsignal(each) for each in interrupts.SIGNALS] == before


def test_a_signal_that_is_sent_twice_over_counts_once_and_ctrl_c_each_time() -> None:
    with interrupts.deferred_interrupts() as asked:
        asked.deferrable = True
        for _ in range(3):
            signal.raise_signal(signal.SIGTERM)
        assert asked.requested == signal.SIGTERM
        with pytest.raises(interrupts.Stopped, match="SIGINT"):
            signal.raise_signal(signal.SIGINT)


def test_a_signal_that_the_process_ignores_stays_ignored() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with interrupts.deferred_interrupts() as asked:
            asked.deferrable = True
            signal.raise_signal(signal.SIGHUP)
            assert asked.requested is None
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


def test_work_is_saved_though_the_terminal_is_gone(store: LocalStore) -> None:
    def gone(event: Event) -> None:
        if isinstance(event, StageProgress | StageStopping):
            signal.raise_signal(signal.SIGHUP)
            raise OSError(5, "Input/output error")

    with pytest.raises(interrupts.Stopped, match="SIGHUP"):
        run(plan(), store, listen=gone)
    assert resumed_frames(store) == 2


@stage
def terminated(config: toy.MeshConfig) -> toy.Label:
    signal.raise_signal(signal.SIGTERM)
    return toy.Label("never")


def test_a_signal_where_nothing_can_be_saved_leaves_nothing(store: LocalStore) -> None:
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(interrupts.Stopped, match="SIGTERM"):
        run({"x": terminated(toy.MeshConfig())}, store)
    assert not any((store.path / "tmp").iterdir())
    assert signal.getsignal(signal.SIGTERM) is before


@stage
def interrupted_late(config: toy.MeshConfig, *, run: StageRun) -> toy.Wave:
    history = run.stream(toy.Wave, frames=2, shapes={"potential": (1,), "energy": ()})
    for _ in range(2):
        history.append(potential=[0.0], energy=0.0)
        run.checkpoint(dict)
    signal.raise_signal(signal.SIGINT)
    return history.finish(time=np.arange(2.0), resumed=False)


def test_an_interrupt_after_the_last_checkpoint_keeps_the_result_and_stops_the_run(
    store: LocalStore,
) -> None:
    events: list[Event] = []
    nodes: dict[str, Node[Any]] = {
        "late": interrupted_late(toy.MeshConfig()),
        "next": toy.mesh(toy.MeshConfig()),
    }
    with pytest.raises(KeyboardInterrupt):
        run(nodes, store, listen=events.append)
    assert [type(event) for event in events] == [StageStarted, StageStopping, StageFinished]
    assert [ref.stage for ref in store.refs()] == ["interrupted_late"]
    assert {name: o.hit for name, o in run(nodes, store).items()} == {"late": True, "next": False}


def test_a_listener_that_cannot_write_inside_the_signal_handler_does_not_fail_the_stage() -> None:
    def reentrant() -> None:
        raise RuntimeError("reentrant call inside <_io.BufferedWriter>")

    with interrupts.deferred_interrupts(reentrant) as asked:
        asked.deferrable = True
        signal.raise_signal(signal.SIGINT)
        assert asked.requested


@stage
def interrupted(config: toy.MeshConfig) -> toy.Label:
    raise KeyboardInterrupt


def test_an_interrupt_frees_the_lock_and_leaves_nothing(store: LocalStore) -> None:
    run({"mesh": toy.mesh(toy.MeshConfig())}, store)
    node = interrupted(toy.MeshConfig())
    for _ in range(2):  # the second one would hang on a lock that is still held
        with pytest.raises(KeyboardInterrupt):
            run({"x": node}, store)
    assert not any((store.path / "tmp").iterdir())
    assert [ref.stage for ref in store.refs()] == ["mesh"]


FAILURES = {"left": 1}


@stage
def flaky(config: toy.WaveConfig, *, run: StageRun) -> toy.Wave:
    """Fails the first time, at frame 100, as a machine without memory would."""
    history = run.stream(toy.Wave, frames=120, shapes={"potential": (1,), "energy": ()})
    saved = run.resume()
    total = np.zeros(1) if saved is None else saved["total"]
    if saved is not None:
        run.note("resumed_at", history.frames_done)
    for frame in range(history.frames_done, 120):
        np.add(total, frame, out=total)
        if frame == 100 and FAILURES["left"]:
            FAILURES["left"] -= 1
            raise MemoryError("no memory left")
        history.append(potential=total, energy=0.0)
        run.checkpoint(lambda: {"total": total})
    return history.finish(time=np.arange(120.0))


def test_a_failure_in_mid_step_never_spoils_the_checkpoint(store: LocalStore) -> None:
    # The state is already that of frame 100 when the failure comes; saving it then would be wrong.
    FAILURES["left"] = 1
    with pytest.raises(StageError, match="no memory left"):
        run({"x": flaky(toy.WaveConfig())}, store, checkpoint_interval=0.0)
    outcome = run({"x": flaky(toy.WaveConfig())}, store)["x"]
    assert outcome.manifest.notes == {"resumed_at": 100}
    expected = np.cumsum(np.arange(120.0))
    np.testing.assert_array_equal(outcome.load().potential[:, 0], expected.astype("float32"))


def test_a_full_disk_keeps_what_was_saved_before(
    store: LocalStore, unbroken: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    real_save = checkpoints.Checkpoint.save

    def save(self: checkpoints.Checkpoint, path: Path) -> None:
        if self.streams["record"].frames_done > 100:
            monkeypatch.setattr("os.fsync", full)
        real_save(self, path)

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(checkpoints.Checkpoint, "save", save)
    with pytest.raises(StoreError, match="no space left"):
        run(plan(), store, checkpoint_interval=0.0)
    monkeypatch.undo()
    assert len(list((store.path / "checkpoints").glob("*/*"))) == 1  # no half-written one
    assert resumed_frames(store) == 100
    assert_same_bytes(store, unbroken)


def test_a_checkpoint_reads_only_the_chunks_that_are_new(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[str] = []

    def sha256(path: Path) -> str:
        read.append(path.name)
        return path.read_text()

    monkeypatch.setattr(checkpoints, "sha256", sha256)
    files = checkpoints.ChunkFiles(tmp_path)
    (tmp_path / "0").write_text("first")
    (tmp_path / "zarr.json").write_text("{}")
    assert files.digests() == {"0": "first"}
    (tmp_path / "1").write_text("second")
    assert files.digests() == {"0": "first", "1": "second"}
    (tmp_path / "0").write_text("rewritten")
    assert files.digests() == {"0": "rewritten", "1": "second"}
    assert read == ["0", "1", "0"]


def interrupted_at_100(store: LocalStore, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Leave a checkpoint of 100 frames behind; its file."""
    real_progress = storerun.StoreRun.progress

    def progress(self: storerun.StoreRun, done: int, total: int) -> None:
        real_progress(self, done, total)
        if done == 100:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(storerun.StoreRun, "progress", progress)
        with pytest.raises(KeyboardInterrupt):
            run(plan(), store, checkpoint_interval=0.0)
    (checkpoint,) = (store.path / "checkpoints").glob("*/state.npz")
    return checkpoint


def load_checkpoint(checkpoint: Path, data: Path) -> checkpoints.Checkpoint:
    found = checkpoints.Checkpoint.load(checkpoint, checkpoint.parent.name, data)
    assert found is not None
    return found


def spoil_versions(checkpoint: Path, data: Path) -> None:
    found = load_checkpoint(checkpoint, data)
    past = {**found.versions, "numpy": "1.0"}
    checkpoints.Checkpoint(**{**vars(found), "versions": past}).save(checkpoint)


def spoil_processor(checkpoint: Path, data: Path) -> None:
    found = load_checkpoint(checkpoint, data)
    other = f"{found.processor} of tomorrow"
    checkpoints.Checkpoint(**{**vars(found), "processor": other}).save(checkpoint)


def spoil_contents(checkpoint: Path, data: Path) -> None:
    contents = bytearray(checkpoint.read_bytes())
    contents[len(contents) // 2] ^= 0xFF
    checkpoint.write_bytes(contents)


def spoil_length(checkpoint: Path, data: Path) -> None:
    checkpoint.write_bytes(checkpoint.read_bytes()[:-100])


def spoil_key(checkpoint: Path, data: Path) -> None:
    found = load_checkpoint(checkpoint, data)
    checkpoints.Checkpoint(**{**vars(found), "key": "another"}).save(checkpoint)


def spoil_chunk(checkpoint: Path, data: Path) -> None:
    chunk = data / "record.zarr" / "potential" / "c.0.0"
    chunk.write_bytes(chunk.read_bytes()[:-1])


def spoil_bit(checkpoint: Path, data: Path) -> None:
    # Nothing would notice it later: the manifest would state the checksum of the spoilt chunk.
    chunk = data / "record.zarr" / "potential" / "c.0.0"
    contents = bytearray(chunk.read_bytes())
    contents[len(contents) // 2] ^= 1
    chunk.write_bytes(contents)


def spoil_data(checkpoint: Path, data: Path) -> None:
    (data / "record.zarr" / "potential" / "c.0.0").unlink()


def spoil_form(checkpoint: Path, data: Path) -> None:
    # As versions saved it that kept every field in chunks of 64 frames, in folders.
    with np.load(checkpoint) as kept:
        arrays = {name: kept[name] for name in kept.files}
    about = json.loads(arrays["about"].tobytes())
    assert about.pop("form") == checkpoints.FORM == 2
    arrays["about"] = np.frombuffer(json.dumps(about).encode(), np.uint8)
    with open(checkpoint, "wb") as file:
        np.savez(file, allow_pickle=False, **arrays)


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (spoil_versions, "saved with other versions of numpy"),
        (spoil_form, "its form is 1, not 2: another version saved it"),
        (spoil_processor, "saved on another kind of processor"),
        (spoil_contents, "cannot be read"),
        (spoil_length, "cannot be read"),
        (spoil_key, "belongs to another result"),
        (spoil_chunk, "missing or damaged"),
        (spoil_bit, "missing or damaged"),
        (spoil_data, "missing or damaged"),
    ],
)
def test_an_unusable_checkpoint_is_discarded_with_a_warning(
    spoil: Callable[[Path, Path], None],
    reason: str,
    store: LocalStore,
    unbroken: LocalStore,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    checkpoint = interrupted_at_100(store, monkeypatch)
    spoil(checkpoint, store.path / "tmp" / checkpoint.parent.name / "data")
    events: list[Event] = []
    run(plan(), store, listen=events.append)
    assert [reason in e.message for e in events if isinstance(e, StageWarned)] == [True]
    assert [e.resumed_frames for e in events if isinstance(e, StageStarted)] == [None]
    assert_same_bytes(store, unbroken)


def test_the_duration_counts_the_work_before_the_interruption(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    checkpoint = interrupted_at_100(store, monkeypatch)
    found = load_checkpoint(checkpoint, store.path / "tmp" / checkpoint.parent.name / "data")
    checkpoints.Checkpoint(**{**vars(found), "seconds": 1e6, "cpu_seconds": 2e6}).save(checkpoint)
    manifest = run(plan(), store)["wave"].manifest
    assert manifest.seconds > 1e6
    assert manifest.cpu_seconds > 2e6


def test_files_left_half_written_never_get_into_the_artefact(
    store: LocalStore, unbroken: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    checkpoint = interrupted_at_100(store, monkeypatch)
    group = store.path / "tmp" / checkpoint.parent.name / "data" / "record.zarr"
    (group / "potential" / "c.1.0.partial").write_bytes(b"half")
    (group / "zarr.json").write_bytes(b"{")
    assert resumed_frames(store) == 100
    assert_same_bytes(store, unbroken)


def test_a_checkpoint_of_other_code_or_config_is_never_used(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    interrupted_at_100(store, monkeypatch)
    assert resumed_frames(store, gain=2.0) is None


def test_a_finished_stage_is_a_hit_after_a_later_interrupt(store: LocalStore) -> None:
    run(plan(), store)
    events: list[Event] = []
    nodes = {**plan(), "x": interrupted(toy.MeshConfig())}
    with pytest.raises(KeyboardInterrupt):
        run(nodes, store, listen=events.append)
    assert [event.stage for event in events if isinstance(event, StageHit)] == ["mesh", "wave"]
    assert not any(isinstance(event, StageWaiting) for event in events)


def test_a_signal_that_comes_just_after_it_was_looked_for_waits_until_the_work_is_saved() -> None:
    """Otherwise the work since the last checkpoint would be lost though it could have been saved."""

    class Late(interrupts.Interrupts):
        looks = 0

        @property
        def requested(self) -> int | None:
            self.looks += 1
            return signal.SIGINT if self.looks > 1 else None

    saved: list[Any] = []
    of_stage = SimpleNamespace(
        interrupts=Late(), _saved_at=time.perf_counter(), _interval=3600.0, _save=saved.append
    )
    checkpoint: Any = storerun.StoreRun.checkpoint
    checkpoint(of_stage, lambda: {"step": 1})
    assert not saved
    with pytest.raises(interrupts.Stopped):
        checkpoint(of_stage, lambda: {"step": 2})
    assert saved == [{"step": 2}]
