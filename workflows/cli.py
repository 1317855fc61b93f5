"""Command line. Only typer is imported here; each command imports what it needs when it runs."""

from __future__ import annotations

import contextlib
import traceback
from pathlib import Path
from typing import Annotated, Any

import typer
import typer.core

from workflows.options import (
    AcceptCode,
    Cluster,
    Config,
    Name,
    Out,
    RecomputeDamaged,
    RunName,
    Settings,
    StorePath,
    Workers,
    path_given,
)
from workflows.startup import start
from workflows.store_cli import store_app
from workflows.sweep.cli import sweep


class Commands(typer.core.TyperGroup):
    """Commands whose errors end as one message and an exit code.

    ``--quiet``, ``--verbose`` and ``--traceback`` may stand anywhere on the line.
    """

    anywhere = ("--quiet", "--verbose", "--traceback")

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Move the flags that may stand anywhere to the front."""
        end = args.index("--") if "--" in args else len(args)
        flags = [arg for arg in args[:end] if arg in self.anywhere]
        rest = [arg for arg in args[:end] if arg not in self.anywhere] + args[end:]
        return super().parse_args(ctx, flags + rest)

    def invoke(self, ctx: Any) -> Any:
        """Run the command: 2 for bad input, 1 for a failed stage, 130, 143, 129 when stopped."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stop:
            say = "stopped; finished stages are kept, and the same command goes on from there"
            with contextlib.suppress(OSError):  # the terminal may be gone
                typer.echo(say, err=True)
            raise typer.Exit(getattr(stop, "exit_code", 130)) from None
        except (typer.Exit, typer.Abort, BrokenPipeError):
            raise
        except Exception as error:
            if type(error).__module__.partition(".")[0] in ("typer", "click"):
                raise
            if ctx.params.get("show_traceback"):
                traceback.print_exception(error)
            message, code = _told(error)
            typer.echo(f"Error: {message}", err=True)
            raise typer.Exit(code) from None


def _told(error: Exception) -> tuple[str, int]:
    """Message and exit code of an error; a mistake of ours is said to be one."""
    from pipeline.errors import MyofilmError

    if isinstance(error, MyofilmError):
        return str(error), error.exit_code
    if isinstance(error, OSError) and error.strerror:
        where = f": {error.filename}" if error.filename else ""
        return f"{error.strerror.lower()}{where}. Results computed so far are kept.", 1
    kind = type(error).__name__
    return f"unexpected {kind}: {error}\nRun again with --traceback to see where.", 1


app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Simulate muscular thin films: electrical waves, contraction, bending. Results are kept in "
    "a store and never computed twice.",
)
app.add_typer(store_app, name="store")


@app.callback()
def flags(
    ctx: typer.Context,
    quiet: Annotated[bool, typer.Option("--quiet", help="Tell warnings and errors only.")] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="Tell every step of the solvers, too.")
    ] = False,
    show_traceback: Annotated[
        bool, typer.Option("--traceback", help="Show where in the program an error arose.")
    ] = False,
) -> None:
    """Flags of all commands."""
    if quiet and verbose:
        raise typer.BadParameter("--quiet and --verbose contradict each other; give one of them")
    ctx.obj = {"quiet": quiet, "verbose": verbose}


@app.command()
def run(
    ctx: typer.Context,
    workflow: Name,
    config: Config = None,
    settings: Settings = None,
    out: Out = None,
    store: StorePath = None,
    name: RunName = None,
    recompute_damaged: RecomputeDamaged = False,
    workers: Workers = None,
    cluster: Cluster = None,
    accept_code: AcceptCode = False,
) -> None:
    """Run an experiment: report, pictures, data."""
    from workflows.commands import run_workflow
    from workflows.ways import Way

    run_workflow(
        workflow,
        config,
        settings or [],
        out,
        store,
        Way(name, recompute_damaged, accept_code, workers, cluster, **ctx.obj),
    )


app.command("sweep")(sweep)


def _stage_command(stage: str) -> None:
    """Add the command that computes one stage and what it needs."""

    def command(
        ctx: typer.Context,
        workflow: Name,
        config: Config = None,
        settings: Settings = None,
        out: Out = None,
        store: StorePath = None,
        name: RunName = None,
        recompute_damaged: RecomputeDamaged = False,
        workers: Workers = None,
        cluster: Cluster = None,
        accept_code: AcceptCode = False,
    ) -> None:
        from workflows.commands import run_stage
        from workflows.ways import Way

        run_stage(
            stage,
            workflow,
            config,
            settings or [],
            out,
            store,
            Way(name, recompute_damaged, accept_code, workers, cluster, **ctx.obj),
        )

    app.command(stage, help=f"Compute {stage} and what it needs.")(command)


for _stage in ("geometry", "electrophysiology", "activation", "mechanics", "postprocessing"):
    _stage_command(_stage)


@app.command()
def explain(
    workflow: Name,
    config: Config = None,
    settings: Settings = None,
    store: StorePath = None,
    accept_code: AcceptCode = False,
) -> None:
    """Tell which stages would be computed, and why."""
    from workflows.explanation import explain_workflow

    explain_workflow(workflow, config, settings or [], store, accept_code=accept_code)


@app.command("list")
def list_workflows() -> None:
    """List the workflows."""
    from workflows.commands import list_all

    list_all()


@app.command()
def show(workflow: Name, config: Config = None, settings: Settings = None) -> None:
    """Show every parameter of a workflow."""
    from workflows.commands import show_parameters

    show_parameters(workflow, config, settings or [])


@app.command()
def verification(
    ctx: typer.Context,
    studies: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="Without one: what there is.")
    ] = None,
    config: Config = None,
    settings: Settings = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            parser=path_given,
            help="Output folder.  [default: results/verification/NAME]",
        ),
    ] = None,
    store: StorePath = None,
    name: RunName = None,
    recompute_damaged: RecomputeDamaged = False,
    workers: Workers = None,
    cluster: Cluster = None,
) -> None:
    """Compare the solvers with closed forms and published values, study by study."""
    from workflows.verification.commands import list_studies, run_studies
    from workflows.ways import Way

    if studies:
        run_studies(
            studies,
            config,
            settings or [],
            out,
            store,
            Way(name, recompute_damaged, False, workers, cluster, **ctx.obj),
        )
    else:
        list_studies()


@app.command()
def reproduce(
    ctx: typer.Context,
    figure: Annotated[
        str | None, typer.Argument(metavar="[FIGURE]", help="Without it: what can be drawn.")
    ] = None,
    config: Config = None,
    settings: Settings = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            parser=path_given,
            help="Output folder.  [default: results/reproduce/FIGURE]",
        ),
    ] = None,
    store: StorePath = None,
    name: RunName = None,
    recompute_damaged: RecomputeDamaged = False,
    workers: Workers = None,
    cluster: Cluster = None,
) -> None:
    """Draw a figure of the paper."""
    from workflows.reproduce import draw, list_figures
    from workflows.ways import Way

    if figure is None:
        list_figures()
    else:
        draw(
            figure,
            config,
            settings or [],
            out,
            store,
            Way(name, recompute_damaged, False, workers, cluster, **ctx.obj),
        )


def main() -> None:
    """Entry point of the command ``myofilm``."""
    start()
    app(prog_name="myofilm")


if __name__ == "__main__":
    main()
