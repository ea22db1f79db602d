"""The execution component: the evaluator of candidates, local or remote."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from drivora_service.execution.executor import Limits
from drivora_service.runs.candidate import Candidate
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.worker.setup import WorkerSetup


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """The end of a run.

    Attributes:
        number: Number under which it was submitted.
        report: As it is read from JSON, so that a stored one is the same.
        candidate: What a worker made of the genes of the spec; ``None`` if it did not get so far,
            or the spec has a document.
    """

    number: int
    report: RunReport
    candidate: Candidate | None = None


class Evaluator(Protocol):
    """Simulates and judges candidates.

    :meth:`wait` returns every submitted number exactly once, in any order, unless the evaluator is
    closed before. Crashes are confirmed and lost attempts repeated before: the answer is final.
    """

    def submit(self, runs: Sequence[tuple[int, RunSpec]]) -> None:
        """Queues runs, each under its number; first in, first out."""
        ...

    def wait(self, timeout: float | None = None) -> tuple[Answer, ...]:
        """Returns the answers since the last call; waits for one, ``timeout`` seconds at most.

        Returns none at once if no run is in flight.

        Raises:
            WorkersCannotStart: No worker can be started.
        """
        ...

    def close(self) -> None:
        """Cancels the runs in flight and releases all resources; may be called again."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluatorContext:
    """The configuration of an evaluator.

    Attributes:
        workers: Number of runs at once.
        setup: Configuration of every worker.
        limits: Limits of a worker.
        folder: For files of its own; exists, and is removed after the end.
    """

    workers: int
    setup: WorkerSetup
    limits: Limits
    folder: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluatorPlugin:
    """The object of an entry point of the group ``drivora_service.evaluators``."""

    name: str
    description: str
    create: Callable[[EvaluatorContext], Evaluator]
