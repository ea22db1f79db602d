"""The evaluator on the workers of a service, through the queue in its database."""

from __future__ import annotations

import hashlib
import time
from collections import deque
from collections.abc import Callable, Sequence
from functools import lru_cache

from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.campaigns.evaluator import Answer
from drivora_service.oracles.verdicts.failure_definition import definition_of, definition_to_json
from drivora_service.runs.candidate import Candidate
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.scenario.canonical import from_canonical
from drivora_service.store.campaigns.campaign_records import CampaignRecord
from drivora_service.store.database import Database
from drivora_service.store.runs.run_records import NewRun, RunOptions
from drivora_service.store.traces.stored_traces import last_attempt
from drivora_service.store.traces.trace_places import TracePlaces

_FIRST_POLL_S = 0.01
_LONGEST_POLL_S = 0.05
_BLIND_POLL_S = 0.25
"""The same where the database does not tell whether it has changed, so that each look is a query.
"""
_SLOWER = 1.5


class QueueEvaluator:
    """Queues each evaluation as a run of the campaign's batch, and polls for its report.

    Nothing is read while the database does not change.

    The runs have the ids of their specs. So a campaign that is resumed after a kill may submit runs
    that exist already: those that are queued, running or ended are not queued again.
    """

    def __init__(
        self,
        database: Database,
        campaign: CampaignRecord,
        places: TracePlaces,
        *,
        most: int | None = None,
        on_queued: Callable[[], None] = lambda: None,
    ) -> None:
        """Resumes the batch of the campaign.

        Args:
            database: Database of the service.
            campaign: The campaign.
            places: Where the workers write traces.
            most: Greatest number of runs queued or running at once; ``None``: any number.
            on_queued: Called after a run was queued.
        """
        self._database, self._campaign = database, campaign
        self._traces, self._failure_traces = places.of_runs(), places.of_failures()
        self._most, self._on_queued = most, on_queued
        self._definition = definition_to_json(definition_of(campaign.document))
        self._has_several_seeds = bool(campaign.document.get("scenarios"))
        self._held: deque[tuple[int, RunSpec]] = deque()
        self._open: dict[str, tuple[int, RunSpec]] = {}
        self._changes: int | None = None
        with database.write() as transaction:
            self._batch_id = transaction.campaign_runs.open(campaign.id)

    def submit(self, runs: Sequence[tuple[int, RunSpec]]) -> None:
        """Queues runs, or holds them back until there is room for them."""
        self._held += runs
        self._queue()

    def wait(self, timeout: float | None = None) -> tuple[Answer, ...]:
        """Returns the answers since the last call; waits for one, ``timeout`` seconds at most."""
        until = None if timeout is None else time.monotonic() + timeout
        pause = _FIRST_POLL_S
        while self._open:
            answers = self._answers()
            if answers:
                self._queue()
                return answers
            left = pause if until is None else until - time.monotonic()
            if left <= 0.0:
                break
            time.sleep(min(pause, left))
            longest = _BLIND_POLL_S if self._changes is None else _LONGEST_POLL_S
            pause = min(pause * _SLOWER, longest)
        return ()

    def close(self) -> None:
        """Stops waiting; queued runs continue as long as their campaign is running."""
        self._held.clear()
        self._open.clear()

    def _queue(self) -> None:
        room = len(self._held) if self._most is None else self._most - len(self._open)
        coming = [self._held.popleft() for _ in range(min(room, len(self._held)))]
        if not coming:
            return
        with self._database.write() as transaction:
            transaction.campaign_runs.put(
                self._batch_id, *(self._run(number, spec) for number, spec in coming)
            )
        self._open.update((spec.run_id, (number, spec)) for number, spec in coming)
        # Some may have ended already.
        self._changes = None
        self._on_queued()

    def _run(self, number: int, spec: RunSpec) -> NewRun:
        document = spec.document if spec.candidate is None else spec.candidate.space.seed
        return NewRun(
            document=document,
            scenario_sha256=hashlib.sha256(document.encode()).hexdigest(),
            town=_town_of(document) if self._has_several_seeds else self._campaign.town,
            agent=self._campaign.agent,
            configuration=AgentConfiguration(
                words=self._campaign.configuration, id=self._campaign.configuration_id
            ),
            options=RunOptions(
                agent_override=spec.agent,
                seed_override=spec.seed,
                definition=self._definition,
            ),
            label=_label(self._campaign.name, number),
            item=max(number, 0),
            feedback=spec.feedback,
            keeps_trace=bool(spec.trace_path),
            run_id=spec.run_id,
            candidate=spec.candidate,
        )

    def _answers(self) -> tuple[Answer, ...]:
        changes = self._database.changes.value()
        if changes is not None and changes == self._changes:
            return ()
        with self._database.read() as transaction:
            ended = transaction.campaign_runs.read_reports(list(self._open))
        self._changes = changes
        self._forget_policies([report.run_id for report, _ in ended])
        return tuple(self._answer(report, candidate) for report, candidate in ended)

    def _forget_policies(self, run_ids: Sequence[str]) -> None:
        """Removes the policies of adversaries from runs that have ended: they are large."""
        played = [
            run_id
            for run_id in run_ids
            if (source := self._open[run_id][1].candidate) is not None
            and source.adversary is not None
        ]
        if played:
            with self._database.write() as transaction:
                transaction.campaign_runs.forget_policies(played)

    def _answer(self, report: RunReport, candidate: Candidate | None) -> Answer:
        number, spec = self._open.pop(report.run_id)
        if spec.trace_path and report.trace_sha256:
            with self._database.read() as transaction:
                attempt = last_attempt(transaction.session, report.run_id)
            written = self._traces.address(report.run_id, attempt)
            self._failure_traces.take(written, spec.trace_path)
        return Answer(number=number, report=report, candidate=candidate)


def _label(campaign: str, number: int) -> str:
    """Returns the label of a run; seed scenarios have negative numbers."""
    return f"{campaign[:150]} #{number}" if number >= 0 else f"{campaign[:150]} seed {-number}"


@lru_cache(maxsize=64)
def _town_of(document: str) -> str:
    """Returns the road network of a scenario; before a run it is one of few seed scenarios."""
    return from_canonical(document).map_region.town
