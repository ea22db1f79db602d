"""The minimiser: asked for trials and told their results, it finds the smallest document.

It is deterministic: the results alone determine the result, not their order nor how many trials
are made at the same time. A minimiser that is made anew and told the stored results goes on where
the other one was.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.suites.minimization.later_starts import Recording
from drivora_service.suites.minimization.proposal_checking import CheckedDocument
from drivora_service.suites.minimization.reduction_search import (
    PROOF,
    Question,
    Reductions,
    State,
    Taken,
    smallest,
)
from drivora_service.suites.minimization.shortening import Failure


class Purpose(StrEnum):
    """Why a document is run."""

    REPRODUCE = "r"
    TRY = "t"
    OBSERVE = "o"
    """To see how the scenario came to its failure."""
    CONFIRM = "c"


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """A document to be run.

    Attributes:
        checked: The document.
        label: What has been reduced.
        purpose: Why it is run; what is no mere try is to be recorded.
    """

    checked: CheckedDocument
    label: str
    purpose: Purpose = Purpose.TRY

    @property
    def key(self) -> str:
        """Name of the trial, unique among all trials of the minimisation."""
        return f"{self.checked.sha256}{self.purpose}"


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialResult:
    """The result of a trial.

    Attributes:
        failure: Its failure, if it is the same one; else ``None``.
        recording: Its run, if it was recorded.
    """

    failure: Failure | None
    recording: Recording | None = None


class Phase(StrEnum):
    """What a minimiser does, and how it ended."""

    REPRODUCING = "reproducing"
    SEARCHING = "searching"
    CONFIRMING = "confirming"
    DONE = "done"
    NOT_REPRODUCED = "not_reproduced"
    """The run of the same document does not fail in the same way."""
    NOT_CONFIRMED = "not_confirmed"
    """A second run of the smallest document does not."""


class Minimizer:
    """Reduces one document.

    Attributes:
        phase: What it does.
        stage: What is being reduced, in one or two words.
        original: The document to begin with; ``None`` before its failure was reproduced.
        state: The smallest document so far; ``None`` before that, too.
        decided: Number of trials that the search needed so far, which is the same on any number
            of workers. A document that was tried before needs none.
        is_one_minimal: Whether every single reduction of the document was tried and none of them
            fails in the same way.
    """

    def __init__(
        self,
        document: ScenarioDocument,
        *,
        check: Callable[[ScenarioDocument], CheckedDocument | None],
        reductions: Reductions,
        budget: int,
    ) -> None:
        """Creates a minimiser whose first wanted trial is the reproduction of the failure.

        Args:
            document: A document that can be run.
            check: Returns a document that can be run; ``None`` if it cannot.
            reductions: The reductions that are tried.
            budget: Greatest number of trials that the search may need.

        Raises:
            ValueError: The document cannot be run.
        """
        checked = check(document)
        if checked is None:
            raise ValueError("the document cannot be run here")
        self._check, self._reductions, self._budget = check, reductions, budget
        self._first = Trial(checked=checked, label="as it was", purpose=Purpose.REPRODUCE)
        # Results may come ahead of the search, in any order. A trial counts against the budget when
        # the search needs it in its own order, and once only. Documents that were the smallest are
        # visited, and not taken again: the search ends.
        self._results: dict[str, TrialResult] = {}
        self._counted: set[str] = set()
        self._visited: set[str] = set()
        self._question = Question(stage="", proposals=())
        self._by_number: dict[int, CheckedDocument | None] = {}
        self._next = 0
        self._present = checked.sha256
        self._has_circle = False
        self.phase, self.stage = Phase.REPRODUCING, ""
        self.original: State | None = None
        self.state: State | None = None
        self.decided = 0
        self.is_one_minimal = False

    @property
    def is_over(self) -> bool:
        """Whether no more trials are needed."""
        return self.phase in (Phase.DONE, Phase.NOT_REPRODUCED, Phase.NOT_CONFIRMED)

    @property
    def _document(self) -> ScenarioDocument | None:
        return None if self.state is None else self.state.document

    @property
    def reproduction(self) -> Trial:
        """The trial that reproduces the failure."""
        return self._first

    @property
    def confirmation(self) -> Trial:
        """The trial that confirms the smallest document.

        Raises:
            ValueError: The failure is not reproduced yet.
        """
        checked = None if self.state is None else self._check(self.state.document)
        if checked is None:
            raise ValueError("there is no document to be confirmed yet")
        return Trial(checked=checked, label="the smallest", purpose=Purpose.CONFIRM)

    def tell(self, key: str, result: TrialResult) -> None:
        """Takes the result of a trial; one that is known already is unchanged."""
        if key not in self._results:
            self._results[key] = result
            self._advance()

    def choose_trials(self, most: int) -> tuple[Trial, ...]:
        """Returns the next trials without a result, those that are needed first.

        Args:
            most: Greatest number of trials.
        """
        match self.phase:
            case Phase.REPRODUCING:
                return (self.reproduction,)
            case Phase.CONFIRMING:
                return (self.confirmation,)
            case Phase.SEARCHING:
                # More than is left of the budget cannot be needed.
                return self._open(min(most, self._budget - self.decided))
        return ()

    def _open(self, most: int) -> tuple[Trial, ...]:
        # Proposals behind the first one are tried ahead, for the case that none before them fails
        # in the same way: otherwise they are not needed.
        found: dict[str, Trial] = {}
        for number in range(self._next, len(self._question.proposals)):
            if len(found) >= most:
                break
            checked = self._check_proposal(number)
            if checked is None:
                continue
            trial = self._trial(checked, self._question.proposals[number].label)
            result = self._results.get(trial.key)
            if result is None:
                found.setdefault(trial.key, trial)
            elif result.failure is not None:
                # It will be taken: what comes behind it is not needed.
                break
        return tuple(found.values())

    def _advance(self) -> None:
        """Goes as far as the results allow."""
        if self.phase is Phase.REPRODUCING:
            self._begin()
        if self.phase is Phase.SEARCHING:
            self._search_on()
        if self.phase is Phase.CONFIRMING:
            result = self._results.get(self.confirmation.key)
            if result is not None:
                self.phase = Phase.NOT_CONFIRMED if result.failure is None else Phase.DONE

    def _begin(self) -> None:
        result = self._results.get(self.reproduction.key)
        if result is None:
            return
        if result.failure is None:
            self.phase = Phase.NOT_REPRODUCED
            return
        # The result of the reproduction is also that of trying the original document, which some
        # proposal may lead back to, and which must not be simulated or counted again.
        first = self._first.checked
        self.original = State(document=first.document, failure=result.failure)
        self.state = self.original
        same = self._trial(first).key
        self._results[same] = result
        self._counted.add(same)
        self._visited.add(first.sha256)
        self._search = smallest(self.state, self._reductions)
        self.phase = Phase.SEARCHING
        self._ask(lambda: next(self._search))

    def _search_on(self) -> None:
        while self.phase is Phase.SEARCHING:
            if self._next == len(self._question.proposals):
                self._ask(lambda: self._search.send(None))
                continue
            checked = self._check_proposal(self._next)
            if checked is not None:
                key = self._trial(checked).key
                result = self._results.get(key)
                if key not in self._counted:
                    # The budget before the result: one that was found ahead, with more workers,
                    # must not lead further than the same search with one worker.
                    if self.decided == self._budget:
                        self.phase = Phase.CONFIRMING
                        return
                    if result is None:
                        return
                    self._counted.add(key)
                    self.decided += 1
                if result is not None and result.failure is not None:
                    self._take(checked, result)
                    continue
            self._next += 1

    def _trial(self, checked: CheckedDocument, label: str = "the present one") -> Trial:
        # The purpose is part of the key: a document that was tried without a trace has to be run
        # again to be observed.
        is_observed = self._question.is_for_recording
        purpose = Purpose.OBSERVE if is_observed else Purpose.TRY
        return Trial(checked=checked, label=label or "to see how it fails", purpose=purpose)

    def _take(self, checked: CheckedDocument, result: TrialResult) -> None:
        assert result.failure is not None
        recording = result.recording
        state = State(document=checked.document, failure=result.failure, recording=recording)
        self.state, self._present = state, checked.sha256
        self._visited.add(checked.sha256)
        taken = Taken(number=self._next, state=state)
        self._ask(lambda: self._search.send(taken))

    def _ask(self, step: Callable[[], Question]) -> None:
        try:
            self._question, self._next = step(), 0
            self._by_number.clear()
            self.stage = self._question.stage
        except StopIteration:
            # The search ends only after its proof found nothing; see reduction_search.smallest().
            self.is_one_minimal = not self._has_circle
            self.phase = Phase.CONFIRMING

    def _check_proposal(self, number: int) -> CheckedDocument | None:
        """Returns a proposal of the question; ``None`` if it cannot be run, or leads in a circle.

        A proposal may be the same scenario as the present one, in simpler words.
        """
        if number not in self._by_number:
            document = self._question.proposals[number].document()
            checked = None if document is None else self._check(document)
            if checked is not None and not self._question.is_for_recording:
                # The hash is that of the scenario, so that a simpler wording has the same one: it
                # is taken without a simulation, unless nothing at all has changed.
                if checked.sha256 == self._present:
                    # Else it would be taken again and again.
                    checked = None if document == self._document else checked
                elif checked.sha256 in self._visited:
                    # It fails in the same way and would be taken. If it is among the proposals of
                    # the proof, a single reduction is possible: the result is not 1-minimal.
                    self._has_circle |= self.stage == PROOF
                    checked = None
            self._by_number[number] = checked
        return self._by_number[number]
