"""Objects on whatever fsspec has a driver for: S3, Google Cloud Storage, Azure, ..."""

from __future__ import annotations

import contextlib
import datetime
import inspect
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from pipeline.errors import InputError, StoreError
from pipeline.store.remote.objects import Entry
from pipeline.store.remote.trouble import may_pass, told

R = TypeVar("R")

IN_BUCKETS = {"s3", "s3a", "gs", "gcs", "abfs", "abfss", "az", "adl", "oss", "oci", "tos"}
"""Protocols whose paths begin with a bucket, which nobody makes by the way."""

EXTRAS = {"s3": "myofilm[s3]", "s3a": "myofilm[s3]", "gs": "gcsfs", "gcs": "gcsfs", "az": "adlfs"}
"""What to install for a protocol."""

S3_OPTIONS = {
    "connect_timeout": 3,
    "read_timeout": 60,
    "retries": {"mode": "standard", "total_max_attempts": 1},
    "max_pool_connections": 64,
}
"""An endpoint that is not there is to be known within seconds; whether to try again is decided here.

Manifests are many and small, so more connections than the usual ten. Settings of the user go first.
"""

HASTE, PATIENCE = 1.0, 30.0
"""Seconds for which a request is made again: in the beginning, and once there is work to lose."""

PAUSE = 0.2, 5.0
"""Seconds between two attempts, first and at most."""

MODIFIED = ("LastModified", "last_modified", "mtime", "updated", "modified", "created")
"""What drivers call the time of the last change."""

_in_this_process = threading.Lock()


