"""What every store must do, as tests: a store implementation inherits :class:`StoreConformance`."""

from __future__ import annotations

import dataclasses
import pickle
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from pipeline.errors import StoreError
from pipeline.events import Holder
from pipeline.fingerprint import Fingerprint
from pipeline.keys import Ref, Statement
from pipeline.manifest import Manifest, content_ids, hash_files, whole_content
from pipeline.store import RunLabel, Store, Workspace


def example(stage: str = "geometry", gain: float = 1.0) -> Statement:
    """Statement of a made-up artefact."""
    return Statement(stage, {"gain": gain}, Fingerprint("0" * 40, {}), {})


def manifest_of(statement: Statement, data: Path) -> Manifest:
    """Manifest of the files in a data folder."""
    files = hash_files(data)
    parts = content_ids(files)
    return Manifest(
        stage=statement.stage,
        key=statement.key,
        config=statement.config,
        code=statement.code.digest,
        modules=statement.code.modules,
        inputs={},
        files=files,
        parts=parts,
        content=whole_content(parts),
        seconds=1.5,
        cpu_seconds=1.0,
        peak_memory=0,
        started="2024-01-01T00:00:00+00:00",
        finished="2024-01-01T00:00:01+00:00",
        environment={},
    )


def publish(store: Store, statement: Statement, contents: bytes = b"contents") -> Manifest:
    """Publish an artefact of one file; gives the manifest of what is there then."""
    with store.writing(statement.ref, lambda holder: None) as work:
        work.begin(resume=False)
        return work.publish(_written(work, statement, contents))


def forge(store: Store, ref: Ref, **changes: Any) -> None:
    """Replace the manifest of a kept artefact by one with other fields, sealed as a true one is."""
    path = store.data(ref).parent / "manifest.json"
    manifest = dataclasses.replace(store.manifest(ref), **changes)
    path.write_bytes(manifest.to_json())


def _written(work: Workspace, statement: Statement, contents: bytes) -> Manifest:
    (work.data / "record.h5").write_bytes(contents)
    return manifest_of(statement, work.data)


