"""Which state of its source file each module in memory was loaded from.

Python runs what it has read, whatever is saved afterwards. So the state of a file is noted when its
module is about to be loaded. Installed libraries are left out: their versions are recorded instead.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from importlib.machinery import PathFinder
from typing import Any, TypeAlias

State: TypeAlias = tuple[int, int]
"""Modification time in nanoseconds, and size, of a file."""

_LOADED: dict[str, State] = {}


def state(path: str | os.PathLike[str]) -> State:
    """Present state of a file."""
    status = os.stat(path)
    return status.st_mtime_ns, status.st_size


def loaded_state(name: str, path: os.PathLike[str]) -> State:
    """State from which a module in memory was loaded; the present one if nothing else is known."""
    return _LOADED.setdefault(name, state(path))


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


def _note(name: str, files: Iterable[str]) -> None:
    """Note the state of the first of some files that exists."""
    if name.partition(".")[0] in sys.stdlib_module_names and name != "__main__":
        return
    for file in files:
        if f"-packages{os.sep}" in file or not file.endswith(".py"):
            return
        try:
            _LOADED[name] = state(file)
        except OSError:
            continue
        return
