"""A disk that fails half-way: a clear error, nothing temporary left, finished artefacts intact."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from pipeline.errors import StoreError
from pipeline.manifest import hash_files
from pipeline.nodes import Node
from pipeline.runner import run
from pipeline.store import LocalStore
from tests.pipeline import toy

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def trials(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    """What came of failures at some operations of a run, of all kinds."""
    return failures(tmp_path_factory.mktemp("disks"), every=7)


def failures(folder: Path, every: int) -> list[dict[str, Any]]:
    """The trials of the study, one operation out of so many."""
    command = [sys.executable, "-m", "tests.faults.disks", str(folder), str(every)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


WORDS = {
    "ENOSPC": "no space left on the disk of the store",
    "EDQUOT": "no space left on the disk of the store",
    "EACCES": "no permission to use the store",
    "EROFS": "the store is on a read-only file system",
    "EIO": "the store cannot be used (Input/output error)",
}


def test_a_failing_operation_is_told_in_plain_words(trials: list[dict[str, Any]]) -> None:
    assert len(trials) > 15
    assert_told(trials)


def test_a_failing_operation_leaves_finished_artefacts_and_nothing_else(
    trials: list[dict[str, Any]],
) -> None:
    assert_nothing_left(trials)


def test_a_run_completes_once_the_disk_is_in_order_again(trials: list[dict[str, Any]]) -> None:
    for trial in trials:
        assert trial["completed"], trial


@pytest.mark.slow
def test_every_single_operation_of_a_run_may_fail(tmp_path: Path) -> None:
    trials = failures(tmp_path, every=1)
    assert_told(trials)
    assert_nothing_left(trials)
    assert all(trial["completed"] for trial in trials)


def assert_told(trials: list[dict[str, Any]]) -> None:
    """Each error is one of ours, with the cause and what to do."""
    for trial in trials:
        if trial["error"]:  # some operations a run can do without
            told = trial["error"].splitlines()
            last = [line for line in told if line.startswith("pipeline.errors.")][-1]
            assert WORDS[trial["code"]] in last, trial
            assert "Remedy: " in told[-1], trial
    assert sum(bool(trial["error"]) for trial in trials) > 0.8 * len(trials)


def assert_nothing_left(trials: list[dict[str, Any]]) -> None:
    """Finished artefacts are whole, and temporary data are gone."""
    for trial in trials:
        assert not trial["killed"], trial
        assert trial["kept_are_whole"], trial
        assert trial["left"] == [], trial


def plan() -> dict[str, Node[Any]]:
    """A history of some hundred kilobytes that do not compress."""
    film = toy.mesh(toy.MeshConfig())
    history = toy.wave(toy.WaveConfig(frames=3000), surface=film.part("surface"))
    return {"mesh": film, "wave": history, "peak": toy.peak(toy.MeshConfig(), history=history)}


@contextlib.contextmanager
def small_disk(folder: Path, kilobytes: int) -> Iterator[Callable[[int], None]]:
    """A file system in memory of a given size, and how to give it another one."""
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)]
    try:
        subprocess.run(mount, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("only root may mount a file system of limited size")
    try:
        yield (
            lambda size: (
                subprocess.run(["mount", "-o", f"remount,size={size}k", str(folder)], check=True)
                and None
            )
        )
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


@pytest.mark.parametrize("kilobytes", [40, 130])
def test_a_disk_that_is_really_full_is_told_and_keeps_what_was_finished(
    kilobytes: int, tmp_path: Path
) -> None:
    unbroken = LocalStore(tmp_path / "unbroken")
    run(plan(), unbroken)
    with small_disk(tmp_path / "disk", kilobytes) as resize:
        store = LocalStore(tmp_path / "disk" / "store")
        with pytest.raises(StoreError, match=r"no space left .*MB free") as caught:
            run(plan(), store, checkpoint_interval=1e9)
        assert "Remedy: free some space, or choose another disk with --store" in str(caught.value)
        assert not any((store.path / "tmp").glob("*"))
        for ref in store.refs():
            assert store.verify(ref, full=True) == ()
        resize(4000)
        run(plan(), store)
        for ref in unbroken.refs():
            assert hash_files(store.data(ref)) == hash_files(unbroken.data(ref))


# As a user of its own where the tests run as root, whom no permission keeps out.
FORBIDDEN = """
import os, sys
from pathlib import Path
from pipeline.errors import StoreError
from pipeline.events import StageStarted
from pipeline.runner import run
from pipeline.store import LocalStore
from tests.faults.test_disks import plan
import pipeline.computing.execution, zarr, h5py
store = LocalStore({store!r})
nodes = plan()
run({{"mesh": nodes["mesh"]}}, store)
if os.geteuid() == 0:
    for parent, folders, files in os.walk(store.path):
        for name in ("", *folders, *files):
            os.chown(Path(parent, name), 65534, 65534)
    os.seteuid(65534)
def listen(event):
    if isinstance(event, StageStarted):
        (store.path / {folder!r}).chmod(0o500)
try:
    run(nodes, store, listen=listen, checkpoint_interval=3600.0)
except StoreError as error:
    print(error)
"""


@pytest.mark.parametrize("folder", ["objects", "tmp", "checkpoints"])
def test_a_folder_that_loses_its_permission_half_way_is_told(
    folder: str, tmp_path: Path, output: Callable[..., str]
) -> None:
    tmp_path.chmod(0o755)
    (tmp_path / "store").mkdir(mode=0o755)
    for parent in tmp_path.parents:
        if parent.name.startswith(("pytest-", "popen-")):  # pytest's own folders are its user's
            parent.chmod(0o755)
    told = output(FORBIDDEN.format(store=str(tmp_path / "store"), folder=folder))
    if folder == "checkpoints":
        assert told == ""  # none was due
        return
    assert told.startswith(f"no permission to use the store: {tmp_path / 'store' / folder}")
    assert "Remedy: change the permissions, or choose another folder with --store" in told
    store = LocalStore(tmp_path / "store")
    (store.path / folder).chmod(0o755)
    assert [ref.stage for ref in store.refs()] == ["mesh"]
    # The work's own folder cannot go from one in which nothing may be changed.
    assert [path for path in (store.path / "tmp").rglob("*") if not path.is_dir()] == []
    assert not run(plan(), store)["wave"].hit
    assert not any((store.path / "tmp").glob("*"))
