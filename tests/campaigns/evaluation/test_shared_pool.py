"""A pool of workers for several campaigns: fair, complete, and without effect on them."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta

import pytest

from drivora_service.campaigns.evaluation.shared_pool import PoolEvaluator, SharedPool
from drivora_service.errors import WorkersCannotStart
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import cancelled_report
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.runs.slot_state import SlotState


class Steps:
    """An executor that ends a run when it is told to."""

    def __init__(self, capacity: int = 2) -> None:
        self.capacity, self.fault = capacity, ""
        self.run_s = 5.0
        self._changed = threading.Condition()
        self.queue: deque[RunSpec] = deque()
        self._ended: list[AttemptEnd] = []
        self._woken = False
        self.begun: list[str] = []
        self.cancelled: list[str] = []

    def submit(self, spec: RunSpec) -> None:
        with self._changed:
            self.queue.append(spec)
            self.begun.append(spec.run_id)
            self._changed.notify_all()

    def end_first(self) -> str:
        """Ends the run that was submitted first; waits for one."""
        with self._changed:
            assert self._changed.wait_for(lambda: self.queue, 10.0)
            run_id = self.queue.popleft().run_id
            self._end(RunReport(run_id=run_id, status=RunStatus.FINISHED))
        return run_id

    def _end(self, report: RunReport) -> None:
        now = datetime.now(UTC)
        started = now - timedelta(seconds=self.run_s)
        self._ended.append(AttemptEnd(report=report, worker="", started=started, ended=now))
        self._changed.notify_all()

    def cancel(self, run_id: str) -> None:
        with self._changed:
            self.cancelled.append(run_id)
            for spec in list(self.queue):
                if spec.run_id == run_id:
                    self.queue.remove(spec)
                    self._end(cancelled_report(run_id))

    def break_down(self, fault: str) -> None:
        self.fault = fault
        self.wake()

    def withdraw(self) -> tuple[str, ...]:
        raise NotImplementedError

    def wait(self, timeout: float | None = None, *, count: int = 1) -> tuple[AttemptEnd, ...]:
        with self._changed:
            self._changed.wait_for(lambda: len(self._ended) >= count or self._woken, timeout)
            self._woken = False
            ended = tuple(self._ended)
            self._ended.clear()
        return ended

    def wake(self) -> None:
        with self._changed:
            self._woken = True
            self._changed.notify_all()

    def slots(self) -> tuple[SlotState, ...]:
        return ()

    def close(self) -> None:
        self.queue.clear()


@pytest.fixture
def executor() -> Steps:
    return Steps()


@pytest.fixture
def pool(executor: Steps) -> Iterator[SharedPool]:
    with SharedPool(executor) as pool:
        yield pool


def submit(member: PoolEvaluator, name: str, *numbers: int) -> None:
    member.submit([(n, RunSpec(run_id=f"{name}-{n}", document="")) for n in numbers])


def answered(member: PoolEvaluator, count: int) -> list[int]:
    found: list[int] = []
    while len(found) < count:
        answers = member.wait(10.0)
        assert answers
        found += [answer.number for answer in answers]
    return found


def test_campaigns_take_turns_each_in_its_own_order(executor: Steps, pool: SharedPool) -> None:
    first, second = pool.evaluator(), pool.evaluator()
    submit(first, "a", *range(8))
    until(lambda: len(executor.begun) == 4)
    submit(second, "b", *range(3))
    ended = [executor.end_first() for _ in range(11)]
    assert sorted(answered(first, 8)) == list(range(8))
    assert sorted(answered(second, 3)) == [0, 1, 2]
    # What the first had queued beyond the workers' reach waits while the second catches up.
    assert [run for run in ended if run[0] == "a"] == [f"a-{n}" for n in range(8)]
    assert [run for run in ended if run[0] == "b"] == [f"b-{n}" for n in range(3)]
    assert ended[4:9] in (
        ["b-0", "a-4", "b-1", "a-5", "b-2"],
        ["a-4", "b-0", "a-5", "b-1", "a-6"],
    )


@pytest.mark.parametrize(("run_s", "under_way"), [(5.0, 4), (0.1, 18)])
def test_the_shorter_runs_are_the_more_are_handed_over_ahead(
    executor: Steps, pool: SharedPool, run_s: float, under_way: int
) -> None:
    executor.run_s = run_s
    member = pool.evaluator()
    submit(member, "a", *range(30))
    until(lambda: len(executor.begun) == 4)
    executor.end_first()
    answered(member, 1)
    until(lambda: len(executor.queue) == under_way)
    assert not pool.is_hungry()
    # No more than these.
    executor.end_first()
    answered(member, 1)
    until(lambda: len(executor.begun) == under_way + 2)
    assert len(executor.queue) == under_way


def test_a_pool_is_hungry_when_no_run_waits_for_a_worker(executor: Steps, pool: SharedPool) -> None:
    assert pool.is_hungry()
    first = pool.evaluator()
    assert not pool.is_hungry()  # it has not submitted anything yet
    submit(first, "a", 0, 1, 2)
    assert not pool.is_hungry()
    executor.end_first()
    assert answered(first, 1) == [0]
    assert pool.is_hungry()  # two runs for two workers: none waits


def test_a_campaign_that_ends_takes_its_runs_along(executor: Steps, pool: SharedPool) -> None:
    first, second = pool.evaluator(), pool.evaluator()
    submit(first, "a", *range(6))
    until(lambda: len(executor.begun) == 4)
    first.close()
    submit(second, "b", 0)
    assert sorted(executor.cancelled) == [f"a-{n}" for n in range(4)]
    assert executor.end_first() == "b-0"
    assert answered(second, 1) == [0]
    first.close()
    assert first.wait(0.0) == ()


def test_without_runs_nothing_is_waited_for(pool: SharedPool) -> None:
    begun = time.monotonic()
    assert pool.evaluator().wait() == ()
    assert time.monotonic() - begun < 5.0


def test_every_campaign_hears_that_no_worker_can_start(executor: Steps, pool: SharedPool) -> None:
    members = [pool.evaluator(), pool.evaluator()]
    for name, member in zip("ab", members, strict=True):
        submit(member, name, 0)
    executor.break_down("no memory")
    for member in members:
        with pytest.raises(WorkersCannotStart, match="no memory"):
            member.wait(10.0)
    assert "no memory" in pool.fault


def until(condition: object) -> None:
    """Waits for a condition."""
    assert callable(condition)
    deadline = time.monotonic() + 10.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.002)
