"""Control by load: the time laws say what acts in every frame."""

from __future__ import annotations

from typing import Literal

from stages.mechanics.controls.base import Control


class LoadControl(Control):
    """Fails where the loading has a maximum that the film cannot pass in equilibrium."""

    kind: Literal["load"] = "load"


MODEL = LoadControl
