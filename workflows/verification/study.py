"""What a verification study is: a stage that fills a table, a figure of it, and the errors to bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pipeline.nodes import Stage
from stages.artefacts import StudyTable
from stages.configuration import Section
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Study:
    """A comparison with a closed form or with published values.

    Attributes
    ----------
    name
        Name on the command line, that of the file with ``-`` for ``_``. Its parameters are the table
        of that name (with ``_``) in ``parameters/verification.toml``.
    title
        One line that says what is compared with what, and the source.
    stage
        Fills the table; kept in the store as any other result.
    draw
        Draws the table into an empty figure.
    quantities
        From the table to the numbers to report; errors have limits.
    size
        Width and height of the figure, inches.
    """

    name: str
    title: str
    stage: Stage[StudyTable]
    draw: Callable[[StudyTable, Figure], None]
    quantities: Callable[[StudyTable], dict[str, Quantity]]
    size: tuple[float, float] = (9.0, 4.2)

    @property
    def section(self) -> str:
        """Name of its table of parameters."""
        return self.name.replace("-", "_")

    @property
    def module(self) -> str:
        """Module that defines it."""
        return self.stage.module

    @property
    def config(self) -> type[Section]:
        """Class of its parameters."""
        declared: type[Section] = self.stage.signature.config[1]
        return declared
