"""Studies with the parameters that ship, changed where a test wants less."""

from __future__ import annotations

from typing import Any

from pipeline.threads import one_blas_thread
from stages.artefacts import StudyTable
from workflows.request import Request
from workflows.verification.catalogue import find


def table_of(name: str, *settings: str) -> StudyTable:
    """Table of a study, computed in memory; settings are ``key=value``."""
    study = find(name)
    overrides = [f"{study.section}.{setting}" for setting in settings]
    config: Any = Request.read("verification", overrides=overrides).config
    with one_blas_thread():  # as in a run
        return study.stage.compute(getattr(config, study.section))


def broken_limits(name: str, table: StudyTable) -> list[str]:
    """Quantities of a study that exceed their limits."""
    return [key for key, found in find(name).quantities(table).items() if not found.is_allowed]
