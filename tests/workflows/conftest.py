"""The command line on an experiment small enough for tests."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from workflows.cli import app

SMALL = """
# The paper's film on coarse meshes for 60 ms. A conductivity 25 times as large makes the front five
# times as fast and as wide, so that it crosses the film on this mesh in this time; the flux that
# excites the tissue grows by five, too. S2 comes while the tissue is refractory.
[electrophysiology]
elements = [28, 6]
n_steps = 1200
duration = 60.0
conductivity = 0.05

[electrophysiology.stimulus_library.S1]
flux = 10.0

[electrophysiology.stimulus_library.S2]
start = 30.0

[mechanics]
elements = [6, 3]
n_steps = 12
duration = 60.0
"""


def invoke(*arguments: object) -> Result:
    """Result of a command line."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@dataclass(frozen=True)
class Desk:
    """A store, a file of parameters, and room for output folders."""

    folder: Path
    workflow: str = "planar-waves"

    @property
    def store(self) -> Path:
        """Folder of the store."""
        return self.folder / "store"

    @property
    def config(self) -> Path:
        """File with the parameters of the small experiment."""
        return self.folder / "small.toml"

    def call(self, command: str, *more: object) -> Result:
        """Command on the small experiment with this store."""
        where = ("--config", self.config, "--store", self.store)
        return invoke(command, self.workflow, *where, *more)

    def run(self, out: str, *more: object, command: str = "run") -> dict[str, Any]:
        """Summary of a run that must succeed."""
        result = self.call(command, "--out", self.folder / out, *more)
        assert result.exit_code == 0, result.output
        summary: dict[str, Any] = json.loads((self.folder / out / "summary.json").read_text())
        return summary


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Desk:
    """An empty store."""
    made = Desk(tmp_path_factory.mktemp("desk"))
    made.config.write_text(SMALL)
    return made
