"""Objects on whatever fsspec has a driver for: S3, Google Cloud Storage, Azure, ..."""

from __future__ import annotations

import contextlib
import datetime
import threading
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from pipeline.errors import InputError, StoreError
from pipeline.store.remote.objects import Entry
from pipeline.store.remote.trouble import told

IN_BUCKETS = {"s3", "s3a", "gs", "gcs", "abfs", "abfss", "az", "adl", "oss", "oci", "tos"}
"""Protocols whose paths begin with a bucket, which nobody makes by the way."""

EXTRAS = {"s3": "myofilm[s3]", "s3a": "myofilm[s3]", "gs": "gcsfs", "gcs": "gcsfs", "az": "adlfs"}
"""What to install for a protocol."""

S3_OPTIONS = {
    "connect_timeout": 3,
    "read_timeout": 60,
    "retries": {"mode": "standard", "total_max_attempts": 2},
}
"""An endpoint that is not there is to be known within seconds. Settings of the user go first."""

HASTY, PATIENT = 2, 10
"""Attempts at a request to S3: up to 0.3 s in the beginning, up to 30 s once there is work to lose."""

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
        self._patient = False
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
        import fsspec

        # Listings must show what others have published since.
        options: dict[str, Any] = {"use_listings_cache": False}
        if self.protocol in ("s3", "s3a"):
            own = fsspec.config.conf.get(self.protocol, {}).get("config_kwargs", {})
            options["config_kwargs"] = S3_OPTIONS | dict(own)
        fs, root = fsspec.core.url_to_fs(self.location, **options)
        if hasattr(fs, "retries"):
            fs.retries = PATIENT if self._patient else HASTY
        return fs, root.rstrip("/")

    def be_patient(self) -> None:
        """From now on, ride out interruptions of some seconds: work would be lost by giving up."""
        if not self._patient:
            self._patient = True
            with self._telling():
                fs, _ = self._place
                if hasattr(fs, "retries"):
                    fs.retries = PATIENT

    def check_place(self) -> None:
        """Raise ``StoreError`` if there is no such bucket."""
        if self.protocol not in IN_BUCKETS:
            return
        fs, root = self._fs_and("")
        bucket = root.partition("/")[0]
        with self._telling():
            try:
                fs.info(bucket)
            except FileNotFoundError:
                raise StoreError(
                    f"there is no bucket {bucket!r}",
                    path=self.location,
                    remedy="make it, or choose another store with --store",
                ) from None
            except PermissionError:
                return  # it may be allowed to use some of its objects nevertheless

    def read(self, path: str) -> bytes | None:
        """Contents of an object."""
        fs, name = self._fs_and(path)
        with self._telling():
            try:
                return bytes(fs.cat_file(name))
            except FileNotFoundError:
                return None

    def read_many(self, paths: Iterable[str]) -> dict[str, bytes]:
        """Contents of several objects, over several connections."""
        names = {self._fs_and(path)[1]: path for path in paths}
        if not names:
            return {}
        found = {}
        with self._telling():
            for name, contents in self._place[0].cat(list(names), on_error="return").items():
                if isinstance(contents, bytes):
                    found[names[name]] = contents
                elif not isinstance(contents, FileNotFoundError):
                    raise contents
        return found

    def write(self, contents: Mapping[str, bytes]) -> None:
        """Write objects, or replace them."""
        with self._telling():
            self._place[0].pipe({self._fs_and(path)[1]: one for path, one in contents.items()})

    def create(self, path: str, contents: bytes) -> bool:
        """Write an object unless there is one, as one request that the server decides upon."""
        fs, name = self._fs_and(path)
        # Drivers that look first and then write are used inside one process only.
        with self._telling(), _in_this_process:
            try:
                fs.pipe_file(name, contents, mode="create")
            except FileExistsError:
                return False
        return True

    def listing(self, folder: str) -> dict[str, Entry]:
        """All objects below a folder, some 1,000 by request."""
        fs, name = self._fs_and(folder)
        with self._telling():
            try:
                found = fs.find(name, detail=True)
            except FileNotFoundError:
                return {}
        root = len(self._place[1]) + 1
        return {path[root:]: self._entry(path, info) for path, info in found.items()}

    def upload(self, files: Mapping[str, Path]) -> None:
        """Write objects from files, over several connections."""
        if files:
            targets = [self._fs_and(path)[1] for path in files]
            with self._telling():
                self._place[0].put([str(source) for source in files.values()], targets)

    def download(self, files: Mapping[str, Path]) -> None:
        """Write files from objects, over several connections."""
        for target in files.values():
            target.parent.mkdir(parents=True, exist_ok=True)
        if files:
            names = [self._fs_and(path)[1] for path in files]
            with self._telling():
                self._place[0].get(names, [str(target) for target in files.values()])

    def remove(self, paths: Iterable[str]) -> None:
        """Remove objects, some 1,000 by request where the server can."""
        names = [self._fs_and(path)[1] for path in paths]
        fs = self._place[0]
        with self._telling():
            try:
                if names:
                    fs.rm(names)
            except FileNotFoundError:
                for name in names:
                    with contextlib.suppress(FileNotFoundError):
                        fs.rm_file(name)

    def _fs_and(self, path: str) -> tuple[Any, str]:
        with self._telling():
            fs, root = self._place
        return fs, f"{root}/{path}" if path else root

    def _entry(self, path: str, info: Mapping[str, Any]) -> Entry:
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

    @contextlib.contextmanager
    def _telling(self) -> Iterator[None]:
        """Whatever the driver raises, in the user's words."""
        try:
            yield
        except StoreError:
            raise
        except Exception as error:
            raise told(error, self.location) from error
