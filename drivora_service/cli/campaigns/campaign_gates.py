"""Gates of campaigns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import typer

from drivora_service.api.schemas.campaigns import Campaign
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.runs.run_gates import Gate, GateAnswer, group_by_evaluation, read_gate
from drivora_service.cli.terminal.output import fail
from drivora_service.client import Client
from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdicts.failure_definition import Counted, definition_of
from drivora_service.runs.run_report import RunStatus
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import EvaluationFilter


def gate_of_document(
    client: Client, document: Mapping[str, Any], wanted: Sequence[str], *, is_wanted: bool
) -> Gate | None:
    """Reads the gate of a campaign: of what it counts as failures.

    It is read before the campaign is posted, so that a wrong one stores nothing.

    Args:
        client: Client of the service that knows the oracles.
        document: The campaign, perhaps not valid.
        wanted: Texts of ``--gate-oracle``.
        is_wanted: Whether there is a gate without any.
    """
    if not (wanted or is_wanted):
        return None
    counts, named = document.get("counts"), document.get("oracles")
    if (counts is not None and counts not in list(Counted)) or not isinstance(
        named, list | tuple | None
    ):
        # It is refused with the document.
        return Gate()
    if not wanted:
        return Gate(definition=definition_of(document))
    known = (
        [oracle.name for oracle in client.oracles().items]
        if named is None
        else [str(one) for one in named]
    )
    try:
        counted = None if counts is None else Counted(counts)
        return read_gate(wanted, known, counted_by="the campaign", counts=counted)
    except ConfigurationError as error:
        fail(str(error))
        raise typer.Exit(ExitCode.USAGE_ERROR) from error


def judge_campaign(client: Client, campaign: Campaign, gate: Gate) -> GateAnswer:
    """Judges what a campaign has found, simulations in which the ADS itself failed included."""
    failures = ((one.evaluation, one.verdict) for one in client.failures(campaign.id))
    return gate.judge(
        group_by_evaluation(failures),
        agent_failed=[f"{campaign.id}-{number}" for number in _agent_failed(client, campaign)],
    )


def _agent_failed(client: Client, campaign: Campaign) -> list[int]:
    """Returns the numbers of the evaluations in which the ADS itself failed."""
    if not campaign.counts.failed:
        return []
    # The cause alone does not say whether it was the ADS: a signal may have ended anything.
    failed = client.evaluations(campaign.id, EvaluationFilter(status=EvaluationStatus.FAILED))
    return [
        one.number
        for one in failed
        if client.evaluation(campaign.id, one.number).run_status is RunStatus.AGENT_FAILED
    ]
