"""Many cases at once, node by node: what several cases need is computed once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from pipeline.computing.obtaining import Policy
from pipeline.events import Listener, ignore
from pipeline.executors import Executor, SerialExecutor
from pipeline.running.interrupts import deferred_interrupts
from pipeline.scheduling.cases import Case, CaseDone, CaseFailed, CaseResult
from pipeline.scheduling.schedule import Finish, Schedule
from pipeline.store import Store
from pipeline.store.labels import process_label

__all__ = ["Case", "CaseDone", "CaseFailed", "CaseResult", "Finish", "sweep"]


def sweep(
    cases: Iterable[Case],
    store: Store,
    executor: Executor | None = None,
    *,
    finish: Finish | None = None,
    listen: Listener = ignore,
    policy: Policy | None = None,
) -> Iterator[CaseResult]:
    """Compute what the cases need and the store does not hold; each case as it gets done.

    Parameters
    ----------
    cases
        Taken one by one as there is room for work.
    store
        Where results are kept; all processes of the executor must reach it.
    executor
        Where stages run; without one they run here, in the order of the cases.
    finish
        Called where stages run with ``case.about`` and the outcomes of a case, once they are all
        there, for something small and picklable to hand back. It must be importable there.
    listen
        Receives events, those of named cases inside a :class:`pipeline.events.CaseEvent`. A
        computation for several cases is told by the first of them, the others tell a hit.
    policy
        How results are obtained; without one in the usual way. What the cases use is registered
        under its label; the caller finishes that once all else is done.

    Raises
    ------
    Stopped
        If a signal asked to stop; running stages have saved a checkpoint then.
    MyofilmError
        If the executor cannot run anything any more. An error of a case is no reason to stop.
    """
    executor, policy = executor or SerialExecutor(), policy or Policy()
    label = policy.label or process_label()
    policy = replace(policy, label=label)
    # Where stages run here they defer signals themselves, and outside of one nothing must wait.
    with deferred_interrupts() as interrupts:
        interrupts.deferrable = not executor.in_process
        store.begin(label)
        yield from Schedule(iter(cases), store, executor, finish, listen, policy, interrupts)
