"""The columns of the tables of results; docs/reference/tables.md lists them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pyarrow as pa

from drivora_service.studies.table_names import ResultTableName

_TEXT, _FLAG, _REAL, _COUNT = pa.string(), pa.bool_(), pa.float64(), pa.int32()
_TIME = pa.timestamp("us", tz="UTC")


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column of a table.

    Attributes:
        type: Of its values.
        unit: "" for what has none.
        is_null: Whether values may be null, which is no value, or not measurable.
        meaning: One phrase, in Markdown.
    """

    name: str
    type: pa.DataType
    unit: str = ""
    is_null: bool = False
    meaning: str

    @property
    def field(self) -> pa.Field:
        """The field of the schema; unit and meaning are its metadata."""
        metadata = {"meaning": self.meaning} | ({"unit": self.unit} if self.unit else {})
        return pa.field(self.name, self.type, nullable=self.is_null, metadata=metadata)


def _column(name: str, type_: pa.DataType, meaning: str, *, unit: str = "") -> Column:
    return Column(name=name, type=type_, unit=unit, meaning=meaning)


def _or_null(name: str, type_: pa.DataType, meaning: str, *, unit: str = "") -> Column:
    return Column(name=name, type=type_, unit=unit, is_null=True, meaning=meaning)


_RUN_ID = _column("run_id", _TEXT, "id of the run; joins the tables")
_LABEL = _or_null("label", _TEXT, "display name of the run")

_RUNS = (
    _RUN_ID,
    _column(
        "source",
        _TEXT,
        "`run`: the run is stored; `evaluation`: only its campaign has it (a campaign of a "
        "command, or a run that was removed)",
    ),
    _LABEL,
    _or_null("batch_id", _TEXT, "id of its batch; null for a job that was posted singly"),
    _column("item", _COUNT, "place in the batch, from 0; number of the evaluation in a campaign"),
    _or_null("campaign_id", _TEXT, "id of its campaign"),
    _or_null("campaign", _TEXT, "name of its campaign"),
    _or_null(
        "evaluation",
        _COUNT,
        "number of its evaluation in the campaign, from 0; null: the run of a seed scenario",
    ),
    _column(
        "confirms",
        _FLAG,
        "whether it is the second, identical run of an evaluation that confirms its failures",
    ),
    _or_null("study_id", _TEXT, "id of the study of its campaign"),
    _or_null("study_scenario", _TEXT, "label of the scenario in the study"),
    _or_null("study_agent", _TEXT, "label of the agent in the study"),
    _or_null("study_method", _TEXT, "label of the method in the study"),
    _or_null("repetition", _COUNT, "repetition in the study, from 1"),
    _or_null("scenario_sha256", _TEXT, "hash of the scenario; null for an invalid candidate"),
    _or_null("town", _TEXT, "name of the road network"),
    _or_null("agent", _TEXT, "name of the ADS; several are joined by commas"),
    _or_null(
        "configuration",
        _TEXT,
        "the ADS with the parameters that differ from its defaults; several are joined by commas",
    ),
    _or_null(
        "configuration_id",
        _TEXT,
        "short id of the ADS with the values of all its parameters; null where not recorded",
    ),
    _or_null("seed", pa.int64(), "seed of the run: that of its job, else that of the scenario"),
    _column("status", _TEXT, "state of the run, such as `finished`"),
    _or_null("cause", _TEXT, "why it was not judged, in one word"),
    _or_null("error", _TEXT, "why it was not judged, in a sentence"),
    _column(
        "created_at", _TIME, "when it was submitted; of an `evaluation`, when its tester was told"
    ),
    _or_null("started_at", _TIME, "when it was started; null of an `evaluation`"),
    _or_null("ended_at", _TIME, "when it ended"),
    _column("attempts", _COUNT, "attempts of workers at it"),
    _or_null(
        "violations",
        _COUNT,
        "violated verdicts, without observations and what only follows from another violation; "
        "null unless finished",
    ),
    _or_null("at_fault_violations", _COUNT, "those for which an ego is responsible"),
    _or_null("observations", _COUNT, "violated verdicts that are observations"),
    _or_null(
        "failures",
        _COUNT,
        "failures by what was defined for the run; null if it says nothing about its ADS",
    ),
    _column("counts", _TEXT, "the violations that `failures` counts: `counts` of the definition"),
    _or_null(
        "oracles",
        _TEXT,
        "the only oracles that it counts, joined by commas; null: all but observations",
    ),
    _or_null("accountability", _TEXT, "the strongest of its violations; null without one"),
    _or_null("steps", _COUNT, "rows of the trace; null unless finished"),
    _or_null("sim_time_s", _REAL, "simulated time; null unless finished", unit="s"),
    _or_null("wall_time_s", _REAL, "time of the worker; null unless finished", unit="s"),
    _or_null("step_cost_us", _REAL, "mean wall time of a step", unit="µs"),
    _or_null("trace_sha256", _TEXT, "hash of all that was simulated: equal runs have the same"),
    _or_null("drivora_version", _TEXT, "version of Drivora that performed it"),
    _or_null("sumo_version", _TEXT, "version of SUMO (libsumo) that simulated it"),
    _or_null("versions", _TEXT, "JSON object: version of all software that took part, by name"),
)

