"""Runs: the results of jobs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, Listing, ObservationForm, Query, get, make_listing
from drivora_service.client.calls.jobs import job_query
from drivora_service.observations.trace_files.trace_rows import TraceRows

if TYPE_CHECKING:
    from drivora_service.api.schemas.perception import Perception
    from drivora_service.api.schemas.runs import Run
    from drivora_service.api.schemas.series import Series
    from drivora_service.api.schemas.timeline import Timeline
    from drivora_service.store.runs.run_counts import RunCounts
    from drivora_service.store.runs.run_records import JobFilter, RunSummary


def runs(
    wanted: JobFilter | None = None, *, oldest_first: bool = False, limit: int | None = None
) -> Listing[RunSummary]:
    """Returns runs in the order of their submission, newest first unless said otherwise.

    Args:
        wanted: Which runs; ``None``: all.
        oldest_first: Whether the oldest come first.
        limit: How many at most; ``None``: all.
    """
    from drivora_service.store.runs.run_records import RunSummary

    query = {**job_query(wanted), "order": "created_at" if oldest_first else None}
    return make_listing(f"{PREFIX}/runs", RunSummary, limit, query=query)


def run_counts(wanted: JobFilter | None = None) -> Call[RunCounts]:
    """Returns the number of runs that pass a filter, and numbers by the values of its parts."""
    from drivora_service.store.runs.run_counts import RunCounts

    return get(f"{PREFIX}/runs:counts", RunCounts, query=job_query(wanted))


def run(run_id: str) -> Call[Run]:
    """Returns a run with its results."""
    from drivora_service.api.schemas.runs import Run

    return get(f"{PREFIX}/runs/{{run_id}}", Run, run_id=run_id)


def run_scenario(run_id: str) -> Call[str]:
    """Returns what a run has driven as the text of a document that can be posted again."""
    return get(f"{PREFIX}/runs/{{run_id}}/scenario", str, accept="application/json", run_id=run_id)


def run_observations(
    run_id: str,
    *,
    form: ObservationForm = ObservationForm.PARQUET,
    first: int = 0,
    last: int | None = None,
    rows: TraceRows = TraceRows.ALL,
    columns: Sequence[str] = (),
) -> Call[bytes]:
    """Returns what a run recorded.

    Args:
        run_id: Id of the run.
        form: As which file.
        first: First step, from 0.
        last: Last step, included; ``None``: the last one of all.
        rows: Whose rows; ``EGOS`` as Arrow only.
        columns: Columns besides ``step`` and ``actor``, as Arrow only; empty: all.

    Raises:
        NotFound: It recorded nothing, or not yet.
    """
    return get(
        f"{PREFIX}/runs/{{run_id}}/observations",
        bytes,
        query=observation_query(first, last, rows, columns),
        accept=form,
        run_id=run_id,
    )


def run_timeline(run_id: str) -> Call[Timeline]:
    """Returns what happened when in a run: violations, signals, actors, lines of agents' logs."""
    from drivora_service.api.schemas.timeline import Timeline

    return get(f"{PREFIX}/runs/{{run_id}}/timeline", Timeline, run_id=run_id)


def run_series(run_id: str, *, ego: int = 0) -> Call[Series]:
    """Returns values of an ego by step, as oracles and metrics measure them.

    Args:
        run_id: Id of the run.
        ego: Row of the ego in the trace, from 0.
    """
    from drivora_service.api.schemas.series import Series

    return get(
        f"{PREFIX}/runs/{{run_id}}/series",
        Series,
        query={"ego": ego},
        accept="application/json",
        run_id=run_id,
    )


def run_perception(run_id: str, *, ego: int = 0) -> Call[Perception]:
    """Returns how many of the other actors an ego perceived, by step.

    Args:
        run_id: Id of the run.
        ego: Row of the ego in the trace, from 0.
    """
    from drivora_service.api.schemas.perception import Perception

    return get(
        f"{PREFIX}/runs/{{run_id}}/perception",
        Perception,
        query={"ego": ego},
        accept="application/json",
        run_id=run_id,
    )


def observation_query(
    first: int, last: int | None, rows: TraceRows, columns: Sequence[str]
) -> Query:
    """Returns the parameters that choose a part of a recording."""
    return {
        "first": first or None,
        "last": last,
        "rows": None if rows is TraceRows.ALL else rows,
        "column": columns,
    }


def run_picture(
    run_id: str,
    *,
    moments: int | None = None,
    oracle: str = "",
    ego: str = "",
    step: int | None = None,
) -> Call[bytes]:
    """Returns a strip of moments of a run as SVG: those that lead to a violation.

    Args:
        run_id: Id of the run.
        moments: Number of moments, 2 to 12; ``None``: as the service has it.
        oracle: The moments lead to a violation of this oracle; "": to the gravest.
        ego: With ``oracle``: of this ego.
        step: With ``oracle``: the violation that begins in this row of the trace; ``None``: the
            earliest.

    Raises:
        NotFound: It recorded nothing, or not yet, or has no such violation.
    """
    return get(
        f"{PREFIX}/runs/{{run_id}}/picture",
        bytes,
        query={"moments": moments, "oracle": oracle, "ego": ego, "step": step},
        run_id=run_id,
    )
