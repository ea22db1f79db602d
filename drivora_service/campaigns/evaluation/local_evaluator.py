"""The evaluator on worker processes of this machine."""

from __future__ import annotations

import time
from collections.abc import Sequence

from drivora_service.campaigns.evaluator import Answer, EvaluatorContext, EvaluatorPlugin
from drivora_service.execution.executor import Executor
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import Runs
from drivora_service.runs.run_report import RunSpec

_TOGETHER_S = 0.2
"""Seconds for which ended runs wait for others while workers have runs to take: what comes of them
in the process that searches costs less if it is done together."""


class LocalEvaluator:
    """Runs on an executor that it owns."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._runs = Runs(executor)
        self._numbers: dict[str, int] = {}

    def submit(self, runs: Sequence[tuple[int, RunSpec]]) -> None:
        """Queues runs, which start when slots are free; first in, first out."""
        for number, spec in runs:
            self._numbers[spec.run_id] = number
            self._runs.submit(spec)

    def wait(self, timeout: float | None = None) -> tuple[Answer, ...]:
        """Returns the answers since the last call; waits for one, ``timeout`` seconds at most.

        Raises:
            WorkersCannotStart: No worker can be started.
        """
        until = None if timeout is None else time.monotonic() + timeout
        while len(self._runs):
            left = None if until is None else until - time.monotonic()
            if left is not None and left <= 0.0:
                break
            ends = self._runs.wait(self._patience(left), count=self._enough())
            if ends:
                return tuple(
                    Answer(
                        number=self._numbers.pop(end.report.run_id),
                        report=end.report,
                        candidate=end.candidate,
                    )
                    for end in ends
                )
        return ()

    def _enough(self) -> int:
        """Returns the number of runs that may end before a worker has no run to take."""
        return max(len(self._runs) - 2 * self._executor.capacity, 1)

    def _patience(self, left: float | None) -> float:
        """Returns the seconds to wait for them, after which fewer are answered."""
        return _TOGETHER_S if left is None else min(left, _TOGETHER_S)

    def close(self) -> None:
        """Ends every run and every worker process."""
        self._executor.close()


def _create(context: EvaluatorContext) -> LocalEvaluator:
    return LocalEvaluator(
        LocalExecutor(
            slots=context.workers,
            setup=context.setup,
            folder=context.folder,
            limits=context.limits,
        )
    )


LOCAL = EvaluatorPlugin(
    name="local",
    description="worker processes of this machine",
    create=_create,
)
