"""Jobs run on a real scheduler with two worker processes as they do here."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from pipeline.errors import InputError, StageError
from pipeline.events import CaseEvent, Event, StageHit, StageProgress, StageStarted, StageWarned
from pipeline.executors import Executor
from pipeline.executors.opening import opened
from pipeline.manifest import hash_files
from pipeline.nodes import Node, StageRun, stage
from pipeline.runner import run
from pipeline.scheduling.cases import Case, CaseDone, CaseFailed
from pipeline.scheduling.outcome import Outcome
from pipeline.store import LocalStore
from pipeline.store.labels import process_label
from pipeline.sweep import sweep
from pipeline.testing.executors import ExecutorConformance
from tests.executors.clusters import Cluster, cluster
from tests.pipeline import toy


@pytest.fixture(scope="module")
def two_workers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with cluster(tmp_path_factory.mktemp("cluster")) as started:
        yield started


@pytest.fixture
def executor(two_workers: Cluster, store: LocalStore) -> Iterator[Executor]:
    with opened(None, two_workers.address, store, process_label()) as found:
        yield found


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    return LocalStore(tmp_path / "store")


class TestDaskExecutor(ExecutorConformance):
    @pytest.fixture
    def executor(self, executor: Executor) -> Executor:
        return executor


def plan(gain: float = 1.0, **waves: Any) -> dict[str, Node[Any]]:
    film = toy.mesh(toy.MeshConfig())
    config = toy.WaveConfig(**{"gain": gain, "frames": 70, **waves})
    history = toy.wave(config, surface=film.part("surface"))
    return {"wave": history, "peak": toy.peak(toy.MeshConfig(), history=history)}


def started(events: list[Event]) -> list[str]:
    inner = [e.event if isinstance(e, CaseEvent) else e for e in events]
    return [event.stage for event in inner if isinstance(event, StageStarted)]


def worker_of(about: str, outcomes: Mapping[str, Outcome]) -> tuple[str, int, float]:
    return about, os.getpid(), outcomes["peak"].load().value


def test_a_sweep_over_two_workers_computes_each_key_once_and_the_same_bytes(
    executor: Executor, store: LocalStore, tmp_path: Path
) -> None:
    events: list[Event] = []
    cases = [Case(f"{n}", plan(1.0 + n), about=f"{n}") for n in range(12)]
    results = list(sweep(cases, store, executor, finish=worker_of, listen=events.append))
    assert len(results) == 12
    assert sorted(started(events)) == ["mesh"] + 12 * ["peak"] + 12 * ["wave"]
    hits = [e.event for e in events if isinstance(e, CaseEvent) and isinstance(e.event, StageHit)]
    assert [hit.stage for hit in hits] == 11 * ["mesh"]
    values = [result.value for result in results if isinstance(result, CaseDone)]
    assert sorted(int(about) for about, _, _ in values) == list(range(12))
    workers = {process for _, process, _ in values}
    assert len(workers) == 2
    assert os.getpid() not in workers
    pids = {store.manifest(ref).environment["pid"] for ref in store.refs()}
    assert pids == workers
    here = LocalStore(tmp_path / "here")
    for gain in (1.0, 12.0):
        for outcome in run(plan(gain), here).values():
            files = hash_files(here.data(outcome.ref))
            assert files == hash_files(store.data(outcome.ref))


def test_a_single_run_may_use_workers(executor: Executor, store: LocalStore) -> None:
    events: list[Event] = []
    outcomes = run(plan(), store, executor=executor, listen=events.append)
    assert [outcome.hit for outcome in outcomes.values()] == [False, False]
    assert started(events) == ["mesh", "wave", "peak"]
    assert outcomes["wave"].manifest.environment["argv"] == sys.argv
    assert all(o.hit for o in run(plan(), store, executor=executor).values())


def test_an_error_comes_back_with_class_place_and_remedy(
    executor: Executor, store: LocalStore
) -> None:
    cases = [Case("bad", plan(fail_at=40)), Case("good", plan())]
    results = {r.name: r for r in sweep(cases, store, executor)}
    assert isinstance(results["good"], CaseDone)
    failed = results["bad"]
    assert isinstance(failed, CaseFailed)
    error = failed.error
    assert isinstance(error, StageError)
    assert (error.stage, error.cause) == ("wave", "no convergence in frame 40")
    assert (error.after, error.remedy) == ("40 of 70 steps", "choose another gain")
    assert str(error).startswith(
        "stage wave failed after 40 of 70 steps: no convergence in frame 40"
    )
    assert error.kept is not None
    assert (error.kept / "data").is_dir()
    assert "toy.py" in error.__notes__[0]  # for --traceback


class OddError(Exception):
    def __init__(self, one: int, *, two: int) -> None:
        super().__init__(f"odd {one} {two}")


def odd(about: Any, outcomes: Mapping[str, Outcome]) -> None:
    raise OddError(1, two=2)


def test_an_error_that_cannot_be_sent_is_told_all_the_same(
    executor: Executor, store: LocalStore
) -> None:
    (failed,) = sweep([Case("x", {})], store, executor, finish=odd)
    assert isinstance(failed, CaseFailed)
    assert str(failed.error) == "unexpected OddError: odd 1 2"


def test_what_cannot_be_sent_to_workers_is_refused(executor: Executor, store: LocalStore) -> None:
    (failed,) = sweep([Case("x", {})], store, executor, finish=lambda about, outcomes: None)
    assert isinstance(failed, CaseFailed)
    assert isinstance(failed.error, InputError)
    assert "at the top of an importable module" in str(failed.error)


@stage
def talking(config: toy.MeshConfig, *, run: StageRun) -> toy.Label:
    run.warn("look out")
    for step in range(4):
        run.progress(step + 1, 4)
        time.sleep(config.height)
    return toy.Label("told")


def test_events_of_a_long_stage_arrive_while_it_runs(executor: Executor, store: LocalStore) -> None:
    heard: list[tuple[float, Event]] = []
    node = talking(toy.MeshConfig(height=0.5))
    run({"x": node}, store, executor=executor, listen=lambda e: heard.append((time.time(), e)))
    kinds = [type(event) for _, event in heard]
    assert kinds.count(StageWarned) == 1
    assert kinds.count(StageProgress) == 4
    times = [when for when, event in heard if isinstance(event, StageProgress)]
    assert times[-1] - times[0] > 0.2  # in several bundles, before the end


def test_tiny_jobs_send_no_messages_of_their_own(executor: Executor, store: LocalStore) -> None:
    from distributed import Client

    from pipeline.executors.dask import DaskExecutor

    assert isinstance(executor, DaskExecutor)
    cases = [Case(str(n), {"mesh": toy.mesh(toy.MeshConfig(height=n))}) for n in range(2, 22)]
    events: list[Event] = []
    run(plan(), store, executor=executor)  # what is imported at first takes its time
    list(sweep(cases, store, executor, listen=events.append))
    assert len(started(events)) == 20
    connection: Any = executor._connection
    client: Client = connection._client
    assert len(client.get_events(connection._name)) < 20


def test_the_scheduler_sees_bytes_only_and_few_of_them(
    executor: Executor, store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes = []
    real: Any = executor._connection.submit  # type: ignore[attr-defined]

    def submit(ticket: Any, job: bytes, attempt: int) -> Any:
        sizes.append(len(job))
        return real(ticket, job, attempt)

    monkeypatch.setattr(executor._connection, "submit", submit)  # type: ignore[attr-defined]
    run(plan(), store, executor=executor)
    assert len(sizes) == 3
    assert max(sizes) < 2500
