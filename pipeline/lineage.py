"""What artefacts were made from: the manifests upstream of them, and who read what of whom."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from pipeline.errors import StoreError
from pipeline.keys import Ref
from pipeline.manifest import InputEntry, Manifest
from pipeline.store.protocol import Store


@dataclass(frozen=True)
class Use:
    """An artefact, or the named parts of it, read by another; ``roles`` as the reader calls them."""

    source: Ref
    reader: Ref
    roles: tuple[str, ...]
    parts: tuple[str, ...]


@dataclass(frozen=True)
class Lineage:
    """Artefacts with everything upstream of them.

    Attributes
    ----------
    roots
        The artefacts asked for.
    manifests
        Of these and of all upstream, each after all that it was made from. ``None`` for an artefact
        that its store holds no longer.
    problems
        What is wrong with those that are damaged, in words.
    uses
        Who read what.
    """

    roots: tuple[Ref, ...]
    manifests: Mapping[Ref, Manifest | None]
    problems: Mapping[Ref, str]
    uses: tuple[Use, ...]

    @property
    def kept(self) -> tuple[Manifest, ...]:
        """The manifests that there are."""
        return tuple(manifest for manifest in self.manifests.values() if manifest is not None)

    @property
    def size(self) -> int:
        """Bytes of all data files."""
        return sum(manifest.size for manifest in self.kept)

    def sources(self, reader: Ref) -> tuple[Use, ...]:
        """What an artefact was made from, what was made first first."""
        return self._by_reader.get(reader, ())

    @cached_property
    def _by_reader(self) -> dict[Ref, tuple[Use, ...]]:
        place = {ref: i for i, ref in enumerate(self.manifests)}
        found: dict[Ref, tuple[Use, ...]] = {}
        for use in sorted(self.uses, key=lambda use: place[use.source]):
            found[use.reader] = (*found.get(use.reader, ()), use)
        return found

    @property
    def ends(self) -> tuple[Ref, ...]:
        """Artefacts that no other one here was made from."""
        read = {use.source for use in self.uses}
        return tuple(ref for ref in self.manifests if ref not in read)


def lineage(store: Store, roots: Iterable[Ref]) -> Lineage:
    """Everything upstream of some artefacts of a store.

    An input counts by its content. Where one of the roots holds just what was read, it is taken for
    the source, though another artefact with that content may have been read at the time: the stages
    of a run hang together even where some were found in the store.

    Parameters
    ----------
    store
        Where the manifests are.
    roots
        Artefacts; one that is missing is listed as such.
    """
    asked = tuple(dict.fromkeys(roots))
    search = _Search(store, asked)
    for ref in asked:
        search.visit(ref)
    return Lineage(asked, search.ordered, search.problems, tuple(search.uses))


class _Search:
    """Depth-first search upstream, manifests read once."""

    def __init__(self, store: Store, asked: Iterable[Ref]) -> None:
        self._store = store
        self.asked = set(asked)
        self.found: dict[Ref, Manifest | None] = {}
        self.ordered: dict[Ref, Manifest | None] = {}
        self.problems: dict[Ref, str] = {}
        self.uses: list[Use] = []
        self._seen: set[Ref] = set()
        self._held: dict[tuple[str, str | None, str], Ref] = {}
        for ref in asked:
            if (manifest := self.read(ref)) is not None:
                for part, content in (None, manifest.content), *manifest.parts.items():
                    self._held.setdefault((ref.stage, part, content), ref)

    def read(self, ref: Ref) -> Manifest | None:
        if ref not in self.found:
            try:
                self.found[ref] = self._store.find(ref)
            except StoreError as error:
                self.problems[ref] = error.cause
                self.found[ref] = self._despite_damage(ref)
        return self.found[ref]

    def visit(self, ref: Ref) -> None:
        if ref in self._seen:
            return
        self._seen.add(ref)
        manifest = self.read(ref)
        if manifest is not None:
            sources: dict[Ref, dict[str, InputEntry]] = {}
            for role, entry in manifest.inputs.items():
                sources.setdefault(self._source(entry), {})[role] = entry
            for source, entries in sources.items():
                self.visit(source)
                parts = dict.fromkeys(entry.part for entry in entries.values() if entry.part)
                self.uses.append(Use(source, ref, tuple(entries), tuple(parts)))
        self.ordered[ref] = manifest

    def _source(self, entry: InputEntry) -> Ref:
        named = Ref(entry.stage, entry.key)
        if named in self.asked:
            return named
        return self._held.get((entry.stage, entry.part, entry.content), named)

    def _despite_damage(self, ref: Ref) -> Manifest | None:
        try:
            return self._store.manifest(ref)
        except StoreError:
            return None
