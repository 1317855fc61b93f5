"""Workers on this machine: one core each, out of reach of the terminal's signals, never left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from pipeline.errors import InputError
from pipeline.executors import SerialExecutor
from pipeline.executors.opening import THREADS, opened
from pipeline.running.checkpoints import Checkpoint
from pipeline.scheduling.cases import Case, CaseDone
from pipeline.scheduling.outcome import Outcome
from pipeline.store import LocalStore
from pipeline.store.labels import process_label
from pipeline.sweep import sweep
from tests.executors.clusters import ROOT, at_work, eventually

SLOW = """
from pipeline.executors.opening import opened
from pipeline.runner import run
from pipeline.store import LocalStore
from pipeline.store.labels import process_label
from tests.pipeline import toy

if __name__ == "__main__":
    store = LocalStore("store")
    film = toy.mesh(toy.MeshConfig())
    waves = toy.WaveConfig(pause=0.05, frames=2000)
    with opened(2, None, store, process_label()) as executor:
        history = toy.wave(waves, surface=film.part("surface"))
        listen = lambda event: print(type(event).__name__, flush=True)
        run({"wave": history}, store, executor=executor, checkpoint_interval=3600.0, listen=listen)
"""


@pytest.fixture
def slow(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """A process, at the head of a group as in a terminal, and its worker that computes a wave."""
    (tmp_path / "slow.py").write_text(SLOW)
    process = subprocess.Popen(
        [sys.executable, "slow.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    for line in process.stdout:
        if "StageProgress" in line:
            break
    yield process, at_work(tmp_path / "store")[0]
    process.kill()
    process.communicate()


def is_running(process: int) -> bool:
    try:
        return "Z" not in Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False


@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)]
)
def test_a_signal_of_the_terminal_lets_workers_save_their_work(
    number: signal.Signals, slow: tuple[subprocess.Popen[str], int], tmp_path: Path
) -> None:
    process, worker = slow
    assert worker != process.pid
    os.killpg(process.pid, number)
    out, err = process.communicate(timeout=60)
    assert "StageStopping" in out
    assert err.splitlines()[-1].endswith(f"Stopped: {number.name}")
    (state,) = (tmp_path / "store" / "checkpoints").glob("*/state.npz")
    data = tmp_path / "store" / "tmp" / state.parent.name / "data"
    saved = Checkpoint.load(state, state.parent.name, data)
    assert saved is not None
    assert saved.streams["record"].frames_done > 0
    eventually(lambda: not is_running(worker))


def test_workers_end_when_the_process_that_started_them_is_killed(
    slow: tuple[subprocess.Popen[str], int],
) -> None:
    process, worker = slow
    process.kill()
    eventually(lambda: not is_running(worker))


def environment_of(about: Any, outcomes: Mapping[str, Outcome]) -> dict[str, str]:
    time.sleep(0.05)
    return {name: os.environ.get(name, "") for name in THREADS} | {"pid": str(os.getpid())}


def test_each_worker_has_one_core(tmp_path: Path) -> None:
    store = LocalStore(tmp_path / "store")
    cases = [Case(str(n), {}) for n in range(6)]
    with opened(2, None, store, process_label()) as executor:
        assert executor.slots >= 2
        results = list(sweep(cases, store, executor, finish=environment_of))
    found = [result.value for result in results if isinstance(result, CaseDone)]
    assert len({each.pop("pid") for each in found}) == 2
    assert found == 6 * [THREADS]


def test_a_scheduler_file_tells_the_address(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pipeline.executors.opening.CONNECT", 0.5)
    file = tmp_path / "scheduler.json"
    store = LocalStore(tmp_path / "store")
    for contents, message in (
        ('{"address": "tcp://127.0.0.1:1"}', "no dask scheduler answers at 'tcp://127.0.0.1:1'"),
        ("{}", "is no scheduler file.*address"),
    ):
        file.write_text(contents)
        with (
            pytest.raises(InputError, match=message),
            opened(None, str(file), store, process_label()),
        ):
            pass


def test_more_workers_than_cores_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pipeline.executors.opening._cores", lambda: 2)
    monkeypatch.setattr(
        "pipeline.executors.opening._on_local_workers", lambda workers, warn: SerialExecutor()
    )
    lines: list[str] = []
    for workers in (2, 3):
        with opened(workers, None, LocalStore(tmp_path), process_label(), lines.append):
            pass
    assert lines == ["3 of them share 2 cores, and are no faster than 2"]


def test_one_worker_is_this_process(tmp_path: Path) -> None:
    store = LocalStore(tmp_path / "store")
    for workers in (None, 1):
        with opened(workers, None, store, process_label()) as executor:
            assert isinstance(executor, SerialExecutor)


@pytest.mark.parametrize(
    ("workers", "cluster", "message"),
    [
        (2, "tcp://127.0.0.1:1", "--workers and --cluster contradict each other"),
        (0, None, "--workers must be at least 1, got 0"),
        (
            None,
            "nonsense://x",
            "no dask scheduler answers at 'nonsense://x'.*unknown address scheme",
        ),
        (None, "tls://127.0.0.1:1", "wants TLS, and no certificates are configured"),
        (None, "nowhere.json", "nowhere.json is no scheduler file.*No such file"),
        (None, "tcp://127.0.0.1:1", "no dask scheduler answers at 'tcp://127.0.0.1:1'.*in 0.5 s"),
    ],
)
def test_an_executor_that_cannot_be_is_refused(
    workers: int | None,
    cluster: str | None,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("pipeline.executors.opening.CONNECT", 0.5)
    store = LocalStore(tmp_path / "store")
    with (
        pytest.raises(InputError, match=message),
        opened(workers, cluster, store, process_label()),
    ):
        pass
