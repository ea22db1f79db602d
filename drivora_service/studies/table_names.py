"""The names of the tables, and their forms."""

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
    ARROW = "application/vnd.apache.arrow.stream"
    JSON = "application/json"


class CampaignTableName(StrEnum):
    """The tables of a campaign."""

    EVALUATIONS = "evaluations"
    FAILURES = "failures"


class ResultTableName(StrEnum):
    """The tables of the results of runs."""

    RUNS = "runs"
    VERDICTS = "verdicts"
    METRICS = "metrics"
    AGENTS = "agents"
