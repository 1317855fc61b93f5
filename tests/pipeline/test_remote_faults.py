"""Stores on object storage when the network, the server or this machine's copies fail."""

from __future__ import annotations

import contextlib
import dataclasses
import http.server
import os
import pickle
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from pipeline.errors import InputError, StoreError
from pipeline.events import Event, StageStarted, StageWarned
from pipeline.keys import SCHEMA
from pipeline.manifest import hash_files
from pipeline.runner import run
from pipeline.store import LocalStore, RunLabel
from pipeline.store.cleaning import Limits
from pipeline.store.collection import collect, plan
from pipeline.store.opening import open_store, remote_store
from pipeline.store.remote import RemoteStore, fsspec_objects, index, read_cache
from pipeline.store.remote.folder_objects import FolderObjects
from pipeline.store.remote.objects import Entry
from pipeline.testing.stores import example, publish
from tests.pipeline import toy
from tests.pipeline.s3_server import Cable, S3Server, free_port

FILM = toy.mesh(toy.MeshConfig())
WAVE = toy.wave(toy.WaveConfig(), surface=FILM.part("surface"))


@pytest.fixture(autouse=True)
def _cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MYOFILM_CACHE", str(tmp_path / "caches"))


@pytest.fixture
def shared(tmp_path: Path) -> str:
    """URL of a folder."""
    return (tmp_path / "shared").as_uri()


@pytest.fixture
def store(shared: str, tmp_path: Path) -> RemoteStore:
    """An empty store in that folder."""
    return remote_store(shared, cache=tmp_path / "cache")


@pytest.fixture
def forgetful() -> Iterator[None]:
    """The driver keeps connections by URL: those of other environments must not be found."""
    import s3fs

    s3fs.S3FileSystem.clear_instance_cache()
    yield
    s3fs.S3FileSystem.clear_instance_cache()


@pytest.fixture
def cable(
    s3_server: S3Server, bucket: str, forgetful: None, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Cable]:
    """The way to the server, which gives up soon."""
    between = Cable(s3_server.port)
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{between.port}")
    monkeypatch.setattr(fsspec_objects, "PATIENCE", 0.3)
    yield between
    between.close()


@pytest.mark.parametrize("cut_at", ["data/wave", "objects/wave"])
def test_a_server_that_goes_away_while_publishing_leaves_nothing_half_published(
    cut_at: str, cable: Cable, bucket: str, tmp_path: Path
) -> None:
    store = remote_store(f"{bucket}/store", cache=tmp_path / "cache")
    run({"film": FILM}, store)
    cable.cut_at = f"PUT /{bucket.removeprefix('s3://')}/store/{cut_at}".encode()
    with pytest.raises(StoreError, match=r"(?s)cannot be reached.*s3://.*Remedy") as caught:
        run({"wave": WAVE}, store)
    assert caught.value.exit_code == 1
    cable.mend()
    other = remote_store(f"{bucket}/store", cache=tmp_path / "elsewhere", lease=1.0)
    assert [ref.stage for ref in other.refs()] == ["mesh"]
    outcome = run({"wave": WAVE}, store)["wave"]
    assert not outcome.hit
    assert other.verify(outcome.manifest.ref, full=True) == ()
    assert other.upkeep.leftovers() == []


def test_an_answer_that_is_lost_does_not_turn_success_into_failure(
    cable: Cable, bucket: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fsspec_objects, "PATIENCE", 30.0)
    store = remote_store(f"{bucket}/store", cache=tmp_path / "cache")
    publish(store, example(gain=2.0))
    cable.cut_at = f"PUT /{bucket.removeprefix('s3://')}/store/objects".encode()
    cable.delivered = True
    threading.Timer(0.7, cable.mend).start()  # the client tries again, and is told that it is there
    manifest = publish(store, example())
    assert store.find(manifest.ref) == manifest
    assert store.verify(manifest.ref, full=True) == ()


