"""Every tension law of the project with parameters to test it on."""

from __future__ import annotations

from stages.configuration import OneOf
from stages.mechanics.tension_laws.base import TensionLaw
from stages.mechanics.tension_laws.length_dependent import LengthDependent
from stages.mechanics.tension_laws.prescribed import Prescribed

NAMES = OneOf("stages.mechanics.tension_laws", TensionLaw).names()

EXAMPLES: dict[str, TensionLaw] = {
    "prescribed": Prescribed(),
    "length-dependent": LengthDependent(
        optimal_stretch=1.24, min_stretch=0.86, max_stretch=1.34, prestretch=1.14
    ),
}
"""Parameters for the tests, by the law's name; a new file needs a line here (Table 2 so far)."""


def example(name: str) -> TensionLaw:
    """A tension law by its name, with parameters."""
    if name not in EXAMPLES:
        raise LookupError(
            f"tension law {name!r} has no parameters to be tested with: add them to EXAMPLES in "
            f"tests/mechanics/tensions.py"
        )
    return EXAMPLES[name]
