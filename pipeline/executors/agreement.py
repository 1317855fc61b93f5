"""What a process must have in common with the one that sends it work: code, libraries, store."""

from __future__ import annotations

import pkgutil
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from pipeline.fingerprint import Fingerprint, fingerprint
from pipeline.fingerprint.freshness import edited_modules
from pipeline.keys import ENGINE, PACKAGES
from pipeline.provenance import versions
from pipeline.store import Store
from pipeline.store.labels import RunLabel

PATIENCE = 15.0
"""Seconds in which what one machine wrote must be seen by another: network file systems cache."""

NAMED = 3
"""Modules that a message names."""


@dataclass(frozen=True)
class Findings:
    """What is wrong with a process: ``refusals`` make it unusable, ``warnings`` should be known."""

    refusals: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Agreement:
    """What holds in this process; sent to those that shall work for it.

    Attributes
    ----------
    code, modules
        Digest of all modules of the engine, the stages and the workflows, and of each one; without
        those a difference is found, but not where it is.
    versions
        Versions of Python and of the numerical libraries.
    store, label
        The store, and a run that is known there: who sees the run sees the same store.
    """

    code: str
    modules: Mapping[str, str]
    versions: Mapping[str, str]
    store: Store
    label: RunLabel

    @classmethod
    def here(cls, store: Store, label: RunLabel) -> Agreement:
        """That of this process.

        Raises
        ------
        InputError
            If the store may not be written to.
        """
        store.begin(label)
        code = whole_code()
        return cls(code.digest, code.modules, versions(), store, label)

    @property
    def brief(self) -> Agreement:
        """The same in a few hundred bytes."""
        return replace(self, modules={})

    def findings(self, patience: float = PATIENCE) -> Findings:
        """What does not hold in the process that calls this."""
        code = whole_code()
        refusals = [*self._other_code(code), *_stale(code)]
        if not refusals and not self._sees_store(patience):
            refusals.append(
                f"it does not see what was written to the store {self.store.location} here; choose a place with "
                "--store that all machines share"
            )
        others = [
            f"{name} {version} (here: {self.versions.get(name, 'absent')})"
            for name, version in versions().items()
            if self.versions.get(name) != version
        ]
        return Findings(tuple(refusals), (f"it has {', '.join(others)}",) if others else ())

    def _other_code(self, code: Fingerprint) -> Iterator[str]:
        if code.digest == self.code:
            return
        if not self.modules:
            yield "it has other code; install the same version there"
            return
        names = sorted({*self.modules, *code.modules})
        other = [name for name in names if self.modules.get(name) != code.modules.get(name)]
        yield f"it has other code: {_listed(other)} differ; install the same version there"

    def _sees_store(self, patience: float) -> bool:
        deadline = time.monotonic() + patience
        while True:
            if any(
                run.label.generation == self.label.generation for run in self.store.upkeep.runs()
            ):
                return True
            if time.monotonic() > deadline:
                return False
            time.sleep(0.5)


def whole_code() -> Fingerprint:
    """Fingerprint of all modules of the engine, the stages and the workflows, as the files are now."""
    packages = (ENGINE, *PACKAGES)
    names = (name for package in packages for name in _modules(package))
    return fingerprint(names, packages)


def _modules(package: str) -> Iterator[str]:
    import importlib.util

    spec = importlib.util.find_spec(package)
    folders = list((spec and spec.submodule_search_locations) or ())
    if spec is not None:
        yield package
    yield from _below(folders, package)


def _below(folders: list[str], package: str) -> Iterator[str]:
    for module in pkgutil.iter_modules(folders):
        name = f"{package}.{module.name}"
        yield name
        if module.ispkg:
            yield from _below([f"{folder}/{module.name}" for folder in folders], name)


def _stale(code: Fingerprint) -> Iterator[str]:
    edited = edited_modules(code)
    if edited:
        yield f"{_listed(edited)} were edited after it had loaded them; start it again"


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
