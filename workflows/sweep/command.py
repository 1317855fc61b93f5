"""What the command ``myofilm sweep`` does."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from pipeline.store.labels import RunLabel
from workflows.labels import registered
from workflows.request import open_store, output_folder
from workflows.sweep.asked import Asked
from workflows.sweep.forecast import Forecast
from workflows.sweep.sampling import is_balanced, parse_sample
from workflows.sweep.study import Study
from workflows.sweep.telling import tell_forecast, tell_results
from workflows.ways import USUAL, Way


def plan_sweep(
    workflow: str, config: Path | None, overrides: Sequence[str], asked: Asked, store: str | None
) -> None:
    """Tell what a sweep would compute and at what cost; compute nothing."""
    study = Study.read(workflow, config, overrides, asked)
    forecast = Forecast(open_store(store)).add_all(nodes for _, nodes in study.checked())
    _advise(asked)
    tell_forecast(study, forecast)


def run_sweep(
    workflow: str,
    config: Path | None,
    overrides: Sequence[str],
    asked: Asked,
    out: Path,
    store: str | None,
    way: Way = USUAL,
    *,
    retry_failed: bool = False,
    each: bool = False,
) -> None:
    """Compute all cases that have not failed before, and write what came out.

    Raises
    ------
    FailedCasesError
        If cases failed, now or before; everything has been written then.
    """
    from workflows.sweep.running import FailedCasesError, Sweep

    study = Study.read(workflow, config, overrides, asked)
    kept = open_store(store)
    forecast = Forecast(kept).add_all(nodes for _, nodes in study.checked())
    _advise(asked)
    folder = output_folder(out)
    label = RunLabel.of(way.name, folder, workflow, study.id)
    options = {"retry_failed": retry_failed, "each": each}
    with (
        registered(kept, label),
        way.executor(kept, label) as executor,
        Sweep(study, kept, folder, label, way, **options) as sweep,
    ):
        results = sweep.run(forecast, executor)
    if not way.quiet:
        tell_results(results, folder)
    if results.errors:
        raise FailedCasesError(results, sweep.earlier, folder)


def _advise(asked: Asked) -> None:
    if asked.sample is not None and not is_balanced(*parse_sample(asked.sample)):
        print(
            f"--sample {asked.sample}: a Sobol sequence is evenly spread for powers of two only, such "
            "as 64, 128, 256",
            file=sys.stderr,
        )
