"""What ``store verify`` does."""

from __future__ import annotations

import time
from collections.abc import Sequence

from pipeline.errors import StoreError
from pipeline.store import Store
from workflows.progress import on_terminal, size
from workflows.request import open_store
from workflows.upkeep.amounts import ago
from workflows.upkeep.names import SHORT, artefact


def verify_artefacts(keys: Sequence[str], location: str | None, *, quick: bool = False) -> None:
    """Check all results or some, and tell of work that is only half done.

    Parameters
    ----------
    keys
        First characters of keys; without any, all that there is.
    location
        Store.
    quick
        Look at the sizes of files only, not at what is in them.

    Raises
    ------
    InputError
        If a key is not of one result only.
    StoreError
        If a result is damaged, after all have been checked.
    """
    store = open_store(location)
    refs = [artefact(store, key) for key in keys] if keys else list(store.refs())
    damaged = 0
    for number, ref in enumerate(refs):
        if on_terminal():
            print(f"{number} of {len(refs)} checked", end="\r", flush=True)
        problems = store.verify(ref, full=not quick)
        if problems and (ref in set(store.refs(ref.stage))):
            damaged += 1
            for problem in problems:
                print(f"{ref}: {problem}", flush=True)
    what = "sizes of the files" if quick else "checksums and keys"
    print(f"{len(refs)} results checked ({what}), {damaged} damaged in {store.location}")
    if not keys:
        _tell_leftovers(store)
    if damaged:
        raise StoreError(
            f"{damaged} of {len(refs)} results are damaged",
            remedy="run the command that needs them with --recompute-damaged: it sets them aside and "
            "computes them again; or remove them with `myofilm store rm KEY`",
        )


def _tell_leftovers(store: Store) -> None:
    now = time.time()
    for leftover in store.upkeep.leftovers():
        if leftover.damaged:
            state = "set aside as damaged; gc removes it in time"
        elif leftover.busy:
            state = "being computed"
        elif leftover.resumable:
            state = "interrupted; a run that needs it goes on from its checkpoint"
        else:
            state = "given up; a run that needs it begins anew"
        print(
            f"left over: {leftover.key[:SHORT]}, {size(leftover.size)}, changed "
            f"{ago(now - leftover.changed)} ago: {state}"
        )
