"""What the upkeep of every store must do, as tests, beside those of ``pipeline.testing.stores``."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from pipeline.errors import InputError
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.store import RunLabel, Store
from pipeline.store.catalogue import Row
from pipeline.store.cleaning import Limits
from pipeline.store.collection import collect, plan, remove
from pipeline.testing.stores import example, publish


def refs_of(store: Store) -> set[Ref]:
    """All artefacts."""
    return set(store.refs())


class UpkeepConformance:
    """Inherit, give a fixture ``store``, and listing, tagging and removing are tested."""

    @pytest.fixture
    def store(self, tmp_path: Path) -> Iterator[Store]:
        """An empty store."""
        raise TypeError("a test class for a store defines the fixture 'store'")

    def test_an_empty_store_has_nothing_to_keep_up(self, store: Store) -> None:
        assert store.upkeep.rows() == []
        assert store.upkeep.last_uses() == {}
        assert store.upkeep.tags() == {}
        assert store.upkeep.leftovers() == []

    def test_rows_tell_what_the_manifests_tell(self, store: Store) -> None:
        manifests = [publish(store, example(stage, g)) for stage in "ab" for g in (1.0, 2.0)]
        finished = 1704067201.0  # 2024-01-01T00:00:01 UTC
        expected = [Row(m.ref, 8, 1.5, finished) for m in manifests]
        expected.sort(key=lambda row: (row.ref.stage, row.ref.key))
        for _ in range(2):  # the second time from what the first has kept
            assert store.upkeep.rows() == expected

    def test_tags_come_and_go(self, store: Store) -> None:
        one, other = (publish(store, example(gain=gain)).ref for gain in (1.0, 2.0))
        for ref, tag in [(one, "b"), (one, "a"), (one, "a"), (other, "été+1")]:
            store.upkeep.tag(ref, tag)
        assert store.upkeep.tags() == {one: ("a", "b"), other: ("été+1",)}
        store.upkeep.untag(one, "a")
        store.upkeep.untag(one, "never-given")
        store.upkeep.untag(other, "été+1")
        assert store.upkeep.tags() == {one: ("b",)}

    @pytest.mark.parametrize("tag", ["", "a b", "a/b", "a,b", "a\n", "a" * 100])
    def test_a_tag_that_cannot_be_typed_is_bad_input(self, store: Store, tag: str) -> None:
        ref = publish(store, example()).ref
        with pytest.raises(InputError, match="cannot be a tag"):
            store.upkeep.tag(ref, tag)

    def test_what_is_removed_leaves_nothing_and_can_be_published_again(self, store: Store) -> None:
        ref, other = (publish(store, example(gain=gain)).ref for gain in (1.0, 2.0))
        label = RunLabel("one")
        store.begin(label)
        store.find(ref, label)
        assert store.upkeep.remove([ref], tuple) == [ref]
        assert store.find(ref) is None
        assert store.upkeep.last_uses() == {}
        assert refs_of(store) == {other}
        assert [row.ref for row in store.upkeep.rows()] == [other]
        assert store.upkeep.leftovers() == []
        manifest = publish(store, example(gain=1.0))
        assert store.find(ref) == manifest
        assert len(store.upkeep.rows()) == 2

    def test_what_must_be_kept_and_what_is_not_there_are_not_removed(self, store: Store) -> None:
        ref = publish(store, example()).ref
        assert store.upkeep.remove([ref, example(gain=2.0).ref], lambda: {ref}) == []
        assert refs_of(store) == {ref}

    @pytest.mark.parametrize("stays", [True, False])
    def test_who_asks_during_a_removal_gets_what_stays_or_nothing(
        self, store: Store, stays: bool
    ) -> None:
        label, ref = RunLabel("one"), publish(store, example()).ref
        store.begin(label)
        found: list[Manifest | None] = []

        def ask() -> None:  # as the engine does
            manifest = store.find(ref, label)
            if manifest is None:
                with store.writing(ref, lambda holder: None):
                    manifest = store.find(ref)
            found.append(manifest)

        reader = threading.Thread(target=ask)

        def kept() -> list[Ref]:
            reader.start()
            reader.join(timeout=0.2)  # it may wait for the end of the removal
            return [ref] if stays else []

        removed = store.upkeep.remove([ref], kept)
        reader.join(timeout=30)
        assert removed == ([] if stays else [ref])
        assert [one is not None for one in found] == [stays]

    def test_work_that_was_given_up_is_left_over_until_it_is_discarded(self, store: Store) -> None:
        before = time.time()
        with store.writing(example().ref, lambda holder: None) as work:
            work.begin(resume=False)
            (work.data / "record.h5").write_bytes(b"half")
        (leftover,) = store.upkeep.leftovers()
        assert leftover.key == example().key
        assert leftover.size == 4
        assert abs(leftover.changed - before) < 60  # clocks of file servers differ by seconds
        assert not leftover.resumable
        assert not leftover.published
        with store.writing(example().ref, lambda holder: None) as work:
            work.checkpoint.parent.mkdir(parents=True)
            work.checkpoint.write_bytes(b"state")
        (leftover,) = store.upkeep.leftovers()
        assert leftover.resumable
        assert store.upkeep.discard(leftover)
        assert store.upkeep.leftovers() == []
        assert publish(store, example()).ref in refs_of(store)

    def test_work_that_went_on_since_it_was_listed_is_not_discarded(self, store: Store) -> None:
        with store.writing(example().ref, lambda holder: None) as work:
            work.begin(resume=False)
        (leftover,) = store.upkeep.leftovers()
        time.sleep(0.02)  # file systems keep time in ticks of some milliseconds
        with store.writing(example().ref, lambda holder: None) as work:
            (work.data / "record.h5").write_bytes(b"more")
        assert not store.upkeep.discard(leftover)
        assert store.upkeep.discard(store.upkeep.leftovers()[0])

    def test_work_that_goes_on_is_not_discarded(self, store: Store) -> None:
        with store.writing(example().ref, lambda holder: None) as work:
            work.begin(resume=False)
            (leftover,) = store.upkeep.leftovers()
            assert leftover.busy
            assert not store.upkeep.discard(leftover)
            assert work.data.is_dir()

    def test_a_collection_takes_what_nothing_reaches(self, store: Store) -> None:
        label, over = RunLabel("one", named=True), RunLabel("over")
        for each in (label, over):
            store.begin(each)
        used, tagged, free, free_too = (
            publish(store, example(gain=gain)).ref for gain in (1.0, 2.0, 3.0, 4.0)
        )
        store.find(used, label)
        store.find(free, over)
        store.upkeep.tag(tagged, "paper")
        for each in (label, over):
            store.finish(each)
        planned = plan(store, Limits(unreachable=True))
        assert {removal.row.ref for removal in planned.removals} == {free, free_too}
        assert planned.size == 16
        assert refs_of(store) == {used, tagged, free, free_too}
        gone, _ = collect(store, planned)
        assert {removal.row.ref for removal in gone} == {free, free_too}
        assert refs_of(store) == {used, tagged}
        assert [run.label for run in store.upkeep.runs()] == [label]

    def test_what_a_living_run_asked_for_after_the_plan_stays(self, store: Store) -> None:
        label = RunLabel("one")
        ref, other = (publish(store, example(gain=gain)).ref for gain in (1.0, 2.0))
        planned = plan(store, Limits(unreachable=True))
        store.begin(label)
        store.find(ref, label)
        collect(store, planned)
        assert refs_of(store) == {ref}
        store.finish(label)
        assert remove(store, [ref, other], planned.rows) == [ref]
