"""One computation per key across machines: leases that end with their owner, whatever clocks say."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from pipeline.events import Event, Holder, StageHit, StageStarted, StageWaiting
from pipeline.runner import run
from pipeline.store import RunLabel
from pipeline.store.opening import remote_store
from pipeline.store.remote import RemoteStore
from pipeline.testing.stores import example, manifest_of, publish
from tests.pipeline import toy

Machine = Callable[..., RemoteStore]


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    """A store as a machine of some name sees it, with a cache folder of its own."""

    def on(name: str, **settings: float) -> RemoteStore:
        return remote_store((tmp_path / "shared").as_uri(), cache=tmp_path / name, **settings)

    return on


def refuse(holder: Holder) -> None:
    raise AssertionError(f"waits for {holder}")


def write(store: RemoteStore, contents: bytes = b"contents") -> Any:
    return publish(store, example(), contents)


def test_two_machines_that_want_the_same_result_compute_it_once(
    bucket: str, tmp_path: Path
) -> None:
    events: dict[str, list[Event]] = {"one": [], "other": []}
    film = toy.mesh(toy.MeshConfig())
    run({"film": film}, remote_store(bucket + "/store", cache=tmp_path / "before"))
    wave = toy.wave(toy.WaveConfig(pause=0.003), surface=film.part("surface"))

    def compute(name: str) -> None:
        store = remote_store(bucket + "/store", cache=tmp_path / name)
        run({"wave": wave}, store, listen=events[name].append)

    threads = [threading.Thread(target=compute, args=(name,)) for name in events]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    both = [event for heard in events.values() for event in heard]
    assert sum(isinstance(event, StageStarted) for event in both) == 1
    assert sum(isinstance(event, StageWaiting) for event in both) == 1
    assert sum(isinstance(event, StageHit) and event.stage == "wave" for event in both) == 1


# Another process that takes a lease and never comes back by itself.
HOLDER = """
import time
from pathlib import Path
from pipeline.store.opening import remote_store
from pipeline.testing.stores import example
store = remote_store({url!r}, cache=Path({cache!r}), lease={lease})
with store.writing(example().ref, print):
    print("held")
    time.sleep(600)
"""


@pytest.fixture
def killed_holder(tmp_path: Path, start: Callable[..., Any]) -> Callable[[str, float], int]:
    """Take the lease in a process on some machine, kill it; gives its number."""

    def hold(cache: str, lease: float) -> int:
        url = (tmp_path / "shared").as_uri()
        process = start(HOLDER.format(url=url, cache=str(tmp_path / cache), lease=lease))
        assert process.stdout.readline() == "held\n", process.communicate()
        process.send_signal(signal.SIGKILL)
        process.wait(timeout=30)
        return int(process.pid)

    return hold


def test_the_lease_of_a_dead_process_elsewhere_expires(
    machine: Machine, killed_holder: Callable[[str, float], int]
) -> None:
    dead = killed_holder("one", 1.0)
    waits: list[int] = []
    with machine("other").writing(example().ref, lambda holder: waits.append(holder.pid)):
        pass
    assert waits in ([dead], [])  # none if its time was up before this process looked


def test_the_lease_of_a_dead_process_on_the_same_machine_keeps_nobody_waiting(
    machine: Machine, killed_holder: Callable[[str, float], int]
) -> None:
    killed_holder("one", 3600.0)
    with machine("one").writing(example().ref, refuse):
        pass


def test_the_lease_of_a_living_process_does_not_expire(machine: Machine) -> None:
    entered = threading.Event()

    def wait() -> None:
        with machine("other", lease=0.6).writing(example().ref, lambda holder: None):
            entered.set()

    with machine("one", lease=0.6).writing(example().ref, refuse):
        other = threading.Thread(target=wait)
        other.start()
        assert not entered.wait(timeout=1.5)
    other.join(timeout=30)
    assert entered.is_set()


@pytest.mark.parametrize("hours", [-24.0, 24.0])
def test_clocks_that_differ_change_nothing(
    hours: float, machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = time.time
    label = RunLabel("one")
    here, there = machine("here"), machine("there")
    here.begin(label)
    with here.writing(example().ref, refuse):
        monkeypatch.setattr(time, "time", lambda: clock() + hours * 3600.0)
        assert there.leases.take(example().key, "geometry", alone_here=True) is None
        assert there.leases.busy(example().key)
        assert [one.alive for one in there.upkeep.runs()] == [True]
    assert not there.leases.busy(example().key)


def test_an_owner_that_lost_its_lease_and_publishes_late_goes_on_from_what_is_there(
    machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow, quick = machine("slow", lease=0.2), machine("quick")
    monkeypatch.setattr(slow._heart, "add", lambda *arguments: None)  # its machine sleeps
    with slow.writing(example().ref, refuse) as work:
        time.sleep(0.4)
        first = write(quick, b"first")
        work.begin(resume=False)
        (work.data / "record.h5").write_bytes(b"other")
        assert work.publish(manifest_of(example(), work.data)) == first
    for store in (slow, quick):
        assert store.verify(first.ref, full=True) == ()
        assert (store.data(first.ref) / "record.h5").read_bytes() == b"first"
    assert slow.upkeep.leftovers() == []
    assert slow.objects.listing("leases") == {}


def test_a_lease_that_was_let_go_is_taken_at_once(machine: Machine) -> None:
    for name in ("one", "other", "one"):
        with machine(name).writing(example().ref, refuse):
            pass
    assert len(machine("one").objects.listing("leases")) <= 2


def test_one_of_many_gets_a_lease_that_is_free(machine: Machine) -> None:
    machines = [machine(str(number)) for number in range(6)]
    ready = threading.Barrier(len(machines))
    taken: list[Any] = []

    def take(store: RemoteStore) -> None:
        ready.wait()
        taken.append(store.leases.take(example().key, "geometry", alone_here=True))

    for _ in range(3):
        taken.clear()
        threads = [threading.Thread(target=take, args=(store,)) for store in machines]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        (held,) = [one for one in taken if one is not None]
        machines[0].leases._write(held.path, "geometry", free=True)


def test_a_run_counts_as_dead_when_its_process_gives_no_sign_of_life(
    machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    label, dying = RunLabel("one"), machine("one", lease=0.3)
    monkeypatch.setattr(dying._heart, "add", lambda *arguments: None)
    dying.begin(label)
    there = machine("other", lease=0.3)
    assert [one.alive for one in there.upkeep.runs()] == [True]
    time.sleep(0.5)
    assert [one.alive for one in there.upkeep.runs()] == [False]
    assert os.getpid() == label.process
