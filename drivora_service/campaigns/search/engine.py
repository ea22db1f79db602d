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

from drivora_service.campaigns.evaluator import Answer, Evaluator
from drivora_service.campaigns.records.journal import Journal
from drivora_service.campaigns.search.evaluation_judging import (
    evaluation_of,
    refuse_lost,
    status_of,
    violations_of,
)
from drivora_service.campaigns.search.seed_turns import SearchPart, Turn, Turns
from drivora_service.campaigns.search.tester_calls import TesterCall, out_of_memory
from drivora_service.errors import CampaignError, DrivoraError, PluginError
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.foreign_errors import exception_place
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.runs.candidate import CandidateSource
from drivora_service.runs.run_report import RunSpec
from drivora_service.search.tester import EvaluationStatus, Proposal
from drivora_service.store.campaigns.campaign_records import CampaignRequest, EvaluationRecord

_POLL_S = 0.5
"""Seconds between two checks for a request to stop while runs are in flight."""

_SPARE_INVALID = 100
"""Number of invalid candidates that a campaign may propose beyond its budget."""

_COMPARED_EVERY = 50
"""Of so many replayed evaluations one is decoded again and compared."""

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
        parts: The search from each seed scenario.
        feedback: The feedback that the testers ask for.
        definition: What counts as a failure.
        seed_names: Names of the seed scenarios, one a part; none if there is only one.
        tester: The words for the tester in messages.
    """

    run_prefix: str
    parts: tuple[SearchPart, ...]
    feedback: FeedbackChoice
    definition: FailureDefinition
    budget: int
    lookahead: int
    seed_names: tuple[str, ...] = ()
    tester: str = "tester"

    @property
    def genes(self) -> int:
        """Numbers that describe a candidate; the most, if seed scenarios differ."""
        return max(len(part.candidates.genes) for part in self.parts)


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
    """A proposal that has not been told yet, and its stored evaluation if there is one."""

    number: int
    turn: Turn
    proposal: Proposal
    asked_sha256: str
    stored: EvaluationRecord | None


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
        on_call: Callable[[TesterCall], None] = lambda _call: None,
    ) -> None:
        """Creates the engine; :meth:`run` runs the campaign.

        Args:
            search: The campaign.
            evaluator: Must have no other user meanwhile.
            journal: Record of the campaign; the testers first receive its evaluations again.
            requested: Returns a pending request to stop.
            on_told: Called after each told evaluation.
            on_call: Called when a call of the tester begins, and with ``NONE`` when it ends.
        """
        self._search, self._evaluator, self._journal = search, evaluator, journal
        self._requested, self._on_told, self._on_call = requested, on_told, on_call
        self._stored = journal.evaluations()
        self._turns = Turns(search.parts)
        self._waiting: deque[_Waiting] = deque()
        self._answers: dict[int, Answer] = {}
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
        try:
            return self._run()
        finally:
            self._journal.flush()

    def _run(self) -> CampaignRequest:
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
        new: list[tuple[int, RunSpec]] = []
        self._turns.begin()
        while (room := min(search.lookahead - len(self._waiting), search.budget - self._valid)) > 0:
            turn = self._turns.next()
            if turn is None:
                break
            # With several seed scenarios one candidate a turn, so that they stay abreast.
            wanted = room if len(search.parts) == 1 else 1
            proposals = self._proposals(turn.part, wanted)
            if len(proposals) < wanted:
                turn.is_dry = True
            for proposal in proposals:
                waiting = _Waiting(
                    number=self._next,
                    turn=turn,
                    proposal=turn.take(proposal, self._next),
                    asked_sha256=_sha256(_encode_proposal(proposal)),
                    stored=next(self._stored, None),
                )
                self._next += 1
                # Whether it is valid is found by the worker, and counts with its evaluation.
                self._valid += 1
                if waiting.stored is None:
                    new.append((waiting.number, self._spec(waiting)))
                else:
                    self._compare(waiting, waiting.stored)
                self._waiting.append(waiting)
        if new:
            self._evaluator.submit(new)

    def _spec(self, waiting: _Waiting) -> RunSpec:
        return RunSpec(
            run_id=f"{self._search.run_prefix}-{waiting.number}",
            document="",
            feedback=self._search.feedback,
            candidate=CandidateSource(
                space=waiting.turn.part.candidates.source,
                values=tuple(waiting.proposal.values.tolist()),
                reference=waiting.proposal.reference,
                adversary=waiting.proposal.adversary,
            ),
        )

    def _proposals(self, part: SearchPart, room: int) -> tuple[Proposal, ...]:
        """Asks a tester, and checks its proposals.

        Raises:
            CampaignError: It proposes too many candidates, or values that are no finite numbers.
        """
        proposals = self._call_tester(TesterCall.ASK, lambda: part.tester.ask(room))
        if len(proposals) > room:
            raise CampaignError(
                f"the tester was asked for at most {room} candidates and proposed {len(proposals)}"
            )
        genes = part.candidates.genes
        for proposal in proposals:
            values = proposal.values
            if values.shape != (len(genes),) or not np.isfinite(values).all():
                raise CampaignError(
                    f"the tester proposed values of shape {values.shape}, "
                    f"{np.count_nonzero(~np.isfinite(values))} of them not finite; needed are "
                    f"{len(genes)} numbers, one a gene"
                )
        return proposals

    def _await(self, waiting: _Waiting) -> CampaignRequest:
        """Waits for the result of a candidate, or a request to stop."""
        if waiting.stored is not None:
            return CampaignRequest.NONE
        while True:
            request = self._requested()
            if waiting.number in self._answers or request is not CampaignRequest.NONE:
                return request
            self._journal.write_due()
            for answer in self._evaluator.wait(_POLL_S):
                self._answers[answer.number] = answer

    def _tell(self, waiting: _Waiting) -> None:
        record = waiting.stored
        if record is None:
            answer = self._answers.pop(waiting.number)
            refuse_lost(answer)
            record = self._record(waiting, answer)
            document = "" if answer.candidate is None else answer.candidate.document
            self._journal.append(record, document)
        # Also for a replayed evaluation: its time was counted before the campaign was resumed.
        self._search_s = 0.0
        evaluation = waiting.turn.of_tester(evaluation_of(record))
        self._call_tester(TesterCall.TELL, lambda: waiting.turn.part.tester.tell(evaluation))
        self._judged += record.status is EvaluationStatus.JUDGED
        self._failed += record.status is EvaluationStatus.FAILED
        self._on_told(Told(record=record, replayed=waiting.stored is not None))
        if record.status is EvaluationStatus.INVALID:
            waiting.turn.valid -= 1
            self._count_invalid(record)
        if (
            self._failed >= _MAX_INITIAL_FAILURES
            and not self._judged
            and record.report.failure is not None
        ):
            raise CampaignError(
                f"none of the first {self._failed} runs could be judged, the last one because: "
                f"{record.report.failure.message}"
            )

    def _count_invalid(self, record: EvaluationRecord) -> None:
        """Takes an invalid candidate, which is not simulated, out of the budget.

        Raises:
            CampaignError: There are too many.
        """
        self._valid -= 1
        self._invalid += 1
        if self._invalid > self._search.budget + _SPARE_INVALID:
            why = "" if record.report.failure is None else record.report.failure.message
            raise CampaignError(
                f"{self._invalid} of {record.number + 1} candidates were no valid scenarios, the "
                f"last one because: {why}. Vary fewer parts, or start with another scenario"
            )

    def _record(self, waiting: _Waiting, answer: Answer) -> EvaluationRecord:
        candidate, report = answer.candidate, answer.report
        if candidate is None:
            raise CampaignError(
                f"evaluation {waiting.number} has no scenario: its worker ended while it decoded "
                "the genes. Resume the campaign to try it again"
            )
        status = EvaluationStatus.INVALID if candidate.problem else status_of(report)
        violations = violations_of(report, self._search.definition)
        return EvaluationRecord(
            number=waiting.number,
            proposal=replace(waiting.proposal, values=np.array(candidate.values)),
            status=status,
            document_sha256=_sha256(candidate.document.encode()),
            report=report,
            violations=violations,
            strongest=self._search.definition.strongest(report.verdicts),
            failure_kinds=tuple(map(waiting.turn.part.kind_of, violations)),
            search_s=self._search_s,
            prepare_s=candidate.prepare_s,
            asked_sha256=waiting.asked_sha256,
            seed_number=waiting.turn.place,
        )

    def _compare(self, waiting: _Waiting, stored: EvaluationRecord) -> None:
        """Checks that a proposal is that of its stored evaluation.

        What it decodes to is compared now and then: it depends on versions that are checked, and
        takes as long as a part of a simulation.

        Raises:
            CampaignError: It is another one.
        """
        new, old = waiting.proposal, stored.proposal
        problem = ""
        if _provenance(new) != _provenance(old):
            problem = "another origin"
        elif stored.asked_sha256 not in ("", waiting.asked_sha256):
            problem = "other values"
        elif not stored.asked_sha256 or waiting.number % _COMPARED_EVERY == 0:
            candidate = waiting.turn.part.candidates.prepare(new.values, new.reference)
            if candidate.values != tuple(old.values.tolist()):
                problem = "other values"
            elif (
                # What an adversary does is known after a run only.
                new.adversary is None
                and _sha256(candidate.document.encode()) != stored.document_sha256
            ):
                problem = "another scenario"
        if problem:
            raise CampaignError(
                f"evaluation {waiting.number} has {problem} than the stored one: the program, a "
                "plug-in or the road network has changed since. Resume the campaign with the "
                "original versions, or start a new one"
            )

    def _call_tester(self, call: TesterCall, work: Callable[[], T]) -> T:
        """Calls the tester and attributes its exceptions to it."""
        # Of this thread: other campaigns of the process take turns with it.
        begun = time.thread_time()
        self._on_call(call)
        try:
            return work()
        except DrivoraError:
            raise
        except MemoryError as error:
            # What the tester's frames hold would leave no memory to store the failure.
            traceback.clear_frames(error.__traceback__)
            raise PluginError(out_of_memory(call), cause="tester_out_of_memory", log="") from None
        except (Exception, SystemExit) as error:
            raise PluginError(
                f"the {self._search.tester} raised {type(error).__name__} when it {call.words}: "
                f"{error}{exception_place(error)}",
                cause="tester_raised",
                log="".join(traceback.format_exception(error))[-_LOG:],
            ) from error
        finally:
            self._on_call(TesterCall.NONE)
            self._search_s += time.thread_time() - begun


def _provenance(proposal: Proposal) -> tuple[object, ...]:
    """Returns how a candidate was made."""
    return proposal.origin, proposal.generation, proposal.parents, proposal.redrawn


def _encode_proposal(proposal: Proposal) -> bytes:
    """Returns what identifies a proposal when its campaign is resumed.

    The policy of an adversary is left out: it follows from evaluations that are compared, and a
    tester that has a checkpoint need not make it again.
    """
    adversary = proposal.adversary
    if adversary is None:
        return proposal.values.tobytes()
    rest = replace(adversary, policy="")
    return proposal.values.tobytes() + repr(rest).encode()


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest() if data else ""
