"""The journal of a campaign."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

from drivora_service.errors import UnknownName
from drivora_service.store.campaigns.campaign_records import Confirmation, EvaluationRecord, Failure
from drivora_service.store.campaigns.seed_run_records import SeedRun


class Journal(Protocol):
    """The record of a campaign, from which it can be resumed."""

    def evaluations(self, *, violating: bool = False) -> Iterator[EvaluationRecord]:
        """Yields the evaluations in order; may be read while more are appended.

        Args:
            violating: Only those with a failure.
        """
        ...

    def append(self, record: EvaluationRecord, document: str) -> None:
        """Takes the next evaluation.

        It is durable after :meth:`flush`, or once :meth:`write_due` was called some time after.

        Args:
            record: The evaluation; its number is the previous one plus 1.
            document: Canonical JSON text of the scenario; "" if there is none.
        """
        ...

    def write_due(self) -> None:
        """Writes evaluations that have waited long enough to be written together."""
        ...

    def flush(self) -> None:
        """Writes every evaluation that waits, durably when the call returns."""
        ...

    def document(self, number: int) -> str:
        """Returns the canonical JSON text of an evaluation's scenario.

        Raises:
            UnknownName: There is none.
        """
        ...

    def failures(self) -> tuple[Failure, ...]:
        """Returns every violation of every evaluation, in order."""
        ...

    def open_numbers(self) -> frozenset[int]:
        """Returns the numbers of the evaluations whose failures were not run again yet."""
        ...

    def confirm(self, number: int, confirmation: Confirmation, trace: str) -> None:
        """Writes whether an identical run repeated the failures of an evaluation."""
        ...

    def group(self, groups: Mapping[tuple[int, int], int]) -> None:
        """Writes the groups of failures, by number of the evaluation and place."""
        ...

    def seed_runs(self) -> tuple[SeedRun, ...]:
        """Returns the runs of seed scenarios that were kept."""
        ...

    def keep_seed_runs(self, runs: tuple[SeedRun, ...]) -> None:
        """Writes the runs of seed scenarios, in place of those before."""
        ...


def failures_of(record: EvaluationRecord) -> tuple[Failure, ...]:
    """Returns the failures of an evaluation."""
    return tuple(
        Failure(evaluation=record.number, place=place, kind=kind, verdict=verdict)
        for place, (verdict, kind) in enumerate(
            zip(record.violations, record.failure_kinds, strict=True)
        )
    )


class MemoryJournal:
    """A journal in memory, for studies and tests."""

    def __init__(self, evaluations: Sequence[EvaluationRecord] = ()) -> None:
        """Creates a journal of known evaluations, without their documents."""
        self._evaluations = list(evaluations)
        self._documents: dict[int, str] = {}
        self._failures = [failure for record in evaluations for failure in failures_of(record)]
        self._seed_runs: tuple[SeedRun, ...] = ()

    def evaluations(self, *, violating: bool = False) -> Iterator[EvaluationRecord]:
        """Yields the evaluations in order."""
        found = tuple(self._evaluations)
        return (record for record in found if record.violations or not violating)

    def append(self, record: EvaluationRecord, document: str) -> None:
        """Keeps the next evaluation; documents only of those with failures."""
        if record.number != len(self._evaluations):
            raise ValueError(f"evaluation {record.number} follows {len(self._evaluations) - 1}")
        self._evaluations.append(record)
        if record.violations:
            self._documents[record.number] = document
            self._failures += failures_of(record)

    def write_due(self) -> None:
        """Does nothing: evaluations are kept at once."""

    def flush(self) -> None:
        """Does nothing: evaluations are kept at once."""

    def document(self, number: int) -> str:
        """Returns the scenario of an evaluation that was appended here and has failures.

        Raises:
            UnknownName: There is none.
        """
        if number not in self._documents:
            raise UnknownName("scenario of evaluation", str(number), ())
        return self._documents[number]

    def failures(self) -> tuple[Failure, ...]:
        """Returns every violation of every evaluation, in order."""
        return tuple(self._failures)

    def open_numbers(self) -> frozenset[int]:
        """Returns the numbers of the evaluations whose failures were not run again yet."""
        is_open = Confirmation.OPEN
        return frozenset(one.evaluation for one in self._failures if one.confirmation is is_open)

    def confirm(self, number: int, confirmation: Confirmation, trace: str) -> None:
        """Stores whether an identical run repeated the failures of an evaluation."""
        self._failures = [
            replace(failure, confirmation=confirmation, trace=trace)
            if failure.evaluation == number
            else failure
            for failure in self._failures
        ]

    def group(self, groups: Mapping[tuple[int, int], int]) -> None:
        """Sets the groups of all failures, those that are not in ``groups`` to none."""
        self._failures = [
            replace(failure, group=groups.get((failure.evaluation, failure.place)))
            for failure in self._failures
        ]

    def seed_runs(self) -> tuple[SeedRun, ...]:
        """Returns the runs of seed scenarios that were kept here."""
        return self._seed_runs

    def keep_seed_runs(self, runs: tuple[SeedRun, ...]) -> None:
        """Keeps the runs of seed scenarios, in place of those before."""
        self._seed_runs = runs
