"""Campaigns of a service, over HTTP."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import TypeAdapter

from drivora_service.campaigns.progress import Progress
from drivora_service.cli.campaign_display import campaign_display
from drivora_service.cli.campaign_files import read_campaign_file
from drivora_service.cli.campaign_results import CampaignFindings
from drivora_service.cli.client import ServiceClient
from drivora_service.feedback.measurement import Measurement
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.report import RunFailure, RunReport, RunStatus
from drivora_service.scenario.model import AgentChoice
from drivora_service.search.tester import EvaluationStatus, Proposal
from drivora_service.shapes import adapter
from drivora_service.store.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
    CampaignSummary,
    EvaluationRecord,
    Failure,
    FailureKind,
)
from drivora_service.studies.figures import CampaignFigures

_POLL_S = 0.5
_PARQUET = "application/vnd.apache.parquet"
_ON_THE_WAY = (CampaignState.QUEUED, CampaignState.RUNNING)


class ServiceCampaigns:
    """Asks a service; a context manager that closes its connections."""

    def __init__(self, url: str) -> None:
        """Prepares to ask the service at ``url``."""
        self._client = ServiceClient(url)

    def __enter__(self) -> Self:
        """Returns the object itself."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Closes the connections."""
        self._client.close()

    def post(self, path: Path) -> tuple[CampaignRecord, tuple[str, ...]]:
        """Reads a campaign file and has the service run it; gives notes for people as well.

        Raises:
            ConfigurationError: The file cannot be read.
            InvalidDocument: It cannot be run.
            ServiceError: The service refused or did not answer.
        """
        answer = self._client.post_campaign(json.dumps(read_campaign_file(path)))
        return _record(answer), tuple(answer["notes"])

    def resume(self, campaign_id: str) -> CampaignRecord:
        """Has the service go on with a campaign.

        Raises:
            ServiceError: It is over or runs, or the service did not answer.
        """
        return _record(self._client.act(f"/campaigns/{campaign_id}:resume"))

    def follow(self, campaign_id: str) -> CampaignRecord:
        """Shows a campaign until it has ended or rests.

        Raises:
            ServiceError: The service refused, did not answer, or cannot begin runs.
        """
        answer = self._client.get(f"/campaigns/{campaign_id}")
        with campaign_display(answer["budget"]) as display:
            while (record := _record(answer)).state in _ON_THE_WAY:
                display.show(_progress(record, answer))
                self._client.expect_workers()
                time.sleep(_POLL_S)
                answer = self._client.get(f"/campaigns/{campaign_id}")
            display.show(_progress(record, answer))
        return record

    def found(self, campaign_id: str) -> CampaignFindings:
        """Returns a campaign with what it has found."""
        answer = self._client.get(f"/campaigns/{campaign_id}")
        record = _record(answer)
        return CampaignFindings(
            record=record,
            is_running=self.is_running(record),
            kinds=tuple(FailureKind(**kind) for kind in answer["kinds"]),
            failures=tuple(
                _failure(item) for item in self._client.items(f"/campaigns/{campaign_id}/failures")
            ),
        )

    def figures(self, campaign_id: str) -> tuple[CampaignFigures | None, str]:
        """Returns the figures of a campaign, or ``None`` and why they are not known."""
        answer = self._client.get(f"/campaigns/{campaign_id}/figures")
        figures = answer["figures"]
        found = None if figures is None else adapter(CampaignFigures).validate_python(figures)
        return found, answer["note"]

    def newest(self, limit: int) -> tuple[CampaignSummary, ...]:
        """Returns the newest campaigns first."""
        records: list[CampaignSummary] = []
        for item in self._client.items("/campaigns"):
            if len(records) == limit:
                break
            records.append(adapter(CampaignSummary).validate_python(item))
        return tuple(records)

    def is_running(self, record: CampaignSummary) -> bool:
        """Whether a process works on a campaign, which a service sees to."""
        return record.state is CampaignState.RUNNING

    def lineage(self, campaign_id: str, number: int) -> tuple[EvaluationRecord, ...]:
        """Returns an evaluation, last, and its ancestors."""
        url = f"/campaigns/{campaign_id}/evaluations"
        last = self._client.get(f"{url}/{number}")
        ancestors = (self._client.get(f"{url}/{one['number']}") for one in last["lineage"])
        return tuple(_evaluation(detail) for detail in (*ancestors, last))

    def scenario(self, campaign_id: str, number: int) -> str:
        """Returns the scenario of an evaluation as the text of a document."""
        url = f"/campaigns/{campaign_id}/evaluations/{number}/scenario"
        return self._client.download(url, accept="application/json").decode()

    def save_trace(self, campaign_id: str, failure: Failure, target: Path) -> None:
        """Fetches the trace of a failure, if it has one."""
        if failure.trace:
            url = f"/campaigns/{campaign_id}/evaluations/{failure.evaluation}/observations"
            target.write_bytes(self._client.download(url, accept=_PARQUET))

    def ask_for(self, campaign_id: str, request: CampaignRequest) -> CampaignRecord:
        """Pauses or cancels a campaign.

        Raises:
            ServiceError: The campaign is over, or the service did not answer.
        """
        return _record(self._client.act(f"/campaigns/{campaign_id}:{request.value}"))


def _record(item: dict[str, Any]) -> CampaignRecord:
    campaign: CampaignRecord = adapter(CampaignRecord).validate_python(item)
    return campaign


def _progress(record: CampaignRecord, answer: dict[str, Any]) -> Progress:
    first = next(iter(record.best.items()), None)
    return Progress(
        counts=record.counts,
        budget=record.budget,
        kinds=len(answer["kinds"]),
        rate=record.rate,
        left_s=record.left_s,
        best=None if first is None else (first[0], first[1].value),
        confirmed=sum(kind["confirmed"] for kind in answer["kinds"]),
        flaky=sum(kind["flaky"] for kind in answer["kinds"]),
    )


def _failure(item: dict[str, Any]) -> Failure:
    failure: Failure = adapter(Failure).validate_python(item)
    return failure


def _evaluation(item: dict[str, Any]) -> EvaluationRecord:
    status = EvaluationStatus(item["status"])
    measurement = Measurement(objectives=item["objectives"], features=item["features"])
    return EvaluationRecord(
        number=item["number"],
        proposal=Proposal(
            values=np.array(item["values"]),
            origin=item["origin"],
            generation=item["generation"],
            parents=tuple(item["parents"]),
        ),
        status=status,
        document_sha256=item["scenario_sha256"],
        report=RunReport(
            run_id=item["run_id"],
            status=RunStatus(item["run_status"]),
            verdicts=_VERDICTS.validate_python(item["verdicts"]),
            metrics=item["metrics"],
            scores=item["scores"],
            measurement=measurement if status is EvaluationStatus.JUDGED else None,
            trace_sha256=item["trace_sha256"],
            steps=item["steps"],
            sim_time_s=item["sim_time_s"],
            wall_time_s=item["wall_time_s"],
            step_cost_us=item["step_cost_us"],
            agent_cost_us=item["agent_cost_us"],
            privileged=tuple(item["privileged"]),
            failure=None if item["error"] is None else RunFailure(**item["error"]),
            versions=item["versions"],
            agents={ego: AgentChoice(**agent) for ego, agent in item["agents"].items()},
        ),
        violations=_VERDICTS.validate_python(item["failures"]),
        failure_kinds=tuple(item["failure_kinds"]),
        search_s=item["search_s"],
        prepare_s=item["prepare_s"],
    )


_VERDICTS = TypeAdapter(tuple[Verdict, ...])
