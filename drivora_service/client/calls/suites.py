"""Suites that were run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, Listing, get, make_listing, post

if TYPE_CHECKING:
    from collections.abc import Sequence

    from drivora_service.api.schemas.suites import SuiteList
    from drivora_service.store.suites.suite_records import (
        SuiteDecision,
        SuiteHistory,
        SuiteOutcome,
        SuiteRunRecord,
        SuiteRunSummary,
    )

_RUNS = f"{PREFIX}/suite-runs"


def post_suite_run(
    decision: SuiteDecision, outcomes: Sequence[SuiteOutcome]
) -> Call[SuiteRunRecord]:
    """Has the service keep what the gate of a suite decided.

    Args:
        decision: The decision.
        outcomes: What became of each scenario, in the order of the suite.
    """
    from drivora_service.api.schemas.suites import SuiteRunRequest
    from drivora_service.store.suites.suite_records import SuiteRunRecord

    request = SuiteRunRequest(decision=decision, outcomes=tuple(outcomes))
    return post(_RUNS, SuiteRunRecord, request.model_dump_json().encode())


def suites() -> Call[SuiteList]:
    """Returns the suites that were run, the last run first."""
    from drivora_service.api.schemas.suites import SuiteList

    return get(f"{PREFIX}/suites", SuiteList)


def suite_runs(
    *, suite: str = "", agent: str = "", configuration: str = "", limit: int | None = None
) -> Listing[SuiteRunSummary]:
    """Returns runs of suites, newest first.

    Args:
        suite: Only those of this suite; "": of any.
        agent: Only those of this ADS; "": of any.
        configuration: Only those of this ``configuration_id``; "": of any.
        limit: How many at most; ``None``: all.
    """
    from drivora_service.store.suites.suite_records import SuiteRunSummary

    query = {"suite": suite, "agent": agent, "configuration": configuration}
    return make_listing(_RUNS, SuiteRunSummary, limit, query=query)


def suite_run(suite_run_id: str) -> Call[SuiteRunRecord]:
    """Returns a run of a suite, with what became of its scenarios."""
    from drivora_service.store.suites.suite_records import SuiteRunRecord

    return get(f"{_RUNS}/{{suite_run_id}}", SuiteRunRecord, suite_run_id=suite_run_id)


def suite_history(
    suite: str, *, agent: str = "", configuration: str = "", runs: int | None = None
) -> Call[SuiteHistory]:
    """Returns the last runs of a suite, and what became of each scenario in them.

    Args:
        suite: Name of the suite.
        agent: Only runs of this ADS; "": of any.
        configuration: Only runs of this ``configuration_id``; "": of any.
        runs: Number of runs, the last ones; ``None``: as the service has it.
    """
    from drivora_service.store.suites.suite_records import SuiteHistory

    query = {"suite": suite, "agent": agent, "configuration": configuration, "runs": runs}
    return get(f"{PREFIX}/suites:history", SuiteHistory, query=query)
