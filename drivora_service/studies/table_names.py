"""The names of the tables of a study, and their forms."""

from __future__ import annotations

from enum import StrEnum


class TableName(StrEnum):
    """The tables of a study."""

    CAMPAIGNS = "campaigns"
    EVALUATIONS = "evaluations"
    FAILURES = "failures"


class TableForm(StrEnum):
    """Media type of a table."""

    PARQUET = "application/vnd.apache.parquet"
    CSV = "text/csv"
