"""What the command ``verification`` does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from workflows.commands import carry_out
from workflows.request import Request
from workflows.tables import aligned
from workflows.verification.catalogue import all_studies
from workflows.verification.experiment import verification
from workflows.ways import USUAL, Way


def list_studies() -> None:
    """One line for each study."""
    for line in aligned([(study.name, study.title) for study in all_studies().values()]):
        print(line)


def run_studies(
    names: Sequence[str],
    config: Path | None,
    overrides: Sequence[str],
    out: Path | None,
    store: str | None,
    way: Way = USUAL,
) -> None:
    """Compute some studies, write everything, and say where it is."""
    workflow = verification(names)
    request = replace(Request.read("verification", config, overrides), workflow=workflow)
    folder = out or Path("results/verification") / "+".join(workflow.measured)
    carry_out(request, folder, store, way)
