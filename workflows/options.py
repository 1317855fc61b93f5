"""Options that several commands have in common. Only typer is imported here, as in ``cli``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def path_given(text: str | Path) -> Path:
    """A path; an empty one would mean the current folder, and be an unset shell variable."""
    if text == "":
        raise typer.BadParameter("it is empty; give a path, or leave the option out")
    return Path(text)


def location_given(text: str) -> str:
    """A folder or a URL; not empty, for the same reason."""
    return str(path_given(text)) if "://" not in text else text


Name = Annotated[str, typer.Argument(metavar="WORKFLOW", help="See `myofilm list`.")]
Config = Annotated[
    Path | None,
    typer.Option(
        "--config", metavar="FILE.toml", parser=path_given, help="Parameters over the paper's."
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="SECTION.KEY=VALUE",
        help="One parameter over all others; may be given several times. A text may carry a unit: "
        'geometry.substrate_thickness="18 um".',
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="DIR",
        parser=path_given,
        help="Output folder.  [default: results/WORKFLOW; of one stage results/WORKFLOW/STAGE]",
    ),
]
RunName = Annotated[
    str | None,
    typer.Option(
        "--name",
        metavar="NAME",
        help="Name under which the store keeps the results of this run until `myofilm store rm NAME`. "
        "Without it they are kept while the output folder is there.",
    ),
]
StorePath = Annotated[
    str | None,
    typer.Option(
        "--store",
        metavar="DIR|URL",
        parser=location_given,
        envvar="MYOFILM_STORE",
        help="Where results are kept: a folder, or a URL such as s3://bucket/prefix.  "
        "[default: the user's cache folder]",
    ),
]
RecomputeDamaged = Annotated[
    bool,
    typer.Option(
        "--recompute-damaged",
        help="Check every byte of the kept results that are needed; set damaged ones aside in the "
        "store and compute them again.",
    ),
]
AcceptCode = Annotated[
    bool,
    typer.Option(
        "--accept-code",
        help="Accept kept results whose parameters and inputs are equal and whose code alone is another: "
        "after an edit that changes no result.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(
        "--workers",
        metavar="N",
        min=1,
        help="Compute in N processes on this machine.  [default: in this process alone]",
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        metavar="ADDRESS",
        help="Compute on the workers of a running dask scheduler, such as tcp://10.0.0.1:8786, or the file "
        "in which it tells its address; the store "
        "must be one that they all reach.",
    ),
]
