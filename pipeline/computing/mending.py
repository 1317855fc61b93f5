"""Finding results that are sound, and setting those aside that are not."""

from __future__ import annotations

from pipeline.events import Listener, StageWarned
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.store import Store
from pipeline.store.labels import RunLabel
from pipeline.verification import DamagedError


def find_sound(
    name: str, ref: Ref, store: Store, tell: Listener, label: RunLabel | None = None
) -> Manifest | None:
    """Manifest of a result every byte of which was checked, ``None`` if it must be computed.

    A damaged one is set aside, with a warning under the name of its node.

    Raises
    ------
    StoreError
        If the store cannot be read, or does not let the result be moved.
    """
    manifest = None
    try:
        manifest = store.find(ref, label)
        problems = () if manifest is None else store.verify(ref, full=True)
    except DamagedError as error:
        problems = error.problems
    if not problems:
        return manifest
    aside = store.quarantine(ref, problems)
    if aside is None:
        return store.find(ref, label)  # another process was quicker
    what = f"the stored result was damaged ({'; '.join(problems)})"
    tell(StageWarned(name, ref.stage, f"{what}; it was moved to {aside} and is computed again"))
    return None
