"""Stores on object storage: the same promises as in a folder, and leases instead of file locks."""

from __future__ import annotations

import uuid
from pathlib import Path

import pytest

from pipeline.keys import Ref
from pipeline.store import Store
from pipeline.store.opening import remote_store
from pipeline.store.remote import RemoteStore
from pipeline.store.remote.markers import data_folder
from pipeline.testing.stores import StoreConformance
from pipeline.testing.upkeep import UpkeepConformance


class RemoteConformance(StoreConformance):
    """What differs in the tests only: files are spoilt on the server, not in the copy."""

    def spoil(self, store: Store, ref: Ref, name: str, contents: bytes | None) -> None:
        assert isinstance(store, RemoteStore)
        marker = store.reader.marker(ref)
        assert marker is not None
        path = f"{data_folder(ref, marker.attempt)}/{name}"
        if contents is None:
            store.objects.remove([path])
        else:
            store.objects.write({path: contents})


class TestSharedFolder(RemoteConformance):
    @pytest.fixture
    def store(self, tmp_path: Path) -> RemoteStore:
        return remote_store((tmp_path / "shared").as_uri(), cache=tmp_path / "cache")


class TestMemory(RemoteConformance, UpkeepConformance):
    @pytest.fixture
    def store(self, tmp_path: Path) -> RemoteStore:
        return remote_store(f"memory://{uuid.uuid4().hex}/store", cache=tmp_path / "cache")


class TestS3(RemoteConformance, UpkeepConformance):
    @pytest.fixture
    def store(self, bucket: str, tmp_path: Path) -> RemoteStore:
        return remote_store(f"{bucket}/store", cache=tmp_path / "cache")
