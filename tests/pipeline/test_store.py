"""The local store: whole artefacts or none, one writer at a time, plain words for disk trouble."""

from __future__ import annotations

import dataclasses
import errno
import fcntl
import json
import os
import platform
import shutil
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from pipeline import durable
from pipeline.errors import InputError, StoreError
from pipeline.keys import SCHEMA
from pipeline.runner import run
from pipeline.store import LocalStore
from pipeline.testing.stores import StoreConformance, example, forge, publish
from tests.pipeline import toy


class TestLocalStore(StoreConformance):
    @pytest.fixture
    def store(self, tmp_path: Path) -> LocalStore:
        return LocalStore(tmp_path / "store")


class TestLocalStoreWithoutFileLocks(StoreConformance):
    """On a file system without locks double work is harmless; nobody waits."""

    @pytest.fixture
    def store(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> LocalStore:
        def flock(descriptor: int, operation: int) -> None:
            raise OSError(errno.ENOLCK, "No locks available")

        monkeypatch.setattr(fcntl, "flock", flock)
        return LocalStore(tmp_path / "store")

    test_a_second_writer_waits_and_learns_for_whom: Any = None


def test_asking_an_absent_store_creates_nothing(tmp_path: Path) -> None:
    store = LocalStore(tmp_path / "store")
    assert store.find(example().ref) is None
    assert list(tmp_path.iterdir()) == []


def test_the_layout_is_the_documented_one(store: LocalStore) -> None:
    ref = publish(store, example()).ref
    files = {p.relative_to(store.path).as_posix() for p in store.path.rglob("*") if p.is_file()}
    assert files == {
        "store.json",
        "index.jsonl",
        f"locks/{ref.key}",
        f"objects/geometry/{ref.key}/manifest.json",
        f"objects/geometry/{ref.key}/data/record.h5",
    }


def test_a_store_path_that_is_a_file_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(InputError, match="file is a file") as caught:
            LocalStore(path)
        assert caught.value.exit_code == 2


UNUSABLE = [
    (errno.EACCES, "^no permission to use the store: "),
    (errno.EROFS, "^the store is on a read-only file system: "),
    (errno.ENOENT, r"^the store cannot be used \(No such file or directory\): "),
]


@pytest.mark.parametrize("function", ["mkdir", "open"])  # a folder of the store, its lock file
@pytest.mark.parametrize(("code", "message"), UNUSABLE)
def test_a_store_that_cannot_be_written_to_is_bad_input_until_it_once_was(
    code: int, message: str, function: str, store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*arguments: Any, **named: Any) -> Any:
        raise OSError(code, os.strerror(code), str(arguments[0]))

    run({"mesh": toy.mesh(toy.MeshConfig())}, store)
    monkeypatch.setattr(os, function, refuse)
    if function == "mkdir":
        shutil.rmtree(store.path / "locks")
    others = {"mesh": toy.mesh(toy.MeshConfig(height=2.0))}
    with pytest.raises(InputError, match=message) as caught:
        run(others, LocalStore(store.path))
    assert "--store" in str(caught.value)
    assert "free" not in str(caught.value)
    with pytest.raises(StoreError, match=message):
        run(others, store)


def test_a_store_that_may_not_be_read_is_bad_input(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(path: Path, **named: Any) -> Any:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(Path, "stat", refuse)
    with pytest.raises(InputError, match="no permission to use the store"):
        LocalStore(store.path)


def test_a_disk_that_is_full_from_the_beginning_is_no_bad_input(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*arguments: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "mkdir", full)
    with pytest.raises(StoreError, match="no space left"):
        run({"mesh": toy.mesh(toy.MeshConfig())}, store)


def test_a_store_of_a_newer_version_is_bad_input(store: LocalStore) -> None:
    publish(store, example())
    (store.path / "store.json").write_text(json.dumps({"version": SCHEMA + 1}))
    with pytest.raises(InputError, match=f"layout version {SCHEMA + 1}"):
        LocalStore(store.path)


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "{}", '{"version": "1"}', '{"version": null}', '{"version": 0}']
)
def test_a_store_with_an_unreadable_description_is_refused(text: str, store: LocalStore) -> None:
    publish(store, example())
    (store.path / "store.json").write_text(text)
    with pytest.raises(InputError, match=r"store\.json gives no version.*\nRemedy: "):
        LocalStore(store.path)


