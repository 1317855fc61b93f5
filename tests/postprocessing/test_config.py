"""What the postprocessing section refuses."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from stages.postprocessing.config import PostprocessingConfig

GOOD = {"probes": {"A": (1.75, 1.0)}, "mid_axis": 1.0, "velocity_window": (1.0, 2.5)}


def test_the_papers_probes_are_accepted() -> None:
    assert PostprocessingConfig.model_validate(GOOD).probes == {"A": (1.75, 1.0)}


def test_the_order_in_which_probes_are_named_does_not_matter() -> None:
    """Equal keys must mean equal results: a key does not know the order of a table."""
    probes = {"B": (3.5, 1.0), "A": (1.75, 1.0)}
    made = PostprocessingConfig.model_validate(GOOD | {"probes": probes}).probes
    assert list(made) == ["A", "B"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"probes": {}}, "at least one probe"),
        ({"probes": {"A.x": (1.0, 1.0)}}, "must start with a letter"),
        ({"velocity_window": (2.5, 1.0)}, "from a smaller to a larger X"),
        ({"mid_axis": -1.0}, "at least 0 mm"),
        ({"mid_axis": "centre"}, "valid number"),
    ],
)
def test_a_wrong_value_is_refused_with_its_reason(change: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        PostprocessingConfig.model_validate(GOOD | change)
