"""The commands ``myofilm store ...``. Only typer is imported here, as in ``cli``."""

from __future__ import annotations

from typing import Annotated

import typer

from workflows.options import StorePath

store_app = typer.Typer(
    no_args_is_help=True, rich_markup_mode=None, help="Look into the store of kept results."
)


@store_app.command("ls")
def store_ls(
    stage: Annotated[str | None, typer.Argument(help="Only this stage.")] = None,
    store: StorePath = None,
) -> None:
    """List what is kept."""
    from workflows.store_commands import list_artefacts

    list_artefacts(stage, store)


@store_app.command("show")
def store_show(
    key: Annotated[str, typer.Argument(help="Key of a result, or its first characters.")],
    store: StorePath = None,
) -> None:
    """Tell everything about one kept result: how it was asked for and how it came about."""
    from workflows.store_commands import show_artefact

    show_artefact(key, store)
