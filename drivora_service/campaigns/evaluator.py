"""The execution component: what evaluates candidates, here or elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from drivora_service.execution.executor import Limits
from drivora_service.runs.report import RunReport, RunSpec
from drivora_service.worker.setup import WorkerSetup


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """The end of a run, by the number under which it was asked for."""

    number: int
    report: RunReport


class Evaluator(Protocol):
    """Simulates and judges.

    Every number that was submitted comes back exactly once from :meth:`wait`, in whatever order,
    unless the evaluator is closed before. Crashes are confirmed and lost workers made good before
    the answer is given: it is final.
    """

    def submit(self, number: int, spec: RunSpec) -> None:
        """Begins with a run as soon as possible; earlier ones first."""
        ...

    def wait(self, timeout: float | None = None) -> tuple[Answer, ...]:
        """Returns the answers since the last call; waits for one, ``timeout`` seconds at most.

        Returns none at once where nothing is under way.

        Raises:
            WorkersCannotStart: Nothing can be run.
        """
        ...

    def close(self) -> None:
        """Cancels what is under way and releases all resources; may be called again."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluatorContext:
    """What an evaluator works with.

    Attributes:
        workers: Runs that may go on at once.
        setup: What every worker is told.
        limits: What a worker may use.
        folder: For files of its own; exists, and is removed after the end.
    """

    workers: int
    setup: WorkerSetup
    limits: Limits
    folder: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluatorPlugin:
    """What an entry point of the group ``drivora_service.evaluators`` gives."""

    name: str
    description: str
    create: Callable[[EvaluatorContext], Evaluator]
