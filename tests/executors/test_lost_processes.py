"""Workers die, schedulers come and go: a sweep goes on, and computes nothing twice."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from pipeline.computing.obtaining import Policy
from pipeline.errors import StageError
from pipeline.events import CaseEvent, Event, StageProgress, StageStarted
from pipeline.executors.opening import opened
from pipeline.executors.protocol import LostExecutor
from pipeline.manifest import hash_files
from pipeline.nodes import Node, stage
from pipeline.runner import run
from pipeline.scheduling.cases import Case, CaseDone, CaseFailed, CaseResult
from pipeline.store import LocalStore
from pipeline.store.labels import process_label
from pipeline.sweep import sweep
from tests.executors.clusters import Cluster, at_work, cluster
from tests.pipeline import toy

OFTEN = Policy(checkpoint_interval=0.05)


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    return LocalStore(tmp_path / "store")


@pytest.fixture
def lone(tmp_path: Path) -> Iterator[Cluster]:
    """A scheduler without workers yet."""
    with cluster(tmp_path / "cluster", workers=0) as started:
        yield started


def plan(gain: float, pause: float = 0.0) -> dict[str, Node[Any]]:
    film = toy.mesh(toy.MeshConfig())
    history = toy.wave(toy.WaveConfig(gain=gain, pause=pause), surface=film.part("surface"))
    return {"wave": history}


def cases(count: int, pause: float) -> list[Case]:
    return [Case(str(n), plan(1.0 + n, pause)) for n in range(count)]


class Meddling:
    """A listener that does something once, when a wave has come to frame 30 or further.

    Parameters
    ----------
    meddle
        Takes the key of that wave.
    """

    def __init__(self, meddle: Callable[[str], None]) -> None:
        self.events: list[Event] = []
        self._meddle = meddle
        self._keys: dict[str, str] = {}
        self._done = False

    def __call__(self, told: Event) -> None:
        assert threading.current_thread() is threading.main_thread()
        assert isinstance(told, CaseEvent)
        event = told.event
        self.events.append(event)
        if isinstance(event, StageStarted):
            self._keys[told.case] = event.key
        if isinstance(event, StageProgress) and event.done >= 30 and not self._done:
            self._done = True
            self._meddle(self._keys[told.case])

    @property
    def started(self) -> list[StageStarted]:
        return [event for event in self.events if isinstance(event, StageStarted)]


def assert_all_as_unbroken(results: list[CaseResult], store: LocalStore, folder: Path) -> None:
    """Every case is done, with the bytes of runs that nothing happened to."""
    unbroken = LocalStore(folder / "unbroken")
    for result in results:
        assert isinstance(result, CaseDone), result
        (outcome,) = run(plan(1.0 + int(result.name)), unbroken).values()
        assert result.outcomes["wave"].key == outcome.key
        assert hash_files(unbroken.data(outcome.ref)) == hash_files(store.data(outcome.ref))
        assert store.verify(outcome.ref, full=True) == ()


def test_a_worker_killed_in_the_middle_of_a_case_costs_no_more_than_a_checkpoint_interval(
    lone: Cluster, store: LocalStore, tmp_path: Path
) -> None:
    for _ in range(2):
        lone.start_worker()
    killed: list[int] = []

    def kill(key: str) -> None:
        (process,) = at_work(store.path, key)
        os.kill(process, signal.SIGKILL)
        killed.append(process)

    listen = Meddling(kill)
    with opened(None, lone.address, store, process_label()) as executor:
        results = list(sweep(cases(2, pause=0.005), store, executor, listen=listen, policy=OFTEN))
    assert len(killed) == 1
    assert len(results) == 2
    assert_all_as_unbroken(results, store, tmp_path)
    # One of the waves was begun again, from where its worker was killed, and nothing else.
    stages = [event.stage for event in listen.started if event.resumed_frames is None]
    resumed = [e.resumed_frames for e in listen.started if e.resumed_frames is not None]
    assert stages.count("mesh") <= 1  # the last words of a worker are lost with it
    assert stages.count("wave") <= 2
    assert len(resumed) == 1
    assert 0 < resumed[0] < toy.FRAMES


def test_a_sweep_outlives_its_scheduler(lone: Cluster, store: LocalStore, tmp_path: Path) -> None:
    lone.start_worker()

    def restart(key: str) -> None:
        assert lone.scheduler is not None
        lone.scheduler.kill()
        lone.scheduler.wait()
        for worker in lone.workers:
            worker.kill()
        lone.start_scheduler()
        lone.start_worker()

    told: list[str] = []
    listen = Meddling(restart)
    with opened(None, lone.address, store, process_label(), told.append) as executor:
        results = list(sweep(cases(2, pause=0.005), store, executor, listen=listen, policy=OFTEN))
    assert any("trying to find it again" in line for line in told)
    assert len(results) == 2
    assert_all_as_unbroken(results, store, tmp_path)
    assert any(e.resumed_frames for e in listen.started)


@pytest.mark.slow
def test_a_scheduler_that_does_not_come_back_ends_the_sweep_with_a_clear_message(
    lone: Cluster, store: LocalStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pipeline.executors.dask.RECONNECT", 0.5)
    lone.start_worker()

    def end(key: str) -> None:
        lone.stop()
        monkeypatch.setattr("pipeline.executors.opening.CONNECT", 1.0)

    broken = Meddling(end)
    with (
        opened(None, lone.address, store, process_label()) as executor,
        pytest.raises(LostExecutor, match=r"did not come back within 0.5 s") as caught,
    ):
        list(sweep(cases(2, 0.005), store, executor, listen=broken, policy=OFTEN))
    assert caught.value.exit_code == 1
    # What is there is used by the next call, here without a cluster.
    listen = Meddling(lambda key: None)
    results = list(sweep(cases(2, pause=0.0), store, listen=listen))
    assert_all_as_unbroken(results, store, tmp_path)
    assert "mesh" not in [event.stage for event in listen.started]
    assert any(e.resumed_frames for e in listen.started)


@stage
def deadly(config: toy.MeshConfig) -> toy.Label:
    os.kill(os.getpid(), signal.SIGKILL)
    return toy.Label("never")


def test_a_stage_that_kills_its_workers_fails_and_the_others_are_computed(
    lone: Cluster, store: LocalStore
) -> None:
    lone.start_worker(nanny=True)
    # One after the other, since those that wait on a worker that dies are suspected as well.
    both = [Case("bad", {"x": deadly(toy.MeshConfig())}), Case("good", plan(1.0))]
    with opened(None, lone.address, store, process_label()) as executor:
        results = {r.name: r for case in both for r in sweep([case], store, executor)}
    failed = results["bad"]
    assert isinstance(failed, CaseFailed)
    assert isinstance(failed.error, StageError)
    assert "2 processes that ran it died" in failed.error.cause
    assert "memory" in failed.error.remedy
    assert isinstance(results["good"], CaseDone)


def test_work_waits_for_workers_that_come_late(
    lone: Cluster, store: LocalStore, tmp_path: Path
) -> None:
    told: list[str] = []
    with opened(None, lone.address, store, process_label(), told.append) as executor:
        assert told == ["the scheduler has no workers yet; waiting for some to come"]
        lone.start_worker()  # it was not there to be examined when the connection was made
        (result,) = sweep(cases(1, 0.0), store, executor)
    assert_all_as_unbroken([result], store, tmp_path)


def test_a_scheduler_need_not_have_the_program(store: LocalStore, tmp_path: Path) -> None:
    for name in ("pipeline", "stages", "workflows", "tests"):
        folder = tmp_path / "bare" / name
        folder.mkdir(parents=True)
        (folder / "__init__.py").write_text("raise ImportError('not here')\n")
    with cluster(tmp_path / "cluster", workers=0) as started:
        started.stop()
        started.start_scheduler(PYTHONPATH=str(tmp_path / "bare"))
        started.start_worker()
        with opened(None, started.address, store, process_label()) as executor:
            (result,) = sweep(cases(1, 0.0), store, executor)
    assert_all_as_unbroken([result], store, tmp_path)


def test_what_was_submitted_ends_as_stopped_if_there_are_no_workers(
    lone: Cluster, store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pipeline.executors.dask.REFRESH", 0.2)
    timer = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
    with opened(None, lone.address, store, process_label()) as executor:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            list(sweep(cases(3, 0.0), store, executor))