def test_an_unreadable_manifest_is_never_used(store: LocalStore) -> None:
    ref = publish(store, example()).ref
    path = store.data(ref).parent / "manifest.json"
    for contents in (b"{", b"[]", b'{"stage": "geometry"}'):
        path.write_bytes(contents)
        with pytest.raises(StoreError, match="unreadable manifest"):
            store.find(ref)


def test_a_manifest_is_read_again_only_after_it_changed(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    ref = publish(store, example()).ref
    path = store.data(ref).parent / "manifest.json"
    os.utime(path, ns=(0, 10**18))  # published long ago
    first = store.manifest(ref)
    with monkeypatch.context() as patch:
        patch.setattr(Path, "read_bytes", None)
        assert store.manifest(ref) is first
    forge(store, ref, seconds=2.5)
    assert store.manifest(ref).seconds == 2.5


@pytest.mark.parametrize(
    ("was", "now"),
    [
        ('"seconds": 1.5', '"seconds": 0.5'),  # what it cost
        ('"gain": 1.0', '"gain": 2.0'),  # what was asked
        ('"size": 8', '"size":  8'),  # nothing at all
        ('"seal": "', '"seal": "f'),
    ],
)
def test_an_edited_manifest_is_never_used(was: str, now: str, store: LocalStore) -> None:
    ref = publish(store, example()).ref
    path = store.data(ref).parent / "manifest.json"
    text = path.read_text()
    assert was in text
    path.write_text(text.replace(was, now))
    with pytest.raises(StoreError, match="edited after it had been written"):
        store.find(ref)


def test_a_manifest_without_a_seal_is_read(store: LocalStore) -> None:
    # Those of version 0.1.0 have none.
    manifest = publish(store, example())
    path = store.data(manifest.ref).parent / "manifest.json"
    path.write_text(json.dumps(dataclasses.asdict(manifest)))
    assert store.find(manifest.ref) == manifest


def test_a_manifest_of_a_newer_version_is_told_to_be_one(store: LocalStore) -> None:
    ref = publish(store, example()).ref
    forge(store, ref, schema=SCHEMA + 1)
    with pytest.raises(StoreError, match=rf"its schema is {SCHEMA + 1}, known are those up to"):
        store.find(ref)


def test_full_verification_finds_a_forged_statement(store: LocalStore) -> None:
    ref = publish(store, example()).ref
    forge(store, ref, config={"gain": 2.0})
    assert store.verify(ref, full=True) == ("its key is not that of its statement",)


def test_full_verification_finds_an_edited_content_id(store: LocalStore) -> None:
    # It would enter the keys of all that is computed from this artefact.
    manifest = publish(store, example())
    forge(store, manifest.ref, content=manifest.content[::-1])
    assert store.verify(manifest.ref, full=True) == ("its content ids are not those of its files",)


def test_what_is_set_aside_is_kept_whole_with_a_report(store: LocalStore) -> None:
    ref = publish(store, example()).ref
    (store.data(ref) / "record.h5").write_bytes(b"cont")
    aside = store.quarantine(ref, ["seen by a reader"])
    assert aside is not None
    assert aside.parent == store.path / "quarantine" / "geometry"
    assert (aside / "data" / "record.h5").read_bytes() == b"cont"
    report = json.loads(aside.with_name(f"{aside.name}.json").read_text())
    assert report["artefact"] == str(ref)
    assert report["problems"] == ["seen by a reader", "record.h5 has 4 bytes instead of 8"]


@pytest.mark.parametrize("debris", ["file", "empty folder"])
def test_what_lies_in_the_place_of_an_artefact_is_told_before_anything_is_computed(
    debris: str, store: LocalStore
) -> None:
    # Otherwise the rename at the end of a long computation would fail on it.
    ref = example().ref
    place = store.data(ref).parent
    place.parent.mkdir(parents=True)
    place.mkdir() if debris == "empty folder" else place.write_bytes(b"")
    with pytest.raises(StoreError, match="is damaged"):
        store.find(ref)
    assert store.quarantine(ref) is not None
    assert publish(store, example()) == store.find(ref)


@pytest.mark.parametrize(
    ("code", "message"),
    [(errno.ENOSPC, "no space left"), (errno.EACCES, "no permission"), (errno.EIO, "cannot be")],
)
def test_disk_trouble_while_publishing_is_told_and_leaves_nothing(
    code: int, message: str, store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fsync(descriptor: int) -> None:
        raise OSError(code, os.strerror(code))

    run({"mesh": toy.mesh(toy.MeshConfig())}, store)
    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(StoreError, match=message) as caught:
        run({"mesh": toy.mesh(toy.MeshConfig(height=2.0))}, store)
    assert str(store.path) in str(caught.value)
    assert list((store.path / "tmp").iterdir()) == []
    assert len(list(store.refs())) == 1


@pytest.mark.parametrize("target", ["pipeline.codecs.hdf5_codec.save", "zarr.Array.__setitem__"])
def test_a_full_disk_while_writing_data_is_told_and_leaves_nothing(
    target: str, store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*arguments: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    run({"mesh": toy.mesh(toy.MeshConfig())}, store)
    monkeypatch.setattr(target, full)
    surface = toy.mesh(toy.MeshConfig(height=1.0 if "zarr" in target else 2.0)).part("surface")
    with pytest.raises(StoreError, match=r"(?s)no space left.*MB free.*Remedy: free some space"):
        run({"wave": toy.wave(toy.WaveConfig(), surface=surface)}, store, checkpoint_interval=1e9)
    assert list((store.path / "tmp").iterdir()) == []


# A limit on the size of files fails where a full disk does: in the middle of the written bytes.
LIMITED = """
import resource
from pipeline.errors import StoreError
from pipeline.runner import run
from pipeline.store import LocalStore
from tests.pipeline import toy
store = LocalStore({store!r})
resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, resource.RLIM_INFINITY))
try:
    run({{"mesh": toy.mesh(toy.MeshConfig(label="x" * 30_000))}}, store)
except StoreError as error:
    print(error)
"""


def test_a_write_that_fails_inside_an_hdf5_part_is_told_in_the_words_of_the_system(
    store: LocalStore, output: Callable[..., str]
) -> None:
    told = output(LIMITED.format(store=str(store.path)))
    assert told.startswith("the store cannot be used (File too large): ")
    assert told.count("\n") == 2  # and a remedy
    assert list((store.path / "tmp").iterdir()) == []


def test_atomic_writing_replaces_all_or_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file"
    durable.write_atomically(path, b"old")

    def fsync(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "full")

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(OSError, match="full"):
        durable.write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_threads_that_replace_the_same_file_do_not_disturb_each_other(tmp_path: Path) -> None:
    path = tmp_path / "file"
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda i: durable.write_atomically(path, b"%04d" % i * 1000), range(40)))
    assert path.read_bytes() in {b"%04d" % i * 1000 for i in range(40)}
    assert list(tmp_path.iterdir()) == [path]


def test_everything_is_on_the_disk_before_the_artefact_appears(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: list[Path] = []
    real_sync, real_rename = durable.sync, os.rename

    def sync(path: Path) -> None:
        synced.append(path)
        real_sync(path)

    def rename(source: Path, target: Path) -> None:
        assert {source, *source.rglob("*")} <= set(synced)
        synced.clear()
        real_rename(source, target)

    monkeypatch.setattr("pipeline.durable.sync", sync)
    monkeypatch.setattr("pipeline.store.workspace.sync", sync)
    monkeypatch.setattr(os, "rename", rename)
    ref = publish(store, example()).ref
    assert store.data(ref).parent.parent in synced  # so that the rename itself is kept


def test_a_store_that_may_only_be_read_serves_its_hits(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = toy.mesh(toy.MeshConfig())
    run({"mesh": node}, store)

    def refuse(*arguments: Any, **named: Any) -> Any:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(os, "mkdir", refuse)
    monkeypatch.setattr(os, "replace", refuse)
    assert run({"mesh": node}, LocalStore(store.path))["mesh"].hit


def test_a_lock_is_held_by_one_process_and_names_it(
    store: LocalStore, start: Callable[..., Any]
) -> None:
    publish(store, example())
    code = (
        "import sys, time\nfrom pathlib import Path\nfrom pipeline.store.locks import locked\n"
        f"with locked(Path({str(store.path / 'locks' / 'k')!r}), 'mesh', print):\n"
        "    print('held'); time.sleep(60)"
    )
    holder = start(code)
    assert holder.stdout.readline() == "held\n"
    waiter = start(code)
    waits_for = f"process {holder.pid} on {platform.node()} (stage mesh)\n"
    assert waiter.stdout.readline() == waits_for
    holder.kill()
    assert waiter.stdout.readline() == "held\n"
