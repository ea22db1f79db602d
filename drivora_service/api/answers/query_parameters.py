"""Query parameters that several operations share."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import Depends, Query
from pydantic import AwareDatetime

from drivora_service.api.answers.recorded_frames import FramePart, StepRange
from drivora_service.api.answers.submission import Overrides
from drivora_service.given_names import CHECKED_NAME
from drivora_service.observations.trace_files.trace_rows import TraceRows
from drivora_service.oracles.verdict import Outcome
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.runs.run_report import RunStatus
from drivora_service.scenario.agent_parameters import read_agent_parameter
from drivora_service.store.runs.result_records import ResultFilter
from drivora_service.store.runs.run_records import LONGEST_LABEL, JobFilter, RunOptions

_SEED_MAX = 2**31 - 1

Limit = Annotated[int, Query(ge=1, le=500, description="Items of a page.")]
PageToken = Annotated[
    str,
    Query(
        max_length=500,
        pattern="^[A-Za-z0-9_-]*$",
        description="`next_page_token` of the page before, of the same query.",
        json_schema_extra={"format": "page-token"},
    ),
]
Points = Annotated[
    int, Query(ge=2, le=2000, description="Points of a curve; evenly spaced if it has more.")
]
Configuration = Annotated[
    str,
    Query(
        max_length=8,
        description="Of the agents with all their parameters that have this `configuration_id`.",
    ),
]
Label = Annotated[str, Query(max_length=LONGEST_LABEL, description="Display name."), CHECKED_NAME]


async def _overrides(
    agent: Annotated[
        str, Query(max_length=200, description="Agent of every ego, overrides the documented one.")
    ] = "",
    agent_parameter: Annotated[
        list[str] | None,
        Query(
            max_length=100,
            description="Sets a parameter of every ego's agent: `NAME=VALUE`; of one's: "
            "`EGO:NAME=VALUE`. May be repeated. A value that is no JSON is text.",
        ),
    ] = None,
    seed: Annotated[
        int | None, Query(ge=0, le=_SEED_MAX, description="Seed that overrides the document's.")
    ] = None,
) -> Overrides:
    parameters = tuple(read_agent_parameter(text) for text in agent_parameter or ())
    options = RunOptions(agent_override=agent, seed_override=seed)
    return Overrides(options=options, parameters=parameters)


RunOverrides = Annotated[Overrides, Depends(_overrides)]


async def _posted_definition(
    counts: Annotated[
        Counted, Query(description="The violations that are failures of the runs.")
    ] = Counted.ACCOUNTABLE,
    count_oracle: Annotated[
        list[str] | None,
        Query(
            max_length=100,
            description="Only violations of this oracle are failures of the runs, observations "
            "included; may be repeated. Without it, those of all but observations.",
        ),
    ] = None,
) -> FailureDefinition:
    return FailureDefinition(
        counts=counts, oracles=tuple(sorted(set(count_oracle))) if count_oracle else None
    )


PostedDefinition = Annotated[FailureDefinition, Depends(_posted_definition)]


async def _run_conditions(
    status: Annotated[list[RunStatus] | None, Query(description="In any of these states.")] = None,
    agent: Annotated[str, Query(max_length=200, description="Driven by this agent.")] = "",
    configuration: Configuration = "",
    town: Annotated[str, Query(max_length=100, description="On this network.")] = "",
    oracle: Annotated[
        str, Query(max_length=60, description="With the verdict `outcome` of this oracle.")
    ] = "",
    outcome: Annotated[Outcome, Query(description="See `oracle`.")] = Outcome.VIOLATED,
    at_fault: Annotated[
        bool | None,
        Query(
            description="See `oracle`: by the fault of an ego, or not. Without `oracle`: with a "
            "violation by the fault of an ego, or with violations, but none by its fault."
        ),
    ] = None,
    accountability: Annotated[
        Accountability | None, Query(description="The strongest of its violations is this.")
    ] = None,
    violated: Annotated[bool | None, Query(description="With, or without, any violation.")] = None,
    failing: Annotated[
        bool | None,
        Query(
            description="With, or without, a failure by the definition with which it was posted."
        ),
    ] = None,
    scenario_sha256: Annotated[str, Query(max_length=64, description="Of this scenario.")] = "",
    since: Annotated[
        AwareDatetime | None, Query(description="Submitted at this time or later.")
    ] = None,
    until: Annotated[AwareDatetime | None, Query(description="Submitted before this time.")] = None,
) -> JobFilter:
    return JobFilter(
        statuses=frozenset(status or ()),
        agent=agent,
        configuration_id=configuration,
        town=town,
        oracle=oracle,
        outcome=outcome,
        at_fault=at_fault,
        accountability=accountability,
        violated=violated,
        failing=failing,
        scenario_sha256=scenario_sha256,
        since=since,
        until=until,
    )


_Conditions = Annotated[JobFilter, Depends(_run_conditions)]


async def _job_filter(
    conditions: _Conditions,
    batch: Annotated[str, Query(max_length=40, description="Of this batch.")] = "",
    campaign: Annotated[
        str, Query(max_length=40, description="Of this campaign, if the service runs or ran it.")
    ] = "",
) -> JobFilter:
    return replace(conditions, batch_id=batch, campaign_id=campaign)


Filter = Annotated[JobFilter, Depends(_job_filter)]


async def _result_filter(
    conditions: _Conditions,
    batch: Annotated[
        list[Annotated[str, Query(max_length=40)]] | None,
        Query(max_length=500, description="Of this batch; may be repeated."),
    ] = None,
    campaign: Annotated[
        list[Annotated[str, Query(max_length=200)]] | None,
        Query(
            max_length=500,
            description="Of this campaign, by its id, its first digits, its name, a pattern of "
            "names, or `latest`; may be repeated.",
        ),
    ] = None,
    study: Annotated[
        list[Annotated[str, Query(max_length=40)]] | None,
        Query(max_length=500, description="Of the campaigns of this study; may be repeated."),
    ] = None,
) -> ResultFilter:
    return ResultFilter(
        batch_ids=tuple(batch or ()),
        campaign_ids=tuple(campaign or ()),
        study_ids=tuple(study or ()),
        runs=conditions,
    )


Results = Annotated[ResultFilter, Depends(_result_filter)]


async def _step_range(
    first: Annotated[int, Query(ge=0, le=10**9, description="First step, from 0.")] = 0,
    last: Annotated[
        int | None, Query(ge=0, le=10**9, description="Last step, itself included.")
    ] = None,
) -> StepRange:
    return StepRange(first=first, last=last)


Steps = Annotated[StepRange, Depends(_step_range)]


async def _frame_part(
    steps: Steps,
    rows: Annotated[
        TraceRows, Query(description="Whose rows; with `egos`, the answer is Arrow.")
    ] = TraceRows.ALL,
    column: Annotated[
        list[Annotated[str, Query(max_length=200)]] | None,
        Query(
            max_length=100,
            description="A column besides `step` and `actor`; the answer is then Arrow. May be "
            "repeated; without it, all columns come.",
        ),
    ] = None,
) -> FramePart:
    return FramePart(steps=steps, rows=rows, columns=tuple(column or ()))


Frames = Annotated[FramePart, Depends(_frame_part)]
