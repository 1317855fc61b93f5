"""The label of a command, under which the store keeps what its results are made of."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.canonical import canonical, digest
from pipeline.store.labels import RunLabel

if TYPE_CHECKING:
    from pipeline.store import Store
    from workflows.request import Request


def label_of(
    name: str | None, folder: Path, workflow: str, requests: Iterable[Request]
) -> RunLabel:
    """Label of a command that writes to a folder, under the name that ``--name`` gives it.

    Raises
    ------
    InputError
        If no run can be called so.
    """
    config = digest([canonical(request.config) for request in requests])
    return RunLabel.of(name, folder, workflow, config)


@contextlib.contextmanager
def registered(store: Store, label: RunLabel) -> Iterator[RunLabel]:
    """Do the block as a run that the store knows; it ended well if the block does.

    What an earlier run of this name used is kept until then.
    """
    store.begin(label)
    yield label
    store.finish(label)
