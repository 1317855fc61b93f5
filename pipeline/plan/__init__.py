"""What would be computed and why: how the results in a store differ from what is asked."""

from pipeline.plan.explaining import explain, fingerprint_of, input_entries, statement_of
from pipeline.plan.verdicts import (
    Acceptable,
    Changed,
    Damaged,
    Forecast,
    Hit,
    Missing,
    Pending,
    Verdict,
)

__all__ = [
    "Acceptable",
    "Changed",
    "Damaged",
    "Forecast",
    "Hit",
    "Missing",
    "Pending",
    "Verdict",
    "explain",
    "fingerprint_of",
    "input_entries",
    "statement_of",
]
