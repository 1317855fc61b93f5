"""What ``explain`` tells: which stages would be computed, why, and at what cost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows.naming import Naming
from workflows.progress import duration, size
from workflows.request import Request, open_store

if TYPE_CHECKING:
    from pipeline.plan import Forecast, Verdict
    from pipeline.plan.reasons import CodeChanged

NAMED = 4
"""Edited modules that are named; a new version changes dozens."""


def explain_workflow(
    name: str,
    config: Path | None,
    overrides: Sequence[str],
    store: str | None,
    *,
    accept_code: bool = False,
) -> None:
    """Tell which stages would be computed, why, and at what cost."""
    from pipeline.nodes import in_order
    from pipeline.plan import explain
    from workflows.accuracy import picked

    request = Request.read(name, config, overrides)
    if (numbers := picked(request.config)) is not None:
        print(f"{'electrophysiology:':20}{numbers}")
    nodes = request.nodes()
    seen = {node_name: node.config for node_name, node in in_order(nodes)}
    for verdict in explain(nodes, open_store(store), accept_code=accept_code):
        print(f"{verdict.node + ':':20}{_judged(verdict)}")
        for line in _details(verdict, request.config, seen[verdict.node]):
            print(f"{'':20}- {line}")


def _judged(verdict: Verdict) -> str:
    from pipeline.plan import Acceptable, Damaged, Hit, Missing, Pending

    if isinstance(verdict, Hit):
        return "hit"
    if isinstance(verdict, Acceptable):
        return f"a result of other code is accepted: {verdict.manifest.key}"
    if isinstance(verdict, Damaged):
        return "damaged: run with --recompute-damaged to compute it again"
    if isinstance(verdict, Missing):
        return "miss: the store holds no result of this stage yet"
    cost = _cost(verdict.forecast)
    if isinstance(verdict, Pending):
        after = ", ".join(verdict.waits_for)
        return f"depends on {after}: a hit if what that gives is the same as before ({cost})"
    return f"miss ({cost})"


def _cost(forecast: Forecast) -> str:
    return f"a similar run took {duration(forecast.seconds)} and {size(forecast.size)}"


def _details(verdict: Verdict, config: Any, seen: Any) -> Iterator[str]:
    """Reasons in the user's names, then what else is worth knowing."""
    from pipeline.plan import Acceptable, Changed, Damaged, Hit, Missing
    from pipeline.plan.reasons import CodeChanged, ConfigChanged

    if isinstance(verdict, Hit | Acceptable) and verdict.versions:
        yield f"warning: it was computed with {', '.join(verdict.versions)}"
    if isinstance(verdict, Acceptable):
        yield from _edits(verdict.changes)
    if isinstance(verdict, Damaged):
        yield from verdict.problems
    if isinstance(verdict, Changed):
        naming = Naming(config, seen)
        for reason in verdict.reasons:
            if isinstance(reason, ConfigChanged):
                yield str(reason.named(naming(reason.field, reason.now)))
            elif not isinstance(reason, CodeChanged):
                yield str(reason)
        yield from _edits([one for one in verdict.reasons if isinstance(one, CodeChanged)])
    if isinstance(verdict, Changed | Missing) and verdict.resume is not None:
        yield str(verdict.resume)


def _edits(changes: Sequence[CodeChanged]) -> Iterator[str]:
    yield from map(str, changes[:NAMED])
    if len(changes) > NAMED:
        yield f"{len(changes) - NAMED} more modules changed"