def test_an_endpoint_that_is_not_there_is_bad_input(
    forgetful: None, s3_server: S3Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in s3_server.environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{free_port()}")
    with pytest.raises(InputError, match=r"(?s)cannot be reached.*s3://films/store.*AWS_ENDPOINT"):
        remote_store("s3://films/store", cache=tmp_path)


class Refusing(http.server.BaseHTTPRequestHandler):
    """A server that knows nobody."""

    def do_GET(self) -> None:
        text = b"<Error><Code>InvalidAccessKeyId</Code><Message>no such key</Message></Error>"
        self.send_response(403)
        self.send_header("Content-Length", str(len(text)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(text)

    do_HEAD = do_PUT = do_GET  # noqa: N815 - the names that the server looks for

    def log_message(self, *arguments: Any) -> None:
        """Say nothing."""


@pytest.mark.parametrize("key", ["wrong", None])
def test_credentials_that_are_wrong_or_missing_are_bad_input(
    key: str | None, forgetful: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in os.environ if name.startswith("AWS_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    if key is not None:
        monkeypatch.setenv("AWS_ACCESS_KEY_ID", key)
        monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", key)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Refusing) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{server.server_port}")
        with pytest.raises(InputError, match=r"(?s)refuses the credentials.*AWS_ACCESS_KEY_ID"):
            remote_store("s3://films/store", cache=tmp_path)
        server.shutdown()


def test_a_bucket_that_is_not_there_is_bad_input(bucket: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no bucket .*-absent"):
        remote_store(f"{bucket}-absent/store", cache=tmp_path)


@pytest.mark.parametrize(
    ("location", "message"),
    [
        ("nonsense://place/store", "no driver for nonsense://"),
        ("s3://", "names no place"),
        ("gs://bucket/store", "pip install 'gcsfs'"),
    ],
)
def test_a_url_that_names_no_store_is_bad_input(location: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        open_store(location)


class Replacing(FolderObjects):
    """A server that does not know the condition, and replaces."""

    def create(self, path: str, contents: bytes) -> bool:
        self.write({path: contents})
        return True


def test_a_server_that_replaces_what_it_should_create_is_refused(tmp_path: Path) -> None:
    store = RemoteStore(Replacing(tmp_path / "shared"), tmp_path / "cache")
    with pytest.raises(InputError, match=r"replaces objects.*If-None-Match"):
        publish(store, example())
    assert list(store.refs()) == []


class ReadOnly(FolderObjects):
    """A place that one may only read."""

    def write(self, contents: Mapping[str, bytes]) -> None:
        raise StoreError("refused") from PermissionError("Forbidden")

    def create(self, path: str, contents: bytes) -> bool:
        raise StoreError("refused") from PermissionError("Forbidden")


def test_a_store_that_may_only_be_read_serves_its_hits(store: RemoteStore, tmp_path: Path) -> None:
    run({"film": FILM}, store)
    reader = RemoteStore(ReadOnly(tmp_path / "shared"), tmp_path / "elsewhere")
    outcome = run({"film": FILM}, reader)["film"]
    assert outcome.hit
    assert outcome.load("label").text == "flat"
    with pytest.raises(InputError, match="refused"):
        run({"film": toy.mesh(toy.MeshConfig(height=2.0))}, reader)


def test_a_store_of_a_newer_version_is_bad_input(store: RemoteStore, shared: str) -> None:
    publish(store, example())
    store.objects.write({"store.json": f'{{"version": {SCHEMA + 1}}}'.encode()})
    with pytest.raises(InputError, match=f"layout version {SCHEMA + 1}"):
        remote_store(shared)
    store.objects.write({"store.json": b"{"})
    with pytest.raises(InputError, match=r"unreadable description.*store\.json"):
        remote_store(shared)


def test_an_edited_marker_is_never_used(store: RemoteStore) -> None:
    ref = publish(store, example()).ref
    path = f"objects/{ref.stage}/{ref.key}"
    whole = store.objects.read(path)
    assert whole is not None
    head, _, text = whole.partition(b"\n")
    edited = text.replace(b'"seconds": 1.5', b'"seconds": 2.5')
    for contents in (b"", b"{}", head, text, head + b"\n{}", head + b"\n" + edited):
        store.objects.write({path: contents})
        with pytest.raises(StoreError, match="unreadable manifest"):
            store.find(ref)
        assert len(store.verify(ref)) == 1


def test_the_data_of_an_artefact_come_over_the_network_once(
    store: RemoteStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ref = publish(store, example()).ref
    objects = FolderObjects(tmp_path / "shared")
    fetched: list[str] = []
    real = objects.download

    def download(self: Any, files: Mapping[str, Path]) -> None:
        fetched.extend(files)
        real(files)

    monkeypatch.setattr(FolderObjects, "download", download)
    for _ in range(2):  # as another process would
        other = RemoteStore(objects, tmp_path / "elsewhere")
        for _ in range(2):
            assert (other.data(ref) / "record.h5").read_bytes() == b"contents"
    assert len(fetched) == 1
    store.data(ref)
    assert len(fetched) == 1  # who published it has it


def test_a_damaged_copy_is_fetched_again(store: RemoteStore, tmp_path: Path) -> None:
    ref = publish(store, example()).ref
    for contents in (b"cont", b"cOntents"):
        path = remote_store(store.location, cache=tmp_path / "elsewhere").data(ref) / "record.h5"
        path.write_bytes(contents)
        other = remote_store(store.location, cache=tmp_path / "elsewhere")
        assert (other.data(ref) / "record.h5").read_bytes() == b"contents"


def test_damaged_data_are_never_copied(store: RemoteStore, tmp_path: Path) -> None:
    ref = publish(store, example()).ref
    (path,) = store.objects.listing("data")
    store.objects.write({path: b"cOntents"})
    other = remote_store(store.location, cache=tmp_path / "elsewhere")
    with pytest.raises(StoreError, match=r"the checksum of record\.h5 is wrong"):
        other.data(ref)
    assert not list((tmp_path / "elsewhere").rglob("record.h5"))


def test_copies_that_nobody_reads_make_room(
    store: RemoteStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MYOFILM_CACHE_SIZE", "2e-8 GB")  # two of them, and a half
    monkeypatch.setattr(read_cache, "HELD", 2)
    refs = [publish(store, example(gain=float(gain))).ref for gain in range(4)]
    here = remote_store(store.location, cache=tmp_path / "elsewhere")
    there = remote_store(store.location, cache=tmp_path / "elsewhere")
    first = there.data(refs[0])
    folders = [here.data(ref) for ref in refs]
    assert [folder.is_dir() for folder in folders] == [True, False, True, True]  # one is read there
    assert first.is_dir()
    assert (here.data(refs[1]) / "record.h5").read_bytes() == b"contents"


def test_a_cache_of_no_size_is_bad_input(shared: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MYOFILM_CACHE_SIZE", "plenty")
    with pytest.raises(InputError, match=r"MYOFILM_CACHE_SIZE is 'plenty'"):
        remote_store(shared)


@dataclasses.dataclass(frozen=True)
class Counting(FolderObjects):
    """Notes how often the place is asked."""

    asked: list[str] = dataclasses.field(default_factory=list)

    def read(self, path: str) -> bytes | None:
        self.asked.append("read")
        return super().read(path)

    def read_many(self, paths: Iterable[str]) -> dict[str, bytes]:
        self.asked.append("many")
        return {p: found for p in paths if (found := FolderObjects.read(self, p)) is not None}

    def write(self, contents: Mapping[str, bytes]) -> None:
        self.asked.append(f"write {len(contents)}")
        super().write(contents)

    def listing(self, folder: str) -> dict[str, Entry]:
        self.asked.append("listing")
        return super().listing(folder)


def test_listing_many_artefacts_asks_the_server_few_times(
    store: RemoteStore, tmp_path: Path
) -> None:
    manifests = [publish(store, example(gain=float(gain))) for gain in range(20)]
    objects = Counting(tmp_path / "shared")
    other = RemoteStore(objects, tmp_path / "elsewhere")
    objects.asked.clear()
    refs = list(other.refs())
    assert {other.manifest(ref).key for ref in refs} == {m.key for m in manifests}
    assert objects.asked == ["listing", "many"]
    assert len(other.upkeep.rows()) == 20
    objects.asked.clear()
    again = RemoteStore(objects, tmp_path / "elsewhere")
    assert len(again.upkeep.rows()) == 20
    assert objects.asked == ["read", "listing"]  # its version, and what there is


def test_a_new_machine_lists_without_reading_each_manifest(
    store: RemoteStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(index, "WORTH_SHARING", 3)
    refs = [publish(store, example(gain=float(gain))).ref for gain in range(4)]
    rows = RemoteStore(FolderObjects(tmp_path / "shared"), tmp_path / "one").upkeep.rows()
    objects = Counting(tmp_path / "shared")
    new = RemoteStore(objects, tmp_path / "other").upkeep
    objects.asked.clear()
    assert new.rows() == rows
    assert objects.asked == ["listing", "read"]
    store.upkeep.remove(refs[:1], tuple)
    publish(store, example(), b"other contents")
    assert {row.ref: row.size for row in new.rows()}[refs[1]] == 8
    assert [row.ref for row in new.rows()] == list(store.refs())
    (tmp_path / "shared" / "index.jsonl").write_bytes(b"[[[")
    damaged = RemoteStore(FolderObjects(tmp_path / "shared"), tmp_path / "third").upkeep
    assert damaged.rows() == new.rows()


def test_a_hit_waits_for_the_server_twice_and_uses_are_noted_together(
    store: RemoteStore, tmp_path: Path
) -> None:
    refs = [publish(store, example(gain=float(gain))).ref for gain in range(3)]
    objects = Counting(tmp_path / "shared")
    again = RemoteStore(objects, tmp_path / "cache")  # where copies tell what to list
    label = RunLabel("one")
    again.begin(label)
    objects.asked.clear()
    for ref in refs:
        assert again.find(ref, label) is not None
    assert sorted(objects.asked) == sorted(3 * ["write 1", "read", "listing"])
    objects.asked.clear()
    again.finish(label)
    assert objects.asked[0] == "write 3"
    assert set(again.upkeep.last_uses()) == set(refs)
    assert RemoteStore(objects, tmp_path / "elsewhere").find(refs[0]) is not None


def test_jobs_of_a_process_share_one_store_and_read_manifests_anew(
    store: RemoteStore, tmp_path: Path
) -> None:
    ref = publish(store, example()).ref
    here = pickle.loads(pickle.dumps(store))
    assert here is not store
    first = here.manifest(ref)
    store.upkeep.remove([ref], tuple)
    second = publish(store, example())
    assert here.manifest(ref).finished == first.finished  # of the same job
    assert pickle.loads(pickle.dumps(store)) is here
    assert here.manifest(ref).finished == second.finished


def test_small_objects_are_read_by_one_request_each(
    s3_server: S3Server, bucket: str, forgetful: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    import s3fs

    asked: list[str] = []
    real = s3fs.S3FileSystem._call_s3

    async def call(self: Any, method: str, *arguments: Any, **named: Any) -> Any:
        asked.append(method)
        return await real(self, method, *arguments, **named)

    objects = fsspec_objects.FsspecObjects(f"{bucket}/small")
    paths = [f"one/{number}" for number in range(5)]
    objects.write(dict.fromkeys(paths, b"contents"))
    monkeypatch.setattr(s3fs.S3FileSystem, "_call_s3", call)
    assert objects.read(paths[0]) == b"contents"
    assert objects.read_many([*paths, "one/none"]).keys() == set(paths)
    assert asked == 7 * ["get_object"]


# A run on a machine that is lost.
LOST = """
from pathlib import Path
from pipeline.events import StageProgress
from pipeline.runner import run
from pipeline.store.opening import remote_store
from tests.pipeline.test_remote_faults import wave
def listen(event):
    if isinstance(event, StageProgress):
        print(event.done)
store = remote_store({url!r}, cache=Path({cache!r}), lease=0.5, mirror={mirror})
run({{"wave": wave(0.01)}}, store, listen=listen, checkpoint_interval=0.05)
"""


def wave(pause: float) -> Any:
    """A run that can be interrupted."""
    return toy.wave(toy.WaveConfig(pause=pause), surface=FILM.part("surface"))


def lose_at(
    frame: int, start: Callable[..., Any], url: str, cache: Path, mirror: float = 0.0
) -> None:
    process = start(LOST.format(url=url, cache=str(cache), mirror=mirror))
    while (line := process.stdout.readline().strip()) != "":
        if int(line) >= frame:
            break
    process.send_signal(signal.SIGKILL)
    process.wait(timeout=30)


def test_what_a_lost_machine_had_copied_is_gone_on_with_elsewhere(
    shared: str, tmp_path: Path, start: Callable[..., Any]
) -> None:
    unbroken = LocalStore(tmp_path / "unbroken")
    ref = run({"wave": WAVE}, unbroken)["wave"].manifest.ref
    lose_at(100, start, shared, tmp_path / "lost")
    store = remote_store(shared, cache=tmp_path / "cache")
    assert store.checkpoint(ref) is not None
    events: list[Event] = []
    assert run({"wave": WAVE}, store, listen=events.append)["wave"].manifest.ref == ref
    (started,) = [e for e in events if isinstance(e, StageStarted) and e.stage == "wave"]
    assert started.resumed_frames
    assert hash_files(store.data(ref)) == hash_files(unbroken.data(ref))
    assert store.objects.listing("checkpoints") == {}
    assert store.upkeep.leftovers() == []


def test_a_copy_that_cannot_be_made_does_not_stop_the_work(
    store: RemoteStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(self: Any, contents: Mapping[str, bytes]) -> None:
        if any(path.startswith("checkpoints/") for path in contents):
            raise StoreError("the network is down")
        write(self, contents)

    write = FolderObjects.write
    monkeypatch.setattr(FolderObjects, "write", fail)
    events: list[Event] = []
    eager = remote_store(store.location, cache=store.folders.path, mirror=0.0)
    run({"wave": wave(0.001)}, eager, listen=events.append, checkpoint_interval=0.02)
    told = {e.message for e in events if isinstance(e, StageWarned)}
    assert told == {"the checkpoint is kept on this machine only: the network is down"}


def test_what_a_killed_removal_took_away_is_put_back_by_the_next_who_asks(
    store: RemoteStore, tmp_path: Path
) -> None:
    manifest = publish(store, example())
    dying = remote_store(store.location, cache=tmp_path / "elsewhere", lease=0.2)
    dying._heart.add = lambda *arguments: None  # type: ignore[method-assign]
    with contextlib.ExitStack() as stack:
        dying.upkeep._take(manifest.ref, stack)
        dying.upkeep._hide(manifest.ref)
        stack.pop_all()  # killed: nothing is let go
    assert store.find(manifest.ref) is None
    label = RunLabel("one")
    store.begin(label)
    assert store.find(manifest.ref, label) == manifest
    assert store.verify(manifest.ref, full=True) == ()
    assert store.objects.listing("removed") == {}


def test_a_damaged_label_stops_a_collection_and_no_run(store: RemoteStore, tmp_path: Path) -> None:
    """Nobody knows what that run keeps: what it asked for must not go."""
    manifest = publish(store, example())
    kept, other = RunLabel("kept", named=True), RunLabel("other")
    for label in (kept, other):
        store.begin(label)
        assert store.find(manifest.ref, label) == manifest
    (path,) = (tmp_path / "shared" / "runs" / kept.slug).rglob("label")
    path.write_bytes(b"{")
    with pytest.raises(StoreError, match="unreadable label of a run") as caught:
        plan(store, Limits(unreachable=True))
    assert f"{kept.slug}/{kept.generation}/label" in str(caught.value)
    for label in (other, RunLabel("kept", named=True)):
        store.begin(label)
        store.finish(label)
    assert path.exists()
    assert store.find(manifest.ref, other) == manifest


def test_what_was_set_aside_as_damaged_goes_when_it_is_old(
    store: RemoteStore, tmp_path: Path
) -> None:
    ref = publish(store, example()).ref
    aside = tmp_path / "shared" / "quarantine"
    (path,) = (p for p in (tmp_path / "shared" / "data").rglob("*") if p.is_file())
    path.write_bytes(b"other")
    assert store.quarantine(ref) is not None
    (left,) = store.upkeep.leftovers()
    assert left.damaged
    assert left.key == ref.key
    assert left.size == sum(p.stat().st_size for p in aside.rglob("*") if p.is_file())
    assert plan(store, Limits()).leftovers == []
    old = plan(store, Limits(), now=left.changed + 31 * 86400)
    assert [each for each, _ in old.leftovers] == [left]
    publish(store, example())  # computed again meanwhile
    assert collect(store, old) == ([], [left])
    assert not [p for p in aside.rglob("*") if p.is_file()]
    assert store.verify(ref, full=True) == ()
