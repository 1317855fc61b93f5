"""Which contents of its source file each module in memory was loaded from.

Python runs what it has read, whatever is saved afterwards. So a digest of the contents is noted when a
module is about to be loaded. Installed libraries are left out: their versions are recorded instead.

Python also takes compiled code for that of a source file whose size and modification time, in whole
seconds, are what they were when it was compiled. An edit within a second, or a copy that keeps its time,
would go unseen: compiled code that is not clearly younger than the last change of its source is removed.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterable, Iterator
from importlib.machinery import PathFinder
from importlib.util import cache_from_source
from typing import Any

from pipeline.fingerprint.contents import content_id

DOUBTFUL_NS = 2_000_000_000
"""Time stamps of files may be so coarse; compiling a module takes less."""

_LOADED: dict[str, str] = {}
"""Content id by the name of the module."""


def loaded_content(name: str, file: str) -> str | None:
    """Content id of what a module in memory was loaded from; of the present file if nothing is known."""
    if name not in _LOADED:
        _note(name, [file], everywhere=True)
    return _LOADED.get(name)


def watch() -> None:
    """Note every module from now on, and those already in memory as their files are now."""
    if any(isinstance(finder, _Watcher) for finder in sys.meta_path):
        return
    for name, module in list(sys.modules.items()):
        _note(name, [str(getattr(module, "__dict__", {}).get("__file__"))])
    sys.meta_path.insert(0, _Watcher())


class _Watcher:
    """Is asked first for every module that is to be loaded, and finds none."""

    def find_spec(self, name: str, path: Iterable[str] | None, target: Any = None) -> None:
        if path is not None:
            _note(name, _candidates(path, name.rpartition(".")[2]))
        elif name not in sys.stdlib_module_names:
            spec = PathFinder.find_spec(name)
            _note(name, [str(spec and spec.origin)])


def _candidates(folders: Iterable[str], name: str) -> Iterator[str]:
    for folder in folders:
        yield os.path.join(folder, name, "__init__.py")
        yield os.path.join(folder, f"{name}.py")


def _note(name: str, files: Iterable[str], *, everywhere: bool = False) -> None:
    """Note the contents of the first of some files that exists."""
    if name.partition(".")[0] in sys.stdlib_module_names and name != "__main__":
        return
    for file in files:
        if not file.endswith(".py") or (f"-packages{os.sep}" in file and not everywhere):
            return
        try:
            with open(file, "rb") as source:
                _LOADED[name] = content_id(source.read(), name, file)
            if not everywhere:  # otherwise it is loaded already
                _remove_doubtful_bytecode(file)
        except OSError:
            continue
        return


def _remove_doubtful_bytecode(file: str) -> None:
    """Remove the compiled code of a source file that may have changed since; Python makes it anew.

    The time of a change of status is looked at: nobody can set it, and renaming a file over another or
    dating it back renews it.
    """
    with contextlib.suppress(OSError, NotImplementedError):
        compiled = cache_from_source(file)
        if os.stat(compiled).st_ctime_ns - os.stat(file).st_ctime_ns < DOUBTFUL_NS:
            os.unlink(compiled)
