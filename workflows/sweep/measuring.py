"""Numbers of one case, and what its stages warned of, read where its results are and handed back instead."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

from pipeline.config.variants import Variants
from workflows import registry
from workflows.experiment import Experiment
from workflows.exports.outputs import reading
from workflows.sweep.design import CaseSettings
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from pipeline.scheduling.outcome import Outcome


@dataclass(frozen=True)
class Measure:
    """Reads what a case gave; picklable and small, since it goes where the stages run.

    Attributes
    ----------
    workflow
        Name of the workflow.
    common
        Tables that all cases have in common, as JSON.
    """

    workflow: str
    common: str

    def __call__(self, case: CaseSettings, outcomes: Mapping[str, Outcome]) -> Measured:
        """The quantities and the warnings of a case."""
        variants = _variants(self.workflow, self.common)
        experiment = Experiment(variants.load(case.settings), lambda stage: outcomes[stage].load())
        with reading(outcomes.values()):
            found = registry.find(self.workflow).quantities(experiment)
        warnings = tuple(
            f"{name}: {text}"
            for name, outcome in outcomes.items()
            for text in outcome.manifest.warnings
        )
        fields = {name: dataclasses.asdict(quantity) for name, quantity in found.items()}
        return Measured(fields, warnings)


class Measured(NamedTuple):
    """What comes back of a case.

    Attributes
    ----------
    fields
        Those of the quantities, by name.
    warnings
        What its stages warned of, whenever they were computed.
    """

    fields: Mapping[str, Mapping[str, Any]]
    warnings: tuple[str, ...]

    def quantities(self) -> dict[str, Quantity]:
        """The quantities made of the fields."""
        return {name: Quantity(**one) for name, one in self.fields.items()}


@lru_cache(maxsize=4)
def _variants(workflow: str, common: str) -> Variants[Any]:
    return Variants(registry.find(workflow).config, [json.loads(common)])
