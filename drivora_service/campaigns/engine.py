"""The loop of a campaign: ask for candidates, have them evaluated, tell the results.

Candidates are numbered as they are proposed and told strictly in that order, one at a time, with a
fixed number of them waiting. So the sequence is a function of the campaign alone: it depends
neither on how long runs take nor on the number of workers. Resuming is the same loop with stored
evaluations in place of runs.
"""

from __future__ import annotations

import hashlib
import time
import traceback
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from drivora_service.campaigns.candidates import Candidate, Candidates
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.journal import Journal
from drivora_service.campaigns.judging import (
    evaluation_of,
    refuse_lost,
    status_of,
    violations_of,
)
from drivora_service.errors import CampaignError, DrivoraError, PluginError
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.encoding import report_from_json, report_to_json
from drivora_service.runs.report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.search.tester import EvaluationStatus, Proposal, Tester
from drivora_service.store.campaign_records import CampaignRequest, EvaluationRecord

_POLL_S = 0.5
"""Seconds between two checks for a request to stop while runs are in flight."""

_SPARE_INVALID = 100
"""Number of invalid candidates that a campaign may propose beyond its budget."""

_LOG = 4000
"""Number of characters of a tester's traceback that are kept."""

_MAX_INITIAL_FAILURES = 20
"""Number of failed runs after which a campaign without a judged run fails."""

T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """A campaign, ready to run.

    Attributes:
        run_prefix: Prefix of the ids of the runs; the number follows.
        feedback: The feedback that the tester asks for.
        kind_of: Returns the kind of failure of a violation.
    """

    run_prefix: str
    tester: Tester
    candidates: Candidates
    feedback: FeedbackChoice
    oracles: frozenset[str]
    budget: int
    lookahead: int
    kind_of: Callable[[Verdict], str]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Told:
    """An evaluation that the tester has just been told.

    Attributes:
        replayed: Whether it came from the journal.
    """

    record: EvaluationRecord
    replayed: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Waiting:
    """A candidate that has not been told yet, and its stored evaluation if there is one."""

    number: int
    proposal: Proposal
    candidate: Candidate
    stored: EvaluationRecord | None
    prepare_s: float


