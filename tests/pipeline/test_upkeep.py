"""Looking after a local store: lists, tags, what goes and what stays."""

from __future__ import annotations

import errno
import fcntl
from pathlib import Path
from typing import Any

import pytest

from pipeline.store import LocalStore
from pipeline.store.cleaning import Limits
from pipeline.store.collection import collect, plan
from pipeline.testing.stores import example, publish
from pipeline.testing.upkeep import UpkeepConformance


class TestLocalUpkeep(UpkeepConformance):
    @pytest.fixture
    def store(self, tmp_path: Path) -> LocalStore:
        return LocalStore(tmp_path / "store")


class TestLocalUpkeepWithoutFileLocks(UpkeepConformance):
    """Without locks the registers alone tell what is used."""

    @pytest.fixture
    def store(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> LocalStore:
        def flock(descriptor: int, operation: int) -> None:
            raise OSError(errno.ENOLCK, "No locks available")

        monkeypatch.setattr(fcntl, "flock", flock)
        return LocalStore(tmp_path / "store")

    # Without locks nobody can wait.
    test_who_asks_during_a_removal_gets_what_stays_or_nothing: Any = None
    test_work_that_went_on_since_it_was_listed_is_not_discarded: Any = None
    # The process that could still be at work is known by its number alone, and it is this one.
    test_work_that_was_given_up_is_left_over_until_it_is_discarded: Any = None


def test_a_removal_that_was_killed_is_completed_by_the_next_collection(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    ref = publish(store, example()).ref

    def killed(folder: Path) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("pipeline.store.local_upkeep.remove_tree", killed)
        with pytest.raises(KeyboardInterrupt):
            store.upkeep.remove([ref], tuple)
    assert store.find(ref) is None
    planned = plan(store, Limits())
    assert [leftover.key for leftover, _ in planned.leftovers] == [ref.key]
    assert publish(store, example()) == store.find(ref)
    collect(store, planned)
    assert list((store.path / "tmp").iterdir()) == []
    assert list(store.refs()) == [ref]
