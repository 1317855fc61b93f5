"""Keys of results: what was asked, of which code, on which inputs.

The key of a result is the digest of its :class:`Statement`. An input enters by its *content*, so a
recomputed input that comes out the same changes nothing downstream. Paths, hosts, threads and
verbosity never enter.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pipeline.canonical import (
    Canonical,
    canonical,
    canonical_digest,
    is_structure,
    keyed_fields,
)
from pipeline.fingerprint import Fingerprint, fingerprint
from pipeline.fingerprint.sources import Sources

SCHEMA = 1
"""Version of the store's layout and of the meaning of a key; part of every key.

To be raised when a result in a store would no longer be what its key says, or could not be read:

- the engine hands a stage something else for the same statement: codecs, histories, resuming;
- the canonical form, the fingerprint or the statement leave out or merge what they told apart;
- the layout of the store, the manifest or the stored form of records changes.

Not for faster or clearer code of the engine, nor for edits to stages, which their fingerprint sees.
``tests/pipeline/test_pinned.py`` fails when keys or stored bytes change.
"""

PACKAGES = ("stages", "workflows")
"""Packages whose code counts; those of the stage and of its configuration always do."""

ENGINE = "pipeline"
"""The engine's code does not count: :data:`SCHEMA` stands for it."""


@dataclass(frozen=True)
class Ref:
    """Name of an artefact in a store."""

    stage: str
    key: str

    def __str__(self) -> str:
        return f"{self.stage}/{self.key}"


@dataclass(frozen=True)
class Statement:
    """All that a result depends on.

    Attributes
    ----------
    stage
        Name of the stage.
    config
        Canonical configuration, defaults filled in, unkeyed fields left out.
    code
        Fingerprint of the stage's code and of the models chosen in the configuration.
    inputs
        Content id of each input, by role.
    """

    stage: str
    config: Canonical
    code: Fingerprint
    inputs: Mapping[str, str]

    @cached_property
    def key(self) -> str:
        """Digest of the statement."""
        return key_of(self.stage, self.config, self.code.digest, self.inputs)

    @property
    def ref(self) -> Ref:
        """Name of the artefact that holds the result."""
        return Ref(self.stage, self.key)


def key_of(
    stage: str, config: Canonical, code: str, inputs: Mapping[str, str], schema: int = SCHEMA
) -> str:
    """Key of a result from the parts of its statement."""
    return canonical_digest(
        {"schema": schema, "stage": stage, "config": config, "code": code, "inputs": dict(inputs)}
    )


def statement(stage: str, config: Any, code: Fingerprint, inputs: Mapping[str, str]) -> Statement:
    """Statement of a stage, for a configuration, its code and the content ids of its inputs."""
    return Statement(stage, canonical(config), code, dict(inputs))


def code_of(module: str, config: Any, sources: Sources | None = None) -> Fingerprint:
    """Fingerprint of a stage's module and of the modules that define the models in its config.

    Without ``sources``, which hold files as they were read before, as the files are now.
    """
    roots = {module, *(m for m in config_modules(config) if m.partition(".")[0] != ENGINE)}
    return fingerprint(roots, _packages(roots), sources)


def config_modules(config: Any) -> Iterator[str]:
    """Modules that define the classes met in a configuration, unkeyed fields left out."""
    if is_structure(config):
        yield type(config).__module__
        for _, value, _ in keyed_fields(config):
            yield from config_modules(value)
    elif isinstance(config, Mapping):
        for value in config.values():
            yield from config_modules(value)
    elif isinstance(config, list | tuple):
        for value in config:
            yield from config_modules(value)


def _packages(roots: Collection[str]) -> set[str]:
    return {*PACKAGES, *(root.partition(".")[0] for root in roots)} - {ENGINE}
