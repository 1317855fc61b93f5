"""The list of artefacts: its cache saves time and is never believed."""

from __future__ import annotations

import os

import pytest

from pipeline.keys import Ref
from pipeline.store import LocalStore
from pipeline.store.catalogue import SPARE_LINES, row_of
from pipeline.store.local_upkeep import INDEX
from pipeline.testing.stores import example, forge, publish


def refs(store: LocalStore) -> list[Ref]:
    return [row.ref for row in store.upkeep.rows()]


def test_publishing_adds_the_row_so_that_no_list_reads_a_manifest(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    manifests = [publish(store, example(gain=gain)) for gain in (1.0, 2.0)]
    monkeypatch.setattr("pipeline.manifest.Manifest.from_json", None)
    rows = store.upkeep.rows()
    assert sorted(rows, key=lambda row: row.ref.key) == rows
    assert {row.ref: row for row in rows} == {m.ref: row_of(m) for m in manifests}


def test_a_lost_or_damaged_cache_changes_nothing(store: LocalStore) -> None:
    for gain in (1.0, 2.0, 3.0):
        publish(store, example(gain=gain))
    index = store.path / INDEX
    expected, contents = store.upkeep.rows(), index.read_bytes()
    for damage in (
        b"",
        contents[:-40],
        contents[40:],
        contents + b'["a"]\n{}\nnull\n3\n',
        b"\x00\xff" * 99,
    ):
        index.write_bytes(damage)
        assert store.upkeep.rows() == expected
        assert store.upkeep.rows() == expected  # and from what was added
    index.unlink()
    assert store.upkeep.rows() == expected


def test_no_line_counts_in_which_a_bit_flipped(store: LocalStore) -> None:
    # Above all the inputs must be right: a collection asks them what a tag keeps.
    publish(store, example())
    index = store.path / INDEX
    expected, contents = store.upkeep.rows(), index.read_bytes()
    for place in range(len(contents)):
        index.write_bytes(contents[:place] + bytes([contents[place] ^ 1]) + contents[place + 1 :])
        assert store.upkeep.rows() == expected


def test_a_line_that_was_not_written_whole_spoils_no_other(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    (store.path).mkdir()
    (store.path / INDEX).write_bytes(b'["geometry", "0123')
    ref = publish(store, example()).ref
    monkeypatch.setattr("pipeline.manifest.Manifest.from_json", None)
    assert refs(store) == [ref]


def test_what_the_cache_names_and_the_store_has_not_is_not_listed(store: LocalStore) -> None:
    one, other = (publish(store, example(gain=gain)).ref for gain in (1.0, 2.0))
    os.rename(store.data(one).parent, store.path / "elsewhere")
    assert refs(store) == [other]


def test_a_changed_manifest_is_read_again(store: LocalStore) -> None:
    ref = publish(store, example()).ref
    forge(store, ref, seconds=77.0)
    assert store.upkeep.rows()[0].seconds == 77.0


def test_an_unreadable_manifest_is_listed_as_damaged_and_never_remembered(
    store: LocalStore,
) -> None:
    ref = publish(store, example()).ref
    path = store.data(ref).parent / "manifest.json"
    contents = path.read_bytes()
    path.write_bytes(contents[:-9])
    assert store.upkeep.rows()[0].problem
    path.unlink()
    assert store.upkeep.rows()[0].problem == "its manifest is missing"
    path.write_bytes(contents)
    assert store.upkeep.rows()[0].problem == ""


def test_a_list_works_where_nothing_may_be_written(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    ref = publish(store, example()).ref
    (store.path / INDEX).unlink()

    def refuse(*arguments: object, **named: object) -> int:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)
    assert refs(store) == [ref]


def test_the_cache_does_not_grow_without_end(store: LocalStore) -> None:
    ref = publish(store, example()).ref
    index = store.path / INDEX
    line = index.read_text().strip()
    index.write_text(f"{line}\n" * (SPARE_LINES + 5))
    assert refs(store) == [ref]
    assert index.read_text().strip() == line
