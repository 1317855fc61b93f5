"""What is kept of source files is found by their contents alone, and damage to it is never believed."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from subprocess import Popen

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.fingerprint import Fingerprint, fingerprint, sources
from pipeline.fingerprint.source_cache import SourceCache
from pipeline.fingerprint.syntax import SourceFile, parsed

FILES = {
    "__init__.py": "",
    "stage.py": "from .law import rate\n\ndef run():\n    return rate()\n",
    "law.py": "def rate():\n    return 1.0\n",
}


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of two modules."""
    folder = tmp_path / "rates"
    folder.mkdir()
    for name, text in FILES.items():
        (folder / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    return folder


class Process:
    """What another process would do: nothing in memory, the same cache."""

    def __init__(self, file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.file, self._patch, self.parsed = file, monkeypatch, 0

    def fingerprint(self) -> Fingerprint:
        """Fingerprint of the package; ``parsed`` counts the files that had to be parsed."""

        def counted(contents: bytes, package: str) -> SourceFile:
            self.parsed += 1
            return parsed(contents, package)

        self.parsed = 0
        cache = SourceCache(self.file)
        self._patch.setattr(sources, "_KNOWN", {})
        self._patch.setattr(sources, "_cache", lambda: cache)
        self._patch.setattr(sources, "parsed", counted)
        return fingerprint(["rates.stage"], ["rates"])


@pytest.fixture
def process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Process:
    return Process(tmp_path / "cache" / "sources.txt", monkeypatch)


def test_a_second_process_parses_nothing(package: Path, process: Process) -> None:
    first = process.fingerprint()
    assert process.parsed == len(FILES)
    assert process.fingerprint() == first
    assert process.parsed == 0


def test_after_an_edit_the_edited_file_alone_is_parsed(package: Path, process: Process) -> None:
    first = process.fingerprint()
    (package / "law.py").write_text("def rate():\n    return 2.0\n")
    assert process.fingerprint() != first
    assert process.parsed == 1


def test_an_edit_of_equal_size_and_time_is_seen(package: Path, process: Process) -> None:
    first = process.fingerprint()
    file = package / "law.py"
    before = file.stat()
    with open(file, "r+", encoding="utf-8") as same_inode:
        same_inode.write(FILES["law.py"].replace("1.0", "2.0"))
    os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))
    after = file.stat()
    assert (after.st_mtime_ns, after.st_size, after.st_ino) == (
        before.st_mtime_ns,
        before.st_size,
        before.st_ino,
    )
    assert process.fingerprint() != first
    # Within one process, too: whoever asks anew is told of the present file.
    file.write_text(FILES["law.py"])
    os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert fingerprint(["rates.stage"], ["rates"]) == first


def test_a_copy_that_keeps_the_times_of_other_code_is_seen(
    package: Path, process: Process, tmp_path: Path
) -> None:
    first = process.fingerprint()
    other = tmp_path / "law.py"
    other.write_text(FILES["law.py"].replace("1.0", "3.0"))
    shutil.copystat(package / "law.py", other)
    shutil.copy2(other, package / "law.py")
    assert process.fingerprint() != first


def test_two_checkouts_share_what_is_known(
    package: Path, process: Process, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = process.fingerprint()
    elsewhere = tmp_path / "elsewhere"
    shutil.copytree(package, elsewhere / "rates")
    monkeypatch.syspath_prepend(elsewhere)
    assert sources.locate("rates.law") == elsewhere / "rates" / "law.py"
    assert process.fingerprint() == first
    assert process.parsed == 0
    # ... and each is told of its own code.
    (elsewhere / "rates" / "law.py").write_text("def rate():\n    return 2.0\n")
    assert process.fingerprint() != first


def test_equal_files_of_two_packages_import_from_their_own(package: Path, process: Process) -> None:
    (package / "inner").mkdir()
    for name, text in FILES.items():
        (package / "inner" / name).write_text(text)
    (package / "stage.py").write_text("from .law import rate\nfrom .inner.stage import run\n")
    for _ in range(2):
        assert {"rates.law", "rates.inner.law"} <= process.fingerprint().modules.keys()


def test_a_damaged_cache_is_never_believed(package: Path, process: Process) -> None:
    first = process.fingerprint()
    kept = process.file.read_bytes()
    for place in range(0, len(kept), 3):
        for bit in (1, 16):
            process.file.write_bytes(kept[:place] + bytes([kept[place] ^ bit]) + kept[place + 1 :])
            assert process.fingerprint() == first


@pytest.mark.parametrize("left", [0, 1, 50, 200])
def test_after_a_torn_write_the_cache_heals(package: Path, process: Process, left: int) -> None:
    first = process.fingerprint()
    process.file.write_bytes(process.file.read_bytes()[:left])
    assert process.fingerprint() == first
    assert process.parsed > 0
    assert process.fingerprint() == first
    assert process.parsed == 0


@pytest.mark.parametrize("what", ["a folder in its place", "a file above it", "no place"])
def test_without_a_usable_cache_files_are_parsed(
    package: Path, process: Process, what: str
) -> None:
    if what == "a folder in its place":
        process.file.mkdir(parents=True)
    elif what == "a file above it":
        process.file.parent.write_text("")
    else:
        process.file = None  # type: ignore[assignment]
    assert process.fingerprint() == process.fingerprint()
    assert process.parsed == len(FILES)


def test_a_cache_that_has_grown_large_is_begun_anew(package: Path, process: Process) -> None:
    process.file.parent.mkdir()
    process.file.write_bytes(b"x" * 2_000_000)
    process.fingerprint()
    assert process.file.stat().st_size < 2_000
    process.fingerprint()
    assert process.parsed == 0


APPEND = """
import sys
from pathlib import Path
from pipeline.fingerprint.source_cache import SourceCache
from pipeline.fingerprint.syntax import SourceFile
cache = SourceCache(Path("cache.txt"))
for i in range(100):
    name = f"{WHO}-{i}"
    cache.add({name: SourceFile(name, (name,) * 20)})
"""


def test_processes_that_write_at_once_lose_nothing(
    start: Callable[..., Popen[str]], tmp_path: Path
) -> None:
    writers = [start(APPEND.replace("{WHO}", str(who))) for who in range(4)]
    assert [writer.wait(60) for writer in writers] == [0] * 4
    cache = SourceCache(tmp_path / "cache.txt")
    for name in (f"{who}-{i}" for who in range(4) for i in range(100)):
        assert cache.find(name) == SourceFile(name, (name,) * 20)


names = st.text(st.characters(categories=["Ll", "Lu", "Nd"]), min_size=1)


@given(st.none() | st.just("9df8008d121f127be5ae22d468fc2fec163e3ee1"), st.lists(names))
def test_what_is_read_back_is_what_was_kept(digest: str | None, imports: list[str]) -> None:
    from pipeline.fingerprint.source_cache import _line, _read

    source = SourceFile(digest, tuple(imports))
    assert _read(_line("0123", source).removesuffix(b"\n")) == source
