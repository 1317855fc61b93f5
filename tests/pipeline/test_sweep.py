"""Many cases are computed node by node, and what they share once."""

from __future__ import annotations

import contextlib
import pickle
import signal
import threading
import weakref
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest

from pipeline.errors import StageError
from pipeline.events import CaseEvent, Event, StageHit, StageStarted, StageStopping
from pipeline.executors import Completion, Executor, SerialExecutor
from pipeline.executors.protocol import Hear
from pipeline.nodes import Node, stage
from pipeline.runner import run
from pipeline.running.interrupts import Stopped
from pipeline.scheduling.cases import Case, CaseDone, CaseFailed
from pipeline.scheduling.outcome import Outcome
from pipeline.store import LocalStore
from pipeline.sweep import sweep
from pipeline.task import Task
from tests.pipeline import toy


def plan(gain: float = 1.0, label: str = "flat", fail_at: int = -1) -> dict[str, Node[Any]]:
    film = toy.mesh(toy.MeshConfig(label=label))
    waves = toy.WaveConfig(gain=gain, frames=3, fail_at=fail_at)
    history = toy.wave(waves, surface=film.part("surface"))
    peak = toy.peak(toy.MeshConfig(), history=history)
    return {"wave": history, "report": toy.report(toy.MeshConfig(label=label), peak)}


def gains(*values: float) -> list[Case]:
    return [Case(f"gain {value}", plan(value)) for value in values]


class Shuffled(SerialExecutor):
    """Takes several jobs at once, sends them as others would, and ends the newest first."""

    slots = 4
    in_process = False

    def submit(self, tag: Any, function: Callable[..., Any], *arguments: Any) -> None:
        sent = pickle.dumps((function, arguments))
        assert len(sent) < 5000
        super().submit(tag, *(lambda f, a: (f, *a))(*pickle.loads(sent)))
        self._waiting.rotate(1)

    def next(self, hear: Hear, timeout: float | None = None) -> Completion | None:
        completion = None if timeout == 0 else super().next(hear)
        return pickle.loads(pickle.dumps(completion))


EXECUTORS = pytest.mark.parametrize("executor", [SerialExecutor, Shuffled])


