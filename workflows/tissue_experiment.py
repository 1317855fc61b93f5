"""What the configurations of all experiments with cells have in common."""

from __future__ import annotations

from typing import Any

from pydantic import model_validator

from stages.configuration import Section
from workflows.accuracy import with_picked_setting


class TissueExperiment(Section):
    """An experiment whose cells' mesh, steps and scheme may be picked by a preset or an accuracy."""

    @classmethod
    def completed(cls, data: Any) -> Any:
        """Tables with the picked fields filled in; a validated section of cells has them already."""
        return with_picked_setting(data)

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        return cls.completed(data)
