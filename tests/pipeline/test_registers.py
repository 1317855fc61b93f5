"""Runs and what they keep: with a name, with a folder, while they live."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import pytest

from pipeline.errors import InputError, StoreError
from pipeline.keys import Ref
from pipeline.runner import run
from pipeline.store import LocalStore, RunLabel
from pipeline.store.cleaning import Limits
from pipeline.store.collection import collect, insists, keepers, plan, remove
from pipeline.store.labels import (
    UNSEEN_DAYS,
    RegisteredRun,
    from_json,
    process_label,
    runs_called,
    to_json,
)
from pipeline.store.registers import Registers
from pipeline.testing.stores import example, publish
from tests.pipeline import toy

Start = Callable[..., "subprocess.Popen[str]"]

DAY = 86400.0

ASKING = """
import time
from pipeline.keys import Ref
from pipeline.store import LocalStore, RunLabel
store, label = LocalStore({store!r}), RunLabel.of({name!r}, {folder!r}) if {folder!r} else RunLabel("worker")
store.begin(label)
store.find(Ref({stage!r}, {key!r}), label)
print("asked", flush=True)
time.sleep(60)
"""


def asking(store: LocalStore, start: Start, ref: Ref, folder: str = "") -> subprocess.Popen[str]:
    """A process that has begun a run, asked for an artefact, and goes on."""
    code = ASKING.format(
        store=str(store.path), stage=ref.stage, key=ref.key, name=None, folder=folder
    )
    process = start(code)
    assert process.stdout is not None
    assert process.stdout.readline() == "asked\n"
    return process


def free(store: LocalStore) -> set[Ref]:
    """What a collection would take."""
    return {removal.row.ref for removal in plan(store, Limits(unreachable=True)).removals}


def test_a_run_without_name_and_folder_keeps_what_it_uses_while_its_process_lives(
    store: LocalStore, start: Start
) -> None:
    ref = publish(store, example()).ref
    process = asking(store, start, ref)
    assert free(store) == set()
    assert remove(store, [ref], store.upkeep.rows(), insists) == []
    process.kill()
    process.communicate()
    assert free(store) == {ref}
    collect(store, plan(store, Limits(unreachable=True)))
    assert list(store.refs()) == []
    assert list(store.upkeep.runs()) == []


def test_a_run_keeps_what_it_uses_while_its_folder_is_there(
    store: LocalStore, tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    label = RunLabel.of(None, folder, "toy")
    ref = publish(store, example()).ref
    store.begin(label)
    store.find(ref, label)
    store.finish(label)
    assert free(store) == set()
    folder.rmdir()
    assert free(store) == {ref}


def test_a_named_run_keeps_what_it_uses_until_it_is_removed(
    store: LocalStore, tmp_path: Path
) -> None:
    label = RunLabel.of("for the paper", tmp_path / "never made")
    ref = publish(store, example()).ref
    store.begin(label)
    store.find(ref, label)
    store.finish(label)
    assert free(store) == set()
    (keeper,) = keepers(store, ref, store.upkeep.rows(), 0.0)
    assert keeper.run is not None
    assert keeper.run.label == label
    store.upkeep.forget(label)
    assert free(store) == {ref}


def test_a_folder_that_cannot_be_seen_from_here_may_be_there_for_some_time(tmp_path: Path) -> None:
    gone = RunLabel.of(None, tmp_path / "gone")
    elsewhere, unmounted = replace(gone, host="elsewhere"), RunLabel.of(None, tmp_path / "a" / "b")
    for label, days in ((gone, 0.0), (elsewhere, UNSEEN_DAYS), (unmounted, UNSEEN_DAYS)):
        ended = RegisteredRun(label, None, alive=False)
        assert ended.keeps(label.began + 0.9 * days * DAY) == (days > 0)
        assert not ended.keeps(label.began + 1.1 * days * DAY)


def test_a_run_that_broke_off_keeps_what_it_used_until_one_of_its_name_ends_well(
    store: LocalStore, tmp_path: Path, start: Start
) -> None:
    old, new = (publish(store, example(gain=gain)).ref for gain in (1.0, 2.0))
    process = asking(store, start, old, str(tmp_path))
    again, last = (RunLabel.of(None, tmp_path) for _ in range(2))
    store.begin(again)
    store.find(new, again)
    store.finish(again)
    assert free(store) == set()  # the other one still goes on
    process.kill()
    process.communicate()
    assert free(store) == set()  # and nobody did its work since
    store.begin(last)
    store.find(new, last)
    store.finish(last)
    assert free(store) == {old}


def test_a_run_registers_all_stages_that_it_needs(store: LocalStore) -> None:
    surface = toy.mesh(toy.MeshConfig()).part("surface")
    wave = toy.wave(toy.WaveConfig(frames=3), surface=surface)
    label = RunLabel("one", named=True)
    for _ in range(2):  # computed, then found
        store.begin(label)
        outcomes = run({"wave": wave}, store, label=label)
        store.finish(label)
        used = set(store.upkeep.used_by(label))
        assert {ref.stage for ref in used} == {"mesh", "wave"}
        assert outcomes["wave"].manifest.ref in used


def test_a_run_without_a_label_is_one_of_this_process(store: LocalStore) -> None:
    run({"mesh": toy.mesh(toy.MeshConfig())}, store)
    (known,) = store.upkeep.runs()
    assert known.label == process_label()
    assert known.alive
    assert free(store) == set()


def test_a_process_that_ends_leaves_no_run_without_name_and_folder(
    store: LocalStore, output: Callable[..., str]
) -> None:
    output(
        "from pipeline.runner import run\nfrom pipeline.store import LocalStore\n"
        "from tests.pipeline import toy\n"
        f"run({{'mesh': toy.mesh(toy.MeshConfig())}}, LocalStore({str(store.path)!r}))"
    )
    assert len(list(store.refs())) == 1
    assert list((store.path / "runs").iterdir()) == []


def test_what_something_tagged_was_computed_from_stays(store: LocalStore) -> None:
    label = RunLabel("one")
    surface = toy.mesh(toy.MeshConfig()).part("surface")
    outcome = run({"wave": toy.wave(toy.WaveConfig(frames=3), surface=surface)}, store, label=label)
    store.finish(label)
    assert len(free(store)) == 2
    store.upkeep.tag(outcome["wave"].manifest.ref, "paper")
    assert free(store) == set()
    (mesh,) = store.refs("mesh")
    (keeper,) = keepers(store, mesh, store.upkeep.rows(), 0.0)
    assert (keeper.tag, keeper.tagged) == ("paper", outcome["wave"].manifest.ref)


def test_lines_that_were_not_written_whole_are_not_read(store: LocalStore) -> None:
    label, ref = RunLabel("one"), example().ref
    store.begin(label)
    store.find(ref, label)
    (lines,) = store.path.rglob("*.refs")
    with open(lines, "ab") as file:
        file.write(b"geometry/abc")
    assert list(store.upkeep.used_by(label)) == [ref]
    with open(lines, "ab") as file:
        file.write(b"def\n\n/\nx\n")
    expected = [ref, Ref("geometry", "abcdef")]
    assert list(store.upkeep.used_by(label)) == expected
    assert list(LocalStore(store.path).upkeep.used_by(label)) == expected


def test_a_damaged_label_stops_a_collection_and_no_run(store: LocalStore) -> None:
    ref = publish(store, example()).ref
    label = RunLabel("one", named=True)
    store.begin(label)
    store.find(ref, label)
    (path,) = store.path.rglob("runs/*/*.json")
    for contents in (b"", b"{", b"[]", b'{"name": 3, "command": []}'):
        path.write_bytes(contents)
        with pytest.raises(StoreError, match="unreadable label of a run") as caught:
            plan(store, Limits(unreachable=True))
        assert str(path) in str(caught.value)
    store.finish(label)
    assert store.find(ref, label) is not None


def test_a_label_survives_its_way_through_a_file() -> None:
    label = RunLabel.of("Größe 3/4: [x]", "out", "planar-waves", "abc")
    assert from_json(to_json(label) | {"of a later version": 1}) == label


@pytest.mark.parametrize("name", ["", "  ", "a\nb"])
def test_a_name_that_cannot_be_told_is_bad_input(name: str) -> None:
    with pytest.raises(InputError, match="choose another with --name"):
        RunLabel.of(name, "out")


def test_names_that_look_alike_as_files_stay_apart() -> None:
    slugs = {RunLabel(name).slug for name in ("a b", "a-b", "a/b", "A-b", "ä", "ö", "x" * 300)}
    assert len(slugs) == 7
    assert all(len(slug.encode()) < 80 for slug in slugs)


def test_a_run_is_found_by_its_name_and_by_its_folder(tmp_path: Path) -> None:
    named = RegisteredRun(RunLabel.of("thesis", tmp_path / "out"), 1.0, alive=False)
    plain = [RegisteredRun(RunLabel.of(None, tmp_path / "x"), 1.0, alive=False) for _ in range(2)]
    known = [plain[1], named, plain[0]]
    assert runs_called(known, "thesis") == [named]
    assert runs_called(known, str(tmp_path / "out")) == [named]
    assert runs_called(known, str(tmp_path / "x")) == plain
    with pytest.raises(InputError, match="no run is called 'thesi'; did you mean 'thesis'"):
        runs_called(known, "thesi")


def test_an_artefact_that_vanishes_while_it_is_looked_for_is_absent(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    ref = publish(store, example()).ref

    def verify(asked: Ref, *, full: bool = False) -> tuple[str, ...]:
        shutil.rmtree(store.data(asked).parent)
        return ("its files are missing",)

    monkeypatch.setattr(store, "verify", verify)
    assert store.find(ref) is None


def test_the_newest_are_told_though_one_vanishes(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    ref = publish(store, example()).ref
    monkeypatch.setattr("pipeline.store.local._entries", lambda folder: ["0" * 40, ref.key])
    assert store.newest("geometry", 5) == [ref]


def test_descriptors_of_finished_runs_are_closed(store: LocalStore) -> None:
    before = len(os.listdir("/dev/fd"))
    for number in range(5):
        label = RunLabel(f"run {number}")
        store.begin(label)
        store.finish(label)
    assert len(os.listdir("/dev/fd")) == before


def test_a_run_that_could_not_be_begun_holds_no_file_open(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    rename, calls = os.rename, []

    def removed_once(source: Path, target: Path) -> None:
        calls.append(target)
        if len(calls) == 1:
            raise FileNotFoundError(target)  # another process removed the empty folder just now
        if len(calls) == 2:
            raise OSError(errno.ENOSPC, "no space left on device")
        rename(source, target)

    descriptors = Path("/proc/self/fd")
    if not descriptors.is_dir():
        pytest.skip("this system does not list open files")
    monkeypatch.setattr("pipeline.store.registers.os.rename", removed_once)
    registers = Registers(store.path / "runs")
    before = len(list(descriptors.iterdir()))
    with pytest.raises(OSError, match="no space"):
        registers.begin(RunLabel("one", named=True))
    assert len(list(descriptors.iterdir())) == before
    registers.begin(RunLabel("one", named=True))
    assert len(list(descriptors.iterdir())) == before + 1


def test_a_line_that_a_full_disk_cut_off_spoils_none_that_follows(store: LocalStore) -> None:
    """Such a disk takes a part of what is written, and tells of it when the rest is to follow."""
    label, refs = RunLabel.of("n", "results"), [publish(store, example(gain=g)).ref for g in (1, 2)]
    store.begin(label)
    write, taken = os.write, iter([7, None])

    def nearly_full(descriptor: int, contents: bytes) -> int:
        count = next(taken)
        if count is None:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(descriptor, contents[:count])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "write", nearly_full)
        with pytest.raises(StoreError, match="no space left"):
            store.find(refs[0], label)
    for ref in (refs[1], refs[0]):
        store.find(ref, label)
    assert set(refs) == {ref for ref in store.upkeep.used_by(label) if ref in refs}
    assert free(store) == set()


def test_a_label_that_does_not_fit_on_the_disk_leaves_nothing(store: LocalStore) -> None:
    publish(store, example())
    with pytest.MonkeyPatch.context() as patch:
        full = OSError(errno.ENOSPC, "No space left on device")
        patch.setattr("pipeline.store.registers._write_whole", Mock(side_effect=full))
        with pytest.raises(StoreError, match="no space left"):
            store.begin(RunLabel.of("n", "results"))
    assert not list((store.path / "runs").rglob("*.new"))
