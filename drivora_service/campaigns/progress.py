"""The progress, speed and findings of a running campaign."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass

from drivora_service.campaigns.engine import Told
from drivora_service.oracles.accountability import Accountability
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaign_records import CampaignCounts, Confirmation

_WINDOW = 50
"""Number of evaluations over which the rate is measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """A campaign at one moment.

    Attributes:
        budget: Number of simulations allowed.
        kinds: Number of kinds of failures.
        rate: Recent simulations a second; ``None`` until it is known.
        left_s: Seconds until the budget is spent, at that rate.
        best: Name and least value of the tester's first objective; ``None`` if never measured.
        confirmed: Failing scenarios that an identical run confirmed.
        flaky: Failing scenarios that it did not.
    """

    counts: CampaignCounts
    budget: int
    kinds: int
    rate: float | None
    left_s: float | None
    best: tuple[str, float] | None
    confirmed: int
    flaky: int


class ProgressMeter:
    """Measures the progress of a campaign."""

    def __init__(self, budget: int, clock: Callable[[], float] = time.monotonic) -> None:
        """Begins with nothing.

        Args:
            budget: Simulations of the campaign.
            clock: Returns seconds.
        """
        self._budget, self._clock = budget, clock
        self._statuses = dict.fromkeys(EvaluationStatus, 0)
        self._violating = self._at_fault = 0
        self._accountable = Counter[Accountability | None]()
        self._kinds: set[str] = set()
        self._best: tuple[str, float] | None = None
        self._times: deque[float] = deque(maxlen=_WINDOW)
        self._answers: dict[int, Confirmation] = {}

    def note(self, told: Told) -> None:
        """Counts an evaluation."""
        record = told.record
        self._statuses[record.status] += 1
        self._violating += bool(record.violations)
        self._at_fault += record.at_fault
        self._accountable[record.accountability] += 1
        self._kinds.update(record.failure_kinds)
        if not told.replayed and record.status is not EvaluationStatus.INVALID:
            self._times.append(self._clock())
        measurement = record.report.measurement
        if measurement is None:
            return
        name, value = next(iter(measurement.objectives.items()), ("", None))
        if value is not None and (self._best is None or value < self._best[1]):
            self._best = (name, value)

    def note_again(self, number: int, confirmation: Confirmation) -> None:
        """Counts the confirmation of a failing evaluation."""
        self._answers[number] = confirmation

    def progress(self) -> Progress:
        """Returns the current progress."""
        counts = CampaignCounts(
            evaluations=sum(self._statuses.values()),
            judged=self._statuses[EvaluationStatus.JUDGED],
            invalid=self._statuses[EvaluationStatus.INVALID],
            failed=self._statuses[EvaluationStatus.FAILED],
            violating=self._violating,
            at_fault=self._at_fault,
            avoidable=self._accountable[Accountability.AVOIDABLE],
            unavoidable=self._accountable[Accountability.UNAVOIDABLE],
            undetermined=self._accountable[Accountability.UNDETERMINED],
        )
        rate = self._rate()
        answers = list(self._answers.values())
        return Progress(
            counts=counts,
            budget=self._budget,
            kinds=len(self._kinds),
            rate=rate,
            left_s=None if not rate else (self._budget - counts.simulations) / rate,
            best=self._best,
            confirmed=answers.count(Confirmation.CONFIRMED),
            flaky=answers.count(Confirmation.FLAKY),
        )

    def _rate(self) -> float | None:
        if len(self._times) < 2:
            return None
        elapsed = self._times[-1] - self._times[0]
        return (len(self._times) - 1) / elapsed if elapsed > 0.0 else None
