"""The classes of failures against a baseline."""

from __future__ import annotations

from enum import StrEnum


class FailureClass(StrEnum):
    """What has become of a failure since the baseline."""

    NEW = "new"
    """It did not occur before, and occurs in every run, or in significantly more than before."""
    WORSE = "worse"
    """It occurred before, and occurs in significantly more runs, or is clearly more severe."""
    SAME = "same"
    """It occurred in every run before, and does."""
    FLAKY = "flaky"
    """It occurs in some runs and not in others; whether that has changed cannot be told."""
    FIXED = "fixed"
    """It occurred in every run before, or in significantly many, and occurs in none."""


IN_ORDER = (
    FailureClass.NEW,
    FailureClass.WORSE,
    FailureClass.FLAKY,
    FailureClass.SAME,
    FailureClass.FIXED,
)
"""The order of reports: what needs a decision first."""
