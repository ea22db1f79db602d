"""Finding runs by their ids: those of the queue, and those of evaluations."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from drivora_service.errors import UnknownName
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition, definition_of
from drivora_service.store.campaigns.evaluation_runs import evaluation_of_run

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction
    from drivora_service.store.runs.run_records import RunRecord


def find_run(transaction: Transaction, run_id: str) -> RunRecord:
    """Returns a run with its results.

    Searches record nothing: a failure has the hash, and so the recording, of its second, identical
    run.

    Raises:
        UnknownName: There is none of this id.
    """
    evaluation = evaluation_of_run(run_id)
    try:
        found = transaction.jobs.detail(run_id)
    except UnknownName:
        if evaluation is None:
            raise
        return transaction.campaign_views.run(evaluation)
    # A campaign may count observations as failures.
    has_failure = bool(found.violations or found.observations)
    if evaluation is None or found.trace_sha256 or not has_failure:
        return found
    with suppress(UnknownName):
        again = transaction.campaign_views.run(evaluation)
        return replace(found, trace_sha256=again.trace_sha256)
    return found


def find_overrides(transaction: Transaction, run_id: str) -> tuple[str, int | None]:
    """Returns the agent ("": none) and the seed that override those of a run's scenario.

    The scenarios of evaluations have theirs already.
    """
    try:
        return transaction.jobs.overrides(run_id)
    except UnknownName:
        return "", None


def find_definition(transaction: Transaction, run_id: str) -> FailureDefinition:
    """Returns what counts as a failure of a run: that of its campaign, if it is of one."""
    evaluation = evaluation_of_run(run_id)
    if evaluation is not None:
        with suppress(UnknownName):
            return definition_of(transaction.campaigns.get(evaluation.campaign_id).document)
    return transaction.jobs.definition(run_id)


def find_document(transaction: Transaction, run_id: str) -> str:
    """Returns the scenario of a run as canonical JSON text.

    Raises:
        UnknownName: There is no such run, or it is of an invalid candidate.
    """
    try:
        return transaction.jobs.document(run_id)
    except UnknownName:
        evaluation = evaluation_of_run(run_id)
        if evaluation is None:
            raise
        return transaction.evaluations.document(evaluation.campaign_id, evaluation.number)
