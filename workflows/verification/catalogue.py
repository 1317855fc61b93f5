"""The studies on offer: one for each file in the folder ``studies``."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from workflows.verification import studies
from workflows.verification.study import Study


@cache
def all_studies() -> dict[str, Study]:
    """Studies by name, in alphabetical order."""
    names = sorted(module.name for module in pkgutil.iter_modules(studies.__path__))
    found = [importlib.import_module(f"{studies.__name__}.{name}").STUDY for name in names]
    return {study.name: study for study in found}


def find(name: str) -> Study:
    """The study of that name.

    Raises
    ------
    InputError
        If there is none.
    """
    from workflows.registry import unknown

    known = all_studies()
    if name not in known:
        raise unknown("verification study", name, list(known))
    return known[name]