class Engine:
    """Runs one campaign, once."""

    def __init__(
        self,
        search: Search,
        evaluator: Evaluator,
        journal: Journal,
        *,
        requested: Callable[[], CampaignRequest] = lambda: CampaignRequest.NONE,
        on_told: Callable[[Told], None] = lambda _told: None,
    ) -> None:
        """Prepares the loop.

        Args:
            search: The campaign.
            evaluator: Must have no other user meanwhile.
            journal: Record of the campaign; its evaluations are told again first.
            requested: Returns a pending request to stop.
            on_told: Called after each told evaluation.
        """
        self._search, self._evaluator, self._journal = search, evaluator, journal
        self._requested, self._on_told = requested, on_told
        self._stored = journal.evaluations()
        self._waiting: deque[_Waiting] = deque()
        self._reports: dict[int, RunReport] = {}
        self._next = 0
        self._valid = self._invalid = self._judged = self._failed = 0
        self._search_s = 0.0

    def run(self) -> CampaignRequest:
        """Runs until the budget is spent, the tester has ended, or a stop is requested.

        Returns:
            The request that ended it, or none.

        Raises:
            CampaignError: It cannot continue, or does not match the journal.
            PluginError: The tester raised.
            SearchError: The tester violated its protocol.
        """
        self._ask()
        while self._waiting:
            request = self._await(self._waiting[0])
            if request is not CampaignRequest.NONE:
                return request
            self._tell(self._waiting.popleft())
            self._ask()
        return CampaignRequest.NONE

    def _ask(self) -> None:
        search = self._search
        room = min(search.lookahead - len(self._waiting), search.budget - self._valid)
        if room < 1:
            return
        for proposal in self._proposals(room):
            begun = time.perf_counter()
            candidate = search.candidates.prepare(proposal.values)
            waiting = _Waiting(
                number=self._next,
                proposal=replace(proposal, values=candidate.values),
                candidate=candidate,
                stored=next(self._stored, None),
                prepare_s=time.perf_counter() - begun,
            )
            self._next += 1
            self._take(waiting)
            self._waiting.append(waiting)

    def _proposals(self, room: int) -> tuple[Proposal, ...]:
        """Asks the tester, and checks its proposals.

        Raises:
            CampaignError: It proposes too many candidates, or values that are no finite numbers.
        """
        proposals = self._timed("asked", lambda: self._search.tester.ask(room))
        if len(proposals) > room:
            raise CampaignError(
                f"the tester was asked for at most {room} candidates and proposed {len(proposals)}"
            )
        genes = self._search.candidates.genes
        for proposal in proposals:
            values = proposal.values
            if values.shape != (len(genes),) or not np.isfinite(values).all():
                raise CampaignError(
                    f"the tester proposed values of shape {values.shape}, "
                    f"{np.count_nonzero(~np.isfinite(values))} of them not finite; needed are "
                    f"{len(genes)} numbers, one a gene"
                )
        return proposals

    def _take(self, waiting: _Waiting) -> None:
        """Counts a new candidate, and has it evaluated unless the journal has its evaluation."""
        if waiting.stored is not None:
            _compare(waiting, waiting.stored)
        if waiting.candidate.problem:
            self._invalid += 1
            if self._invalid > self._search.budget + _SPARE_INVALID:
                raise CampaignError(
                    f"{self._invalid} of {self._next} candidates were no valid scenarios, the last "
                    f"one because: {waiting.candidate.problem}. Vary fewer parts, or start with "
                    "another scenario"
                )
            return
        self._valid += 1
        if waiting.stored is None:
            spec = RunSpec(
                run_id=f"{self._search.run_prefix}-{waiting.number}",
                document=waiting.candidate.document,
                feedback=self._search.feedback,
            )
            self._evaluator.submit(waiting.number, spec)

    def _await(self, waiting: _Waiting) -> CampaignRequest:
        """Waits for the result of a candidate, or a request to stop."""
        if waiting.stored is not None:
            return CampaignRequest.NONE
        while True:
            request = self._requested()
            known = waiting.candidate.problem or waiting.number in self._reports
            if known or request is not CampaignRequest.NONE:
                return request
            for answer in self._evaluator.wait(_POLL_S):
                self._reports[answer.number] = answer.report

    def _tell(self, waiting: _Waiting) -> None:
        record = waiting.stored
        if record is None:
            record = self._record(waiting)
            self._journal.append(record, waiting.candidate.document)
        # Also for a replayed evaluation: its time was counted before the campaign was resumed.
        self._search_s = 0.0
        self._timed("told", lambda: self._search.tester.tell(evaluation_of(record)))
        self._judged += record.status is EvaluationStatus.JUDGED
        self._failed += record.status is EvaluationStatus.FAILED
        self._on_told(Told(record=record, replayed=waiting.stored is not None))
        if (
            self._failed >= _MAX_INITIAL_FAILURES
            and not self._judged
            and record.report.failure is not None
        ):
            raise CampaignError(
                f"none of the first {self._failed} runs could be judged, the last one because: "
                f"{record.report.failure.message}"
            )

    def _record(self, waiting: _Waiting) -> EvaluationRecord:
        if waiting.candidate.problem:
            failure = RunFailure(cause="invalid_document", message=waiting.candidate.problem)
            run_id = f"{self._search.run_prefix}-{waiting.number}"
            report = RunReport(run_id=run_id, status=RunStatus.INVALID, failure=failure)
            status = EvaluationStatus.INVALID
        else:
            report = self._reports.pop(waiting.number)
            refuse_lost(waiting.number, report)
            # As it is read from the journal: a replayed evaluation must be told identically.
            report = report_from_json(report_to_json(report))
            status = status_of(report)
        violations = violations_of(report, self._search.oracles)
        document = waiting.candidate.document
        return EvaluationRecord(
            number=waiting.number,
            proposal=waiting.proposal,
            status=status,
            document_sha256=_sha256(document),
            report=report,
            violations=violations,
            failure_kinds=tuple(self._search.kind_of(verdict) for verdict in violations),
            search_s=self._search_s,
            prepare_s=waiting.prepare_s,
        )

    def _timed(self, call: str, work: Callable[[], T]) -> T:
        """Calls the tester and attributes its exceptions to it."""
        begun = time.perf_counter()
        try:
            return work()
        except DrivoraError:
            raise
        except (Exception, SystemExit) as error:
            raise PluginError(
                f"the tester raised {type(error).__name__} when it was {call}: {error}",
                cause="tester_raised",
                log="".join(traceback.format_exception(error))[-_LOG:],
            ) from error
        finally:
            self._search_s += time.perf_counter() - begun


def _compare(waiting: _Waiting, stored: EvaluationRecord) -> None:
    """Checks that a candidate equals the one of its stored evaluation.

    Raises:
        CampaignError: It does not.
    """
    new, old = waiting.proposal, stored.proposal
    if not np.array_equal(new.values, old.values):
        what = "other values"
    elif (new.origin, new.generation, new.parents) != (old.origin, old.generation, old.parents):
        what = "another origin"
    elif _sha256(waiting.candidate.document) != stored.document_sha256:
        what = "another scenario"
    else:
        return
    raise CampaignError(
        f"evaluation {waiting.number} has {what} than the stored one: the program, a plug-in or "
        "the road network has changed since. Resume the campaign with the original versions, or "
        "start a new one"
    )


def _sha256(document: str) -> str:
    return hashlib.sha256(document.encode()).hexdigest() if document else ""
