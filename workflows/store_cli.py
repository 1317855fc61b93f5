"""The commands ``myofilm store ...``. Only typer is imported here, as in ``cli``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from workflows.options import StorePath, path_given

store_app = typer.Typer(
    no_args_is_help=True, rich_markup_mode=None, help="Look into the store of kept results."
)

Unused = Annotated[
    str | None,
    typer.Option("--older-than", metavar="TIME", help="Not used for so long, as 30d or 12h."),
]


@store_app.command("ls")
def store_ls(
    stage: Annotated[str | None, typer.Argument(help="Only this stage.")] = None,
    sort: Annotated[
        str,
        typer.Option(metavar="ORDER", help="stage, size, age, use, or worth (seconds per byte)."),
    ] = "stage",
    run: Annotated[
        str | None, typer.Option(metavar="NAME", help="Only what this run or folder used.")
    ] = None,
    tag: Annotated[str | None, typer.Option(metavar="TAG", help="Only with this tag.")] = None,
    older_than: Unused = None,
    unreachable: Annotated[
        bool, typer.Option("--unreachable", help="Only what no run and no tag keeps.")
    ] = False,
    store: StorePath = None,
) -> None:
    """List what is kept."""
    from workflows.upkeep.listing import Choice, list_artefacts

    list_artefacts(store, Choice(stage, run, tag, older_than, unreachable), sort)


@store_app.command("show")
def store_show(
    name: Annotated[
        str,
        typer.Argument(
            metavar="KEY|RUN", help="Key of a result or its first characters, or name of a run."
        ),
    ],
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE.svg", help="Draw what it was made from.", parser=path_given),
    ] = None,
    store: StorePath = None,
) -> None:
    """Tell everything about a result or a run: what it was made from, and how all of it was made."""
    from workflows.provenance.show import show

    show(name, store, picture)


@store_app.command("export")
def store_export(
    name: Annotated[
        str,
        typer.Argument(metavar="RUN|KEY", help="Name or output folder of a run, or a key."),
    ],
    file: Annotated[Path, typer.Argument(metavar="FILE.tar", help="File to be made.")],
    store: StorePath = None,
) -> None:
    """Write the results of a run to one file, for a colleague."""
    from workflows.provenance.archives import export_archive

    export_archive(name, file, store)


@store_app.command("import")
def store_import(
    file: Annotated[Path, typer.Argument(metavar="FILE.tar", help="What `store export` made.")],
    name: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Name that keeps them.  [default: as exported, or FILE]"),
    ] = None,
    store: StorePath = None,
) -> None:
    """Take in what a colleague exported; all of it is checked before."""
    from workflows.provenance.archives import import_archive

    import_archive(file, name, store)


@store_app.command("runs")
def store_runs(store: StorePath = None) -> None:
    """List the runs whose results are kept, and why they are."""
    from workflows.upkeep.listing import list_runs

    list_runs(store)


@store_app.command("verify")
def store_verify(
    keys: Annotated[
        list[str] | None, typer.Argument(metavar="[KEY]...", help="Without one: all results.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Compare sizes of files only, not their checksums.")
    ] = False,
    store: StorePath = None,
) -> None:
    """Check that kept results are whole and unchanged; exit code 1 if one is not."""
    from workflows.upkeep.checking import verify_artefacts

    verify_artefacts(keys or [], store, quick=quick)


@store_app.command("gc")
def store_gc(
    older_than: Unused = None,
    max_size: Annotated[
        str | None,
        typer.Option(
            "--max-size",
            metavar="SIZE",
            help="As many as it takes for the store to be so small, as 10GB: first those that save "
            "the fewest seconds per byte.",
        ),
    ] = None,
    unreachable: Annotated[
        bool, typer.Option("--unreachable", help="All that no run and no tag keeps.")
    ] = False,
    yes: Annotated[
        bool, typer.Option("--yes", help="Remove them; without it, only tell what would go.")
    ] = False,
    store: StorePath = None,
) -> None:
    """Remove results that no run and no tag keeps, and unfinished work that nobody goes on from.

    Each option is a reason to go. What runs use is kept: those with a name, those whose output folder
    is there, and those that go on.
    """
    from workflows.upkeep.cleaning import collect_garbage

    collect_garbage(store, older_than, max_size, unreachable=unreachable, yes=yes)


@store_app.command("rm")
def store_rm(
    names: Annotated[
        list[str],
        typer.Argument(metavar="NAME...", help="Keys of results, or names of runs."),
    ],
    store: StorePath = None,
) -> None:
    """Remove single results, or forget runs, so that gc may take what only they kept."""
    from workflows.upkeep.cleaning import remove_named

    remove_named(names, store)


@store_app.command("tag")
def store_tag(
    key: Annotated[str, typer.Argument(help="Key of a result, or its first characters.")],
    tag: Annotated[str, typer.Argument(help="A word.")],
    remove: Annotated[bool, typer.Option("--remove", help="Take the tag away.")] = False,
    store: StorePath = None,
) -> None:
    """Tag a result: it is kept, with all that it was computed from, until the tag is taken away."""
    from workflows.upkeep.cleaning import change_tag

    change_tag(key, tag, store, remove=remove)
