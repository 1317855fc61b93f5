"""Verification (Appendices B and C, and more): every study is a stage of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import create_model

from stages.configuration import Section
from workflows.experiment import Experiment
from workflows.verification.catalogue import all_studies, find
from workflows.verification.study import Study
from workflows.workflow import Export, Quantity, Workflow

if TYPE_CHECKING:
    from pipeline.nodes import Node


def verification(names: Sequence[str] = ()) -> Workflow:
    """The workflow of some studies, or of all.

    Raises
    ------
    InputError
        If there is no study of a name.
    """
    chosen = [find(name) for name in dict.fromkeys(names)] or list(all_studies().values())

    def plan(config: Any) -> Mapping[str, Node[Any]]:
        return {study.name: study.stage(getattr(config, study.section)) for study in chosen}

    def quantities(experiment: Experiment) -> dict[str, Quantity]:
        return {
            f"{study.name}.{name}": quantity
            for study in chosen
            for name, quantity in study.quantities(experiment.load(study.name)).items()
        }

    return Workflow(
        name="verification",
        title="Verification: the solvers against closed forms and published values",
        modules=(__name__, *(study.module for study in chosen)),
        config=_config_of(all_studies()),
        plan=plan,
        quantities=quantities,
        measured=tuple(study.name for study in chosen),
        exports=tuple(export for study in chosen for export in _exports(study)),
    )


def _config_of(studies: Mapping[str, Study]) -> type[Section]:
    """One section per study."""
    fields: dict[str, Any] = {study.section: (study.config, ...) for study in studies.values()}
    return create_model("VerificationConfig", __base__=Section, **fields)


def _exports(study: Study) -> tuple[Export, Export]:
    return (
        Export(
            files=(f"{study.name}.png", f"{study.name}.svg"),
            modules=("workflows.verification.pictures", study.module),
            stages=(study.name,),
            kind="picture",
            caption=study.title,
            arguments=(study.name,),
        ),
        Export(
            files=(f"{study.name}.csv",),
            modules=("workflows.verification.tables",),
            stages=(study.name,),
            kind="data",
            caption=f"Table of the study {study.name}.",
            arguments=(study.name,),
        ),
    )


WORKFLOW = verification()