class FsspecObjects:
    """Objects below a URL.

    Parameters
    ----------
    location
        URL, for instance ``s3://bucket/prefix``.

    Raises
    ------
    InputError
        If there is no driver for its protocol.
    """

    def __init__(self, location: str) -> None:
        self.location = location.rstrip("/")
        self._patience = HASTE
        self.protocol = location.partition("://")[0].rpartition("::")[2]
        try:
            import fsspec

            fsspec.get_filesystem_class(self.protocol)
        except ImportError as error:
            raise InputError(
                f"the store {location} needs a driver that is not installed ({error}); "
                f"pip install '{EXTRAS.get(self.protocol, 'fsspec')}'"
            ) from error
        except ValueError as error:
            raise InputError(
                f"there is no driver for {self.protocol}:// to reach the store {location}; "
                "give a folder, or a URL such as s3://bucket/prefix"
            ) from error

    def __reduce__(self) -> tuple[type[FsspecObjects], tuple[str]]:
        """Connections stay in this process."""
        return FsspecObjects, (self.location,)

    @cached_property
    def _place(self) -> tuple[Any, str]:
        """File system and root."""
        try:
            return self._open()
        except Exception as error:
            raise told(error, self.location) from error

    def _open(self) -> tuple[Any, str]:
        import fsspec

        # Listings must show what others have published since.
        options: dict[str, Any] = {"use_listings_cache": False}
        if self.protocol in ("s3", "s3a"):
            own = fsspec.config.conf.get(self.protocol, {}).get("config_kwargs", {})
            options["config_kwargs"] = S3_OPTIONS | dict(own)
        fs, root = fsspec.core.url_to_fs(self.location, **options)
        if hasattr(fs, "retries"):
            fs.retries = 1
        return fs, root.rstrip("/")

    def be_patient(self) -> None:
        """From now on, ride out interruptions of some seconds: work would be lost by giving up."""
        self._patience = PATIENCE

    def check_place(self) -> None:
        """Raise ``StoreError`` if there is no such bucket."""
        if self.protocol not in IN_BUCKETS:
            return
        fs, root = self._place
        bucket = root.partition("/")[0]
        try:
            self._ask(lambda: fs.info(bucket))
        except FileNotFoundError:
            raise StoreError(
                f"there is no bucket {bucket!r}",
                path=self.location,
                remedy="make it, or choose another store with --store",
            ) from None
        except StoreError as error:
            if not isinstance(error.__cause__, PermissionError):
                raise  # otherwise some of its objects may be allowed nevertheless

    def read(self, path: str) -> bytes | None:
        """Contents of an object."""
        try:
            return bytes(self._ask(lambda: self._fs.cat_file(self._name(path), **self._small)))
        except FileNotFoundError:
            return None

    def read_many(self, paths: Iterable[str]) -> dict[str, bytes]:
        """Contents of several objects, over several connections."""
        names = {self._name(path): path for path in paths}

        def request() -> dict[str, bytes]:
            found = {}
            answers = self._fs.cat(list(names), on_error="return", **self._small)
            for name, contents in answers.items():
                if isinstance(contents, bytes):
                    found[names[name]] = contents
                elif not isinstance(contents, FileNotFoundError):
                    raise contents
            return found

        return self._ask(request) if names else {}

    def write(self, contents: Mapping[str, bytes]) -> None:
        """Write objects, or replace them."""
        named = {self._name(path): one for path, one in contents.items()}
        self._told_if_missing(lambda: self._fs.pipe(named))

    def create(self, path: str, contents: bytes) -> bool:
        """Write an object unless there is one, as one request that the server decides upon.

        If the answer to a first attempt was lost, it may be there by that: then ``False``, too.
        """

        def request() -> bool:
            # Drivers that look first and then write are used inside one process only.
            with _in_this_process:
                self._fs.pipe_file(self._name(path), contents, mode="create")
            return True

        try:
            return self._told_if_missing(request)
        except FileExistsError:
            return False

    def listing(self, folder: str) -> dict[str, Entry]:
        """All objects below a folder, some 1,000 by request."""
        try:
            found = self._ask(lambda: self._fs.find(self._name(folder), detail=True))
        except FileNotFoundError:
            return {}
        root = len(self._place[1]) + 1
        # A driver that finds nothing may look whether the folder is an object, or has become one.
        files = {path: info for path, info in found.items() if info.get("type") == "file"}
        return {path[root:]: self._entry(info) for path, info in files.items()}

    def upload(self, files: Mapping[str, Path]) -> None:
        """Write objects from files, over several connections."""
        if files:
            sources, targets = [str(path) for path in files.values()], self._names(files)
            self._told_if_missing(lambda: self._fs.put(sources, targets))

    def download(self, files: Mapping[str, Path]) -> None:
        """Write files from objects, over several connections."""
        for target in files.values():
            target.parent.mkdir(parents=True, exist_ok=True)
        if files:
            sources, targets = self._names(files), [str(path) for path in files.values()]
            self._told_if_missing(lambda: self._fs.get(sources, targets))

    def remove(self, paths: Iterable[str]) -> None:
        """Remove objects, some 1,000 by request where the server can."""
        names = self._names(paths)

        def request() -> None:
            try:
                self._fs.rm(names)
            except FileNotFoundError:
                for name in names:
                    with contextlib.suppress(FileNotFoundError):
                        self._fs.rm_file(name)

        if names:
            self._ask(request)

    @property
    def _fs(self) -> Any:
        return self._place[0]

    @cached_property
    def _small(self) -> dict[str, int]:
        """What keeps s3fs from asking for the size of an object first, to read a large one in parts."""
        taken = inspect.signature(getattr(self._fs, "_cat_file", self._fs.cat_file)).parameters
        return {"max_concurrency": 1} if "max_concurrency" in taken else {}

    def _name(self, path: str) -> str:
        return f"{self._place[1]}/{path}"

    def _names(self, paths: Iterable[str]) -> list[str]:
        return [self._name(path) for path in paths]

    def _ask(self, request: Callable[[], R]) -> R:
        """Answer to a request, which is made again while the server cannot be reached.

        Raises
        ------
        FileNotFoundError, FileExistsError
            As the driver raises them.
        StoreError
            Whatever else it raises, in the user's words.
        """
        until, pause = time.monotonic() + self._patience, PAUSE[0]
        while True:
            try:
                return request()
            except (FileNotFoundError, FileExistsError, StoreError):
                raise
            except Exception as error:
                if not may_pass(error) or time.monotonic() + pause > until:
                    raise told(error, self.location) from error
            time.sleep(pause)
            pause = min(2.0 * pause, PAUSE[1])

    def _told_if_missing(self, request: Callable[[], R]) -> R:
        """The same, where something that is missing is trouble."""
        try:
            return self._ask(request)
        except FileNotFoundError as error:
            raise told(error, self.location) from error

    def _entry(self, info: Mapping[str, Any]) -> Entry:
        modified = next((info[name] for name in MODIFIED if info.get(name) is not None), None)
        if isinstance(modified, str):
            modified = datetime.datetime.fromisoformat(modified)
        if isinstance(modified, datetime.datetime):
            if modified.tzinfo is None:
                modified = modified.replace(tzinfo=datetime.UTC)
            modified = modified.timestamp()
        if not isinstance(modified, int | float):
            raise StoreError("the place keeps no times of its objects", path=self.location)
        size = int(info.get("size") or 0)
        return Entry(size, float(modified), str(info.get("ETag") or f"{size} {modified}"))
