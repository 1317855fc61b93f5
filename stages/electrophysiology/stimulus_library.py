"""Stimuli by their names in the library."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

from pydantic_core import PydanticCustomError


def with_named_stimuli(data: Any) -> Any:
    """The section's table with names in ``stimuli`` replaced by their tables in ``stimulus_library``.

    A table with a ``name`` is that stimulus of the library with what else it holds changed, which is
    also what ``--set electrophysiology.stimuli.0.flux=3`` makes of a name.

    Examples
    --------
    >>> library = {"S1": {"kind": "edge-flux", "start": 0.0}}
    >>> with_named_stimuli({"stimuli": "S1", "stimulus_library": library})["stimuli"]
    ({'kind': 'edge-flux', 'start': 0.0},)
    >>> changed = {"stimuli": [{"name": "S1", "start": 9.0}], "stimulus_library": library}
    >>> with_named_stimuli(changed)["stimuli"]
    ({'kind': 'edge-flux', 'start': 9.0},)
    """
    if not isinstance(data, dict):
        return data
    library = data.get("stimulus_library") or {}
    chosen = data.get("stimuli")
    if isinstance(chosen, str):
        names = chosen.strip().removeprefix("[").removesuffix("]").split(",")
        chosen = [name.strip() for name in names if name.strip()]
    if not isinstance(chosen, list | tuple) or not isinstance(library, dict):
        return data
    return data | {"stimuli": tuple(_found(item, library) for item in chosen)}


def _found(item: Any, library: Mapping[str, Any]) -> Any:
    name = item.get("name") if isinstance(item, Mapping) else item
    if not isinstance(name, str):
        return item
    if name not in library:
        near = get_close_matches(name, library, n=1, cutoff=0.3)
        raise PydanticCustomError(
            "unknown_stimulus",
            "stimuli: no stimulus is called {name}{hint}; the library holds: {allowed}",
            {
                "name": repr(name),
                "hint": f" (did you mean {near[0]!r}?)" if near else "",
                "allowed": ", ".join(library) or "nothing",
            },
        )
    stored = library[name]
    if not isinstance(item, Mapping):
        return stored
    changes = {key: value for key, value in item.items() if key != "name"}
    table = stored if isinstance(stored, Mapping) else dict(stored)
    return {**table, **changes}
