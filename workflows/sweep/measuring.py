"""Numbers of one case, read where its results are and handed back in place of these."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

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
    """Reads the quantities of a case; picklable and small, since it goes where the stages run.

    Attributes
    ----------
    workflow
        Name of the workflow.
    common
        Tables that all cases have in common, as JSON.
    """

    workflow: str
    common: str

    def __call__(
        self, case: CaseSettings, outcomes: Mapping[str, Outcome]
    ) -> dict[str, dict[str, Any]]:
        """Fields of the quantities by name."""
        variants = _variants(self.workflow, self.common)
        experiment = Experiment(variants.load(case.settings), lambda stage: outcomes[stage].load())
        with reading(outcomes.values()):
            found = registry.find(self.workflow).quantities(experiment)
        return {name: dataclasses.asdict(quantity) for name, quantity in found.items()}


def quantities_of(fields: Mapping[str, Mapping[str, Any]]) -> dict[str, Quantity]:
    """The quantities made of these fields."""
    return {name: Quantity(**one) for name, one in fields.items()}


@lru_cache(maxsize=4)
def _variants(workflow: str, common: str) -> Variants[Any]:
    return Variants(registry.find(workflow).config, [json.loads(common)])
