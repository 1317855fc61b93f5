"""The command ``myofilm sweep``. Only typer is imported here, as in ``workflows.cli``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from workflows.options import (
    AcceptCode,
    Cluster,
    Config,
    Name,
    RecomputeDamaged,
    RunName,
    Settings,
    StorePath,
    Workers,
    path_given,
)


def sweep(
    ctx: typer.Context,
    workflow: Name,
    over: Annotated[
        list[str] | None,
        typer.Option(
            "--over",
            metavar="SECTION.KEY=VALUES",
            help="Values of one parameter: V1,V2,..., FIRST:LAST:STEP or FIRST:LAST:#COUNT; with "
            "--sample LOW..HIGH. Given several times: every combination.",
        ),
    ] = None,
    together: Annotated[
        list[str] | None,
        typer.Option(
            "--zip",
            metavar="SECTION.KEY=VALUES",
            help="Parameters that change together: the first values make one case, the second ones "
            "another.",
        ),
    ] = None,
    cases: Annotated[
        Path | None,
        typer.Option(
            "--cases",
            metavar="FILE.csv",
            parser=path_given,
            help="A row per case, a column per parameter.",
        ),
    ] = None,
    sample: Annotated[
        str | None,
        typer.Option(
            "--sample",
            metavar="lhs:N|sobol:N",
            help="N samples between the LOW..HIGH of --over: Latin hypercube or Sobol sequence.",
        ),
    ] = None,
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Of the samples; the same seed, the same samples.")
    ] = 0,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Tell what would be computed; compute nothing.")
    ] = False,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="Try cases again that failed before.")
    ] = False,
    each: Annotated[
        bool,
        typer.Option("--each", help="Write report, pictures and data of every case, too."),
    ] = False,
    config: Config = None,
    settings: Settings = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            parser=path_given,
            help="Output folder.  [default: results/sweep/WORKFLOW]",
        ),
    ] = None,
    name: RunName = None,
    store: StorePath = None,
    recompute_damaged: RecomputeDamaged = False,
    accept_code: AcceptCode = False,
    workers: Workers = None,
    cluster: Cluster = None,
) -> None:
    """Run an experiment for many values of its parameters."""
    from workflows.sweep.asked import Asked
    from workflows.sweep.command import plan_sweep, run_sweep
    from workflows.ways import Way

    asked = Asked(over or (), together or (), cases, sample, seed)
    if dry_run:
        plan_sweep(workflow, config, settings or [], asked, store)
    else:
        run_sweep(
            workflow,
            config,
            settings or [],
            asked,
            out or Path("results/sweep") / workflow,
            store,
            Way(name, recompute_damaged, accept_code, workers, cluster, **ctx.obj),
            retry_failed=retry_failed,
            each=each,
        )
