"""Whether the code in memory is the code that a key states."""

from __future__ import annotations

import sys

from pipeline.errors import StageError
from pipeline.fingerprint import Fingerprint
from pipeline.fingerprint.loaded import loaded_content
from pipeline.fingerprint.sources import Sources, known_source

NAMED = 3
"""Modules that a message names; another branch checked out may change dozens."""


def check_loaded(stage: str, code: Fingerprint) -> None:
    """Refuse to go on with a stage when modules in memory differ from those of its fingerprint.

    Raises
    ------
    StageError
        Naming the modules.
    """
    if edited := edited_modules(code):
        more = f" and {len(edited) - NAMED} more" if len(edited) > NAMED else ""
        raise StageError(
            stage,
            f"the source of {', '.join(edited[:NAMED])}{more} was edited after this process had loaded or "
            "fingerprinted it: the result would be kept under the key of other code",
            remedy="start again in a new process",
        )


def edited_modules(code: Fingerprint) -> list[str]:
    """Modules in memory that are not what a fingerprint says of them."""
    sources = Sources()
    return [n for n in (*code.modules, *code.bare) if not _is_stated(n, code, sources)]


def _is_stated(name: str, code: Fingerprint, sources: Sources) -> bool:
    """Whether a module has the digest that is stated; what is not loaded cannot differ."""
    if name not in sys.modules:
        return True
    file = sources.locate(name)
    if file is None:  # removed since
        return False
    content = loaded_content(name, file)
    if content is None:
        return False
    source = sources.read(name) if sources.content(name) == content else known_source(content)
    return source is not None and source.digest == code.modules.get(name)