class Heard:
    """Events of a sweep."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def __call__(self, event: Event) -> None:
        self.events.append(event)

    def of(self, kind: type) -> list[tuple[str, str]]:
        """Case and node of all events of a kind."""
        inner = [(e.case, e.event) for e in self.events if isinstance(e, CaseEvent)]
        return [(case, getattr(event, "node", "")) for case, event in inner if type(event) is kind]


@EXECUTORS
def test_what_cases_share_is_computed_once(
    executor: Callable[[], Executor], store: LocalStore
) -> None:
    heard = Heard()
    results = list(sweep(gains(1.0, 2.0, 3.0), store, executor(), listen=heard))
    assert sorted(result.name for result in results) == ["gain 1.0", "gain 2.0", "gain 3.0"]
    assert all(isinstance(result, CaseDone) for result in results)
    started = [node for _, node in heard.of(StageStarted)]
    assert (started.count("mesh"), started.count("wave"), started.count("peak")) == (1, 3, 3)
    # The film of the two cases that did not compute it, and equal reports of equal (rounded) peaks.
    assert [node for _, node in heard.of(StageHit)].count("mesh") == 2
    assert len(heard.of(StageStarted)) + len(heard.of(StageHit)) == 3 * 4


@EXECUTORS
def test_a_sweep_has_the_outcomes_of_single_runs(
    executor: Callable[[], Executor], store: LocalStore, tmp_path: Any
) -> None:
    single = run(plan(2.0), LocalStore(tmp_path / "single"))
    (result,) = sweep(gains(2.0), store, executor())
    assert {n: (o.key, o.content) for n, o in result.outcomes.items()} == {
        n: (o.key, o.content) for n, o in single.items()
    }
    assert result.outcomes["report"].load() == single["report"].load()


def test_a_second_sweep_finds_everything(store: LocalStore) -> None:
    list(sweep(gains(1.0, 2.0), store))
    heard = Heard()
    results = list(sweep(gains(1.0, 2.0), store, listen=heard))
    assert [type(event) for event in heard.events] == [CaseEvent] * 8
    assert heard.of(StageStarted) == []
    assert all(outcome.hit for result in results for outcome in result.outcomes.values())


@EXECUTORS
def test_a_failed_stage_fails_only_the_cases_that_need_it(
    executor: Callable[[], Executor], store: LocalStore
) -> None:
    cases = [
        Case("bad", plan(fail_at=1)),
        Case("good", plan()),
        # The same wave, so the same failure: it is not computed again to fail again.
        Case("bad again", plan(fail_at=1, label="other")),
    ]
    heard = Heard()
    results = {r.name: r for r in sweep(cases, store, executor(), listen=heard)}
    assert isinstance(results["good"], CaseDone)
    assert [node for _, node in heard.of(StageStarted)].count("wave") == 2
    for name in ("bad", "bad again"):
        failed = results[name]
        assert isinstance(failed, CaseFailed)
        assert failed.stage == "wave"
        assert isinstance(failed.error, StageError)
        assert failed.error.cause == "no convergence in frame 1"
        assert failed.error.remedy == "choose another gain"
        assert failed.error.after == "1 of 3 steps"
        assert failed.error.exit_code == 1


def text_of(about: str, outcomes: Mapping[str, Outcome]) -> str:
    if about == "unlucky":
        raise ValueError("no luck")
    return f"{about}: {outcomes['report'].load().text}"


@EXECUTORS
def test_what_finish_makes_of_a_case_is_handed_out(
    executor: Callable[[], Executor], store: LocalStore
) -> None:
    cases = [Case(n, plan(label=n), about=n) for n in ("a", "b", "unlucky")]
    results = {r.name: r for r in sweep(cases, store, executor(), finish=text_of)}
    done, failed = results["b"], results["unlucky"]
    assert isinstance(done, CaseDone)
    assert done.value == f"b: {done.outcomes['report'].load().text}"
    assert isinstance(failed, CaseFailed)
    assert (failed.stage, str(failed.error)) == ("", "no luck")
    assert failed.outcomes.keys() == {"wave", "report"}


def test_a_damaged_artefact_fails_the_cases_that_need_it(store: LocalStore) -> None:
    (done,) = sweep(gains(1.0), store)
    (store.data(done.outcomes["wave"].ref) / "record.zarr" / "zarr.json").unlink()
    results = {r.name: r for r in sweep(gains(1.0, 2.0), store)}
    assert isinstance(results["gain 2.0"], CaseDone)
    failed = results["gain 1.0"]
    assert isinstance(failed, CaseFailed)
    assert failed.stage == "wave"
    assert "damaged" in str(failed.error)


def test_a_case_without_nodes_is_done(store: LocalStore) -> None:
    assert [*sweep([Case("empty", {})], store)] == [CaseDone("empty", {})]
    assert [*sweep([], store)] == []


def test_cases_are_taken_as_there_is_room_and_forgotten_when_done(store: LocalStore) -> None:
    alive: weakref.WeakSet[Node[Any]] = weakref.WeakSet()
    taken = []

    def cases() -> Iterator[Case]:
        for number in range(30):
            node = toy.mesh(toy.MeshConfig(height=1.0 + number))
            alive.add(node)
            taken.append(number)
            yield Case(str(number), {"mesh": node})

    for done, result in enumerate(sweep(cases(), store)):
        assert result.name == str(done)
        assert len(taken) <= done + 2
        assert len(alive) <= 2  # this one and the next


def test_cases_are_finished_one_after_the_other_in_one_process(store: LocalStore) -> None:
    heard = Heard()
    list(sweep(gains(1.0, 2.0), store, listen=heard))
    assert [case for case, _ in heard.of(StageStarted)] == ["gain 1.0"] * 4 + ["gain 2.0"] * 2


def test_no_more_cases_wait_for_a_shared_result_than_fit(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pipeline.scheduling.schedule.OPEN", 5)
    taken = []

    def cases() -> Iterator[Case]:
        for number in range(20):
            taken.append(number)
            yield Case(str(number), plan(1.0 + number))

    class Watching(Shuffled):
        def next(self, hear: Hear, timeout: float | None = None) -> Completion | None:
            if not done:
                assert len(taken) <= 5
            return super().next(hear, timeout)

    done: list[str] = []
    for result in sweep(cases(), store, Watching()):
        done.append(result.name)
        assert len(taken) <= len(done) + 6
    assert len(done) == 20


@stage
def slow(config: toy.MeshConfig) -> toy.Label:
    return toy.Label("done")


class Away(SerialExecutor):
    """As if its jobs ran elsewhere: none ends before it is asked to stop."""

    in_process = False
    slots = 2

    def next(self, hear: Hear, timeout: float | None = None) -> Completion | None:
        if self._stopped:
            return super().next(hear)
        if timeout:
            for tag, _, _ in self._waiting:
                hear(tag, StageStarted("slow", "slow", "key"))
            signal.raise_signal(signal.SIGINT)
        return None


def test_a_signal_lets_stages_elsewhere_save_their_work(store: LocalStore) -> None:
    assert threading.current_thread() is threading.main_thread()
    heard, before = Heard(), signal.getsignal(signal.SIGINT)
    cases = [Case(str(n), {"slow": slow(toy.MeshConfig(height=n))}) for n in range(5)]
    executor = Away()
    with pytest.raises(Stopped, match="SIGINT"):
        list(sweep(cases, store, executor, listen=heard))
    assert heard.of(StageStopping) == [("0", "slow"), ("1", "slow")]
    assert (
        executor.next(lambda tag, event: None) is None
    )  # all that was submitted has been handed out
    assert signal.getsignal(signal.SIGINT) is before


def test_an_abandoned_sweep_gives_the_signals_back(store: LocalStore) -> None:
    before = signal.getsignal(signal.SIGINT)
    with contextlib.closing(sweep(gains(1.0, 2.0), store)) as results:  # type: ignore[type-var]
        next(results)
        assert signal.getsignal(signal.SIGINT) is not before
    assert signal.getsignal(signal.SIGINT) is before


def test_a_task_of_other_code_or_configuration_is_refused(store: LocalStore) -> None:
    tasks: list[Task] = []

    class Keeping(SerialExecutor):
        def submit(self, tag: Any, function: Callable[..., Any], *arguments: Any) -> None:
            tasks.append(arguments[0])
            super().submit(tag, function, *arguments)

    list(sweep([Case("", {"mesh": toy.mesh(toy.MeshConfig())})], store, Keeping()))
    (task,) = tasks
    assert task.statement().key == task.key
    for other in (
        Task(**{**vars(task), "config": toy.MeshConfig(height=2.0)}),
        Task(**{**vars(task), "key": "0" * 40}),
    ):
        with pytest.raises(StageError, match="is not the code of the process that asked"):
            other.statement()
