"""Running specs to their reports without a database."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice

from drivora_service.execution.executor import Executor
from drivora_service.runs import lifecycle
from drivora_service.runs.lifecycle import RetryPolicy, RunState
from drivora_service.runs.report import RunReport, RunSpec


def run_all(
    executor: Executor,
    specs: Iterable[RunSpec],
    policy: RetryPolicy = RetryPolicy(),  # noqa: B008 # frozen
) -> Iterator[RunReport]:
    """Runs every spec and gives the reports in the order in which the runs end.

    Crashes are confirmed and lost workers made good, as the service does it. ``specs`` is read as
    slots come free, so it may be long.

    Args:
        executor: Used by nobody else meanwhile.
        specs: With run ids of their own.
        policy: How often a run may fail for reasons that are not its own.
    """
    coming = iter(specs)
    running: dict[str, tuple[RunSpec, RunState]] = {}
    while True:
        for spec in islice(coming, 2 * executor.capacity - len(running)):
            running[spec.run_id] = (spec, lifecycle.start(RunState()))
            executor.submit(spec)
        if not running:
            return
        for end in executor.wait():
            spec, state = running.pop(end.report.run_id)
            transition = lifecycle.end(state, end.report, policy)
            if transition.report is not None:
                yield transition.report
            else:
                running[spec.run_id] = (spec, lifecycle.start(transition.state))
                executor.submit(spec)