_VERDICTS = (
    _RUN_ID,
    _LABEL,
    _column("place", _COUNT, "place among the verdicts of the run, from 0"),
    _column("oracle", _TEXT, "name of the oracle"),
    _column("ego", _TEXT, "id of the ego"),
    _column(
        "outcome",
        _TEXT,
        "`passed`, `violated`, `not_applicable` (nothing to judge) or `not_measurable`",
    ),
    _or_null(
        "severity",
        _TEXT,
        "`critical`, `major`, `minor` or `observation`; null unless violated",
    ),
    _or_null("at_fault", _FLAG, "whether the ego is responsible; null if that is not attributed"),
    _column("undetermined", _FLAG, "whether the oracle attributes fault, but not in this case"),
    _or_null(
        "avoidable",
        _TEXT,
        "whether a careful and competent driver avoids it: `yes`, `no` or `not_measurable`; null "
        "if the oracle does not measure that",
    ),
    _or_null(
        "physically_avoidable",
        _TEXT,
        "whether braking or steering at full grip without delay avoids it; likewise",
    ),
    _or_null("accountability", _TEXT, "of the ego for the violation; null unless violated"),
    _or_null(
        "follows", _TEXT, "the oracle from whose violation this one only follows; null if from none"
    ),
    _or_null(
        "counted",
        _FLAG,
        "whether it is a failure by what was defined for the run; null unless violated",
    ),
    _or_null("time_s", _REAL, "simulated time at which the violation began", unit="s"),
    _or_null("step", _COUNT, "row of the trace at that time"),
    _or_null("x", _REAL, "where it began, east", unit="m"),
    _or_null("y", _REAL, "where it began, north", unit="m"),
    _or_null("counterpart", _TEXT, "id of the other actor"),
    _or_null("message", _TEXT, "one sentence"),
    _column("evidence", _TEXT, "JSON object: measured values by name, SI units"),
)

_METRICS = (
    _RUN_ID,
    _LABEL,
    _column(
        "kind",
        _TEXT,
        "`metric`: describes the run; `score`: an objective of every run, those of own oracles "
        "among them; `objective`: one that a campaign measures for its tester",
    ),
    _column("metric", _TEXT, "its name; `GET /metrics:describe` has definition and unit"),
    _or_null("value", _REAL, "its value, in the unit of the metric; null: not measurable"),
)

_AGENTS = (
    _RUN_ID,
    _LABEL,
    _column("ego", _TEXT, "id of the ego"),
    _column("agent", _TEXT, "name of the ADS that drives it"),
    _column("parameters", _TEXT, "JSON object: values of all parameters of the agent, by name"),
    _or_null("cost_us", _REAL, "mean wall time of a step in the agent; null for SUMO's", unit="µs"),
    _column("privileged", _FLAG, "whether it got more than the perception model lets through"),
)

COLUMNS: Mapping[ResultTableName, tuple[Column, ...]] = {
    ResultTableName.RUNS: _RUNS,
    ResultTableName.VERDICTS: _VERDICTS,
    ResultTableName.METRICS: _METRICS,
    ResultTableName.AGENTS: _AGENTS,
}
"""The columns of each table, in their order."""


def result_schema(name: ResultTableName) -> pa.Schema:
    """Returns the schema of a table."""
    return pa.schema([column.field for column in COLUMNS[name]])
