"""How a command goes about its work. Nothing here changes a result."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pipeline.executors import Executor
    from pipeline.store import Store
    from pipeline.store.labels import RunLabel


@dataclass(frozen=True)
class Way:
    """What a user may choose of any command that computes.

    Attributes
    ----------
    name
        Name of the run in the store; without one it goes by its output folder.
    recompute_damaged
        Whether damaged results are set aside and computed again, instead of ending the run.
    accept_code
        Whether results whose code alone is another are accepted instead of computing.
    workers, cluster
        Number of local processes that stages run in, or the scheduler whose workers they run on;
        without either they run in this process.
    quiet, verbose
        Whether to tell warnings and errors only, or every step of the solvers, too.
    """

    name: str | None = None
    recompute_damaged: bool = False
    accept_code: bool = False
    workers: int | None = None
    cluster: str | None = None
    quiet: bool = False
    verbose: bool = False

    @contextlib.contextmanager
    def executor(self, store: Store, label: RunLabel) -> Iterator[Executor | None]:
        """Where stages run for a command; ``None`` for this process.

        Raises
        ------
        InputError
            If there can be no such executor.
        """
        if self.workers is None and self.cluster is None:
            yield None
            return
        from pipeline.executors.opening import opened

        with opened(self.workers, self.cluster, store, label, _warn) as executor:
            yield None if executor.in_process else executor


def _warn(line: str) -> None:
    print(f"workers: {line}", file=sys.stderr, flush=True)


USUAL = Way()
"""What happens if nothing else is chosen."""
