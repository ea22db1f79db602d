"""One executor for several campaigns at once.

Each campaign has an evaluator of its own; the runs of all of them share the workers. A campaign's
runs start in its own order, and the campaigns take turns, so that none waits for another's queue.
Which run ends when does not change a campaign.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Sequence
from types import TracebackType

from drivora_service.campaigns.evaluator import Answer
from drivora_service.errors import WorkersCannotStart
from drivora_service.execution.executor import Executor
from drivora_service.execution.pace import Pace
from drivora_service.execution.spec_running import Runs
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunSpec

_POLL_S = 0.5
"""Seconds for which the thread of the pool waits for the end of a run at most."""


class SharedPool:
    """Hands out evaluators that share an executor; a context manager."""

    def __init__(self, executor: Executor) -> None:
        """Starts the thread that hands runs to the executor.

        Args:
            executor: Must have no other user meanwhile; the caller closes it.
        """
        self._executor, self._runs, self._pace = executor, Runs(executor), Pace()
        self._changed = threading.Condition()
        self._members: deque[PoolEvaluator] = deque()
        self._owners: dict[str, PoolEvaluator] = {}
        # Runs of campaigns that have ended, as long as the executor or a pause holds them.
        self._abandoned: set[str] = set()
        self._fault = ""
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="pool", daemon=True)
        self._thread.start()

    @property
    def fault(self) -> str:
        """Why no run can be started, "" while they can."""
        return self._fault

    @property
    def workers(self) -> int:
        """The number of runs that the executor performs at once."""
        return self._executor.capacity

    def is_hungry(self) -> bool:
        """Returns whether one more campaign would keep the workers busier.

        That is so if no run waits for a worker, and every campaign has begun to submit its runs.
        """
        with self._changed:
            waiting = sum(len(member.queue) for member in self._members)
            under_way = waiting + len(self._owners)
            return under_way <= self.workers and all(m.has_submitted for m in self._members)

    def evaluator(self) -> PoolEvaluator:
        """Returns an evaluator for one campaign; it is closed before the pool."""
        member = PoolEvaluator(self)
        with self._changed:
            self._members.append(member)
        return member

    def put(self, member: PoolEvaluator, runs: Sequence[tuple[int, RunSpec]]) -> None:
        """Queues the runs of a campaign."""
        with self._changed:
            member.has_submitted = True
            member.queue.extend(runs)
            self._changed.notify_all()
        self._executor.wake()

    def take(self, member: PoolEvaluator, timeout: float | None) -> tuple[Answer, ...]:
        """Waits for answers to a campaign.

        Raises:
            WorkersCannotStart: No worker can be started.
        """
        until = None if timeout is None else time.monotonic() + timeout
        with self._changed:
            while not member.answers and (member.queue or member.numbers):
                if self._fault:
                    raise WorkersCannotStart(self._fault)
                left = None if until is None else until - time.monotonic()
                if left is not None and left <= 0.0:
                    break
                self._changed.wait(left)
            answers = tuple(member.answers)
            member.answers.clear()
        return answers

    def release(self, member: PoolEvaluator) -> None:
        """Cancels the runs of a campaign that has ended."""
        with self._changed:
            member.queue.clear()
            if member in self._members:
                self._members.remove(member)
            abandoned = [*member.numbers]
            member.numbers.clear()
            self._abandoned.update(abandoned)
            self._changed.notify_all()
        for run_id in abandoned:
            self._executor.cancel(run_id)

    def close(self) -> None:
        """Ends the thread; the runs under way are abandoned."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._executor.wake()
        self._thread.join()

    def _work(self) -> None:
        try:
            while True:
                with self._changed:
                    self._changed.wait_for(
                        lambda: self._closed or self._owners or any(m.queue for m in self._members)
                    )
                    if self._closed:
                        return
                    self._forget_abandoned()
                    self._fill()
                ends = self._runs.wait(_POLL_S)
                if ends:
                    self._hand_out(ends)
        except Exception as error:
            # Whatever it is: without this thread, every campaign would wait for ever.
            with self._changed:
                self._fault = str(error) or type(error).__name__
                self._changed.notify_all()
            if not isinstance(error, WorkersCannotStart):
                raise

    def _forget_abandoned(self) -> None:
        """Forgets abandoned runs that wait for the end of a pause; the others were cancelled."""
        for run_id in self._runs.discard(self._abandoned):
            del self._owners[run_id]
        self._abandoned &= self._owners.keys()

    def _fill(self) -> None:
        """Hands over as many runs as keep the workers busy, from each campaign in turn."""
        room = self._pace.target_in_flight(self._executor.capacity) - len(self._owners)
        idle = 0
        while room > 0 and idle < len(self._members):
            member = self._members[0]
            self._members.rotate(-1)
            if not member.queue:
                idle += 1
                continue
            idle = 0
            number, spec = member.queue.popleft()
            member.numbers[spec.run_id] = number
            self._owners[spec.run_id] = member
            self._runs.submit(spec)
            room -= 1

    def _hand_out(self, ends: Sequence[AttemptEnd]) -> None:
        with self._changed:
            for end in ends:
                self._pace.note((end.ended - end.started).total_seconds())
                member = self._owners.pop(end.report.run_id)
                number = member.numbers.pop(end.report.run_id, None)
                if number is not None:
                    member.answers.append(
                        Answer(number=number, report=end.report, candidate=end.candidate)
                    )
            self._changed.notify_all()

    def __enter__(self) -> SharedPool:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


class PoolEvaluator:
    """The evaluator of one campaign, on the executor of a pool.

    Attributes:
        queue: Runs that were not started, with their numbers.
        numbers: Numbers of the runs that were, by the ids of the runs.
        answers: Answers that the campaign has not fetched.
        has_submitted: Whether it has submitted a run.
    """

    def __init__(self, pool: SharedPool) -> None:
        self._pool = pool
        self.queue: deque[tuple[int, RunSpec]] = deque()
        self.numbers: dict[str, int] = {}
        self.answers: list[Answer] = []
        self.has_submitted = False

    def submit(self, runs: Sequence[tuple[int, RunSpec]]) -> None:
        """Queues runs, each under its number; first in, first out."""
        self._pool.put(self, runs)

    def wait(self, timeout: float | None = None) -> tuple[Answer, ...]:
        """Returns the answers since the last call; waits for one, ``timeout`` seconds at most.

        Raises:
            WorkersCannotStart: No worker can be started.
        """
        return self._pool.take(self, timeout)

    def close(self) -> None:
        """Cancels the runs in flight; the pool remains."""
        self._pool.release(self)