class StoreConformance:
    """Inherit, give a fixture ``store``, and every store behaviour is tested."""

    @pytest.fixture
    def store(self, tmp_path: Path) -> Iterator[Store]:
        """An empty store."""
        raise TypeError("a test class for a store defines the fixture 'store'")

    def spoil(self, store: Store, ref: Ref, name: str, contents: bytes | None) -> None:
        """Give a data file of an artefact other contents, or none, where the store keeps it.

        A store whose ``data`` gives a copy overrides this.
        """
        path = store.data(ref) / name
        if contents is None:
            path.unlink()
        else:
            path.write_bytes(contents)

    def test_an_empty_store_holds_nothing(self, store: Store) -> None:
        assert store.find(example().ref) is None
        assert list(store.refs()) == []

    def test_the_manifest_of_an_absent_artefact_cannot_be_read(self, store: Store) -> None:
        with pytest.raises(StoreError):
            store.manifest(example().ref)

    def test_a_published_artefact_is_found_as_it_was_written(self, store: Store) -> None:
        manifest = publish(store, example())
        assert store.find(manifest.ref) == manifest
        assert (store.data(manifest.ref) / "record.h5").read_bytes() == b"contents"

    def test_nothing_is_seen_before_it_is_published(self, store: Store) -> None:
        with store.writing(example().ref, lambda holder: None) as work:
            work.begin(resume=False)
            manifest = _written(work, example(), b"contents")
            assert store.find(example().ref) is None
            assert list(store.refs()) == []
            work.publish(manifest)
            assert store.find(example().ref) is not None

    def test_abandoned_work_is_never_seen(self, store: Store) -> None:
        with store.writing(example().ref, lambda holder: None) as work:
            work.begin(resume=False)
            (work.data / "record.h5").write_bytes(b"half")
        assert store.find(example().ref) is None

    def test_work_begins_empty_unless_it_is_resumed(self, store: Store) -> None:
        for resume, expected in ((False, []), (True, ["left"])):
            with store.writing(example().ref, lambda holder: None) as work:
                work.begin(resume=resume)
                assert [path.name for path in work.data.iterdir()] == expected
                (work.data / "left").write_bytes(b"")

    def test_publishing_removes_the_checkpoint(self, store: Store) -> None:
        with store.writing(example().ref, lambda holder: None) as work:
            work.begin(resume=False)
            work.checkpoint.parent.mkdir(parents=True)
            work.checkpoint.write_bytes(b"state")
            work.publish(_written(work, example(), b"contents"))
            assert not work.checkpoint.exists()

    def test_the_first_of_two_equal_artefacts_stays(self, store: Store) -> None:
        first = publish(store, example(), b"first")
        assert publish(store, example(), b"other") == first
        assert store.find(first.ref) == first
        assert store.verify(first.ref, full=True) == ()

    def test_artefacts_are_listed_by_stage_and_key(self, store: Store) -> None:
        refs = [publish(store, example(stage, gain)).ref for stage in "ba" for gain in (1.0, 2.0)]
        assert list(store.refs()) == sorted(refs, key=lambda ref: (ref.stage, ref.key))
        assert {ref.stage for ref in store.refs("a")} == {"a"}
        assert list(store.refs("absent")) == []

    def test_the_newest_artefacts_of_a_stage_come_first(self, store: Store) -> None:
        refs = []
        for gain in (3.0, 1.0, 2.0):
            refs.append(publish(store, example(gain=gain)).ref)
            time.sleep(0.02)  # file systems keep time in ticks of some milliseconds
        assert store.newest("geometry", 5) == refs[::-1]
        assert store.newest("geometry", 2) == [refs[2], refs[1]]
        assert store.newest("absent", 2) == []

    def test_a_sound_artefact_has_no_problems(self, store: Store) -> None:
        ref = publish(store, example()).ref
        assert store.verify(ref) == ()
        assert store.verify(ref, full=True) == ()

    def test_an_artefact_with_a_shortened_file_is_never_used(self, store: Store) -> None:
        ref = publish(store, example()).ref
        self.spoil(store, ref, "record.h5", b"cont")
        with pytest.raises(StoreError, match=r"record\.h5 has 4 bytes instead of 8"):
            store.find(ref)

    def test_an_artefact_with_a_lost_file_is_never_used(self, store: Store) -> None:
        ref = publish(store, example()).ref
        self.spoil(store, ref, "record.h5", None)
        with pytest.raises(StoreError, match=r"record\.h5 is missing"):
            store.find(ref)

    def test_full_verification_finds_a_flipped_bit(self, store: Store) -> None:
        ref = publish(store, example()).ref
        self.spoil(store, ref, "record.h5", b"cOntents")
        assert store.verify(ref) == ()
        assert store.verify(ref, full=True) == ("the checksum of record.h5 is wrong",)

    def test_full_verification_finds_a_foreign_file(self, store: Store) -> None:
        ref = publish(store, example()).ref
        self.spoil(store, ref, "foreign", b"")
        assert store.verify(ref, full=True) == ("foreign does not belong to it",)

    def test_a_damaged_artefact_is_set_aside_and_can_be_published_again(self, store: Store) -> None:
        manifest = publish(store, example())
        self.spoil(store, manifest.ref, "record.h5", b"cont")
        aside = store.quarantine(manifest.ref, ["seen by a reader"])
        assert aside is not None
        assert store.find(manifest.ref) is None
        assert list(store.refs()) == []
        assert publish(store, example()) == store.find(manifest.ref)

    def test_a_sound_artefact_is_never_set_aside(self, store: Store) -> None:
        ref = publish(store, example()).ref
        assert store.quarantine(ref, ["seen by a reader, repaired since"]) is None
        assert store.quarantine(example(gain=2.0).ref) is None
        assert store.verify(ref, full=True) == ()

    def test_a_second_writer_waits_and_learns_for_whom(self, store: Store) -> None:
        ref = example().ref
        waits: list[Holder] = []
        waiting, entered = threading.Event(), threading.Event()

        def on_wait(holder: Holder) -> None:
            waits.append(holder)
            waiting.set()

        def second() -> None:
            with store.writing(ref, on_wait):
                entered.set()

        with store.writing(ref, lambda holder: None):
            other = threading.Thread(target=second)
            other.start()
            assert waiting.wait(timeout=30)
            assert not entered.is_set()
        other.join(timeout=30)
        assert entered.is_set()
        assert [holder.stage for holder in waits] == [ref.stage]

    def test_writers_of_different_artefacts_do_not_wait(self, store: Store) -> None:
        def refuse(holder: Holder) -> None:
            raise AssertionError(f"waits for {holder}")

        with (
            store.writing(example(gain=1.0).ref, refuse),
            store.writing(example(gain=2.0).ref, refuse) as work,
        ):
            work.begin(resume=False)
            work.publish(_written(work, example(gain=2.0), b"contents"))
        assert list(store.refs()) == [Ref("geometry", example(gain=2.0).key)]

    def test_a_run_is_alive_until_it_is_finished(self, store: Store) -> None:
        label = RunLabel("one", named=True)
        store.begin(label)
        store.begin(label)
        assert [(run.label, run.alive, run.finished) for run in store.upkeep.runs()] == [
            (label, True, None)
        ]
        store.finish(label)
        (run,) = store.upkeep.runs()
        assert run.label == label
        assert not run.alive
        assert run.finished is not None

    def test_a_run_registers_what_it_asks_for_whether_it_is_there_or_not(
        self, store: Store
    ) -> None:
        label, other = RunLabel("one"), RunLabel("other")
        for each in (label, other):
            store.begin(each)
        there, absent = publish(store, example(gain=1.0)), example(gain=2.0).ref
        assert store.find(there.ref, label) == there
        assert store.find(absent, label) is None
        assert set(store.upkeep.used_by(label)) == {there.ref, absent}
        assert list(store.upkeep.used_by(other)) == []

    def test_finding_an_artefact_for_a_run_is_its_last_use(self, store: Store) -> None:
        label = RunLabel("one")
        store.begin(label)
        ref = publish(store, example()).ref
        store.find(ref)
        assert store.upkeep.last_uses() == {}
        store.find(ref, label)
        ((found, used),) = store.upkeep.last_uses().items()
        assert found == ref
        assert abs(used - time.time()) < 60  # clocks of file servers differ by seconds

    def test_a_run_that_ends_well_replaces_earlier_ones_of_its_name(self, store: Store) -> None:
        labels = [RunLabel("one") for _ in range(3)] + [RunLabel("other")]
        for label in labels:
            store.begin(label)
            store.find(example().ref, label)
            store.finish(label, keep_earlier=label is not labels[2])
        assert {run.label for run in store.upkeep.runs()} == {labels[2], labels[3]}
        assert list(store.upkeep.used_by(labels[0])) == []

    def test_a_forgotten_run_leaves_nothing(self, store: Store) -> None:
        label = RunLabel("one")
        store.begin(label)
        store.find(example().ref, label)
        store.finish(label)
        store.upkeep.forget(label)
        assert list(store.upkeep.runs()) == []
        assert list(store.upkeep.used_by(label)) == []

    def test_a_store_in_another_process_registers_for_the_same_run(self, store: Store) -> None:
        label = RunLabel("one")
        store.begin(label)
        copy: Store = pickle.loads(pickle.dumps(store))
        copy.find(example().ref, pickle.loads(pickle.dumps(label)))
        assert list(store.upkeep.used_by(label)) == [example().ref]
