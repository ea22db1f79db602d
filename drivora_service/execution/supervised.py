"""A thread that survives exceptions of its work, and gives up if they persist."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass

import structlog

from drivora_service.errors import StoreDamaged
from drivora_service.fault_log import FaultLog

_log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Backoff:
    """The pauses of a supervised thread after failures.

    Attributes:
        first_s: Seconds of the pause after the first failure; doubled with each one after it.
        longest_s: Seconds of the longest pause.
        failures: Consecutive failures after which the thread gives up.
    """

    first_s: float = 0.5
    longest_s: float = 15.0
    failures: int = 10

    def pause_s(self, failures: int) -> float:
        """Returns the seconds to wait after so many consecutive failures, at least one."""
        return float(min(self.first_s * 2.0 ** min(failures - 1, 30), self.longest_s))


class SupervisedThread:
    """Repeats a function in a thread until :meth:`stop` is called.

    An exception of the function is logged, at most once a minute, and the function is called again
    after a pause; that of a damaged database is logged by its finder only. After too many
    consecutive failures that no known fault of the infrastructure explains, the thread ends and
    calls ``on_fatal``: a process without this thread is of no use, and its supervisor must restart
    it.
    """

    def __init__(
        self,
        name: str,
        turn: Callable[[], None],
        *,
        at_end: Callable[[], None] = lambda: None,
        explained: Callable[[], bool] = lambda: False,
        on_fatal: Callable[[str], None] = lambda _message: None,
        backoff: Backoff = Backoff(),  # frozen
    ) -> None:
        """Creates the thread; :meth:`start` starts it.

        Args:
            name: Name of the thread, for the log and the message.
            turn: Called repeatedly; it waits by itself if there is nothing to do.
            at_end: Called in the thread when it ends, also after it has given up.
            explained: Whether a fault that is known and reported elsewhere explains a failure;
                such failures never end the thread.
            on_fatal: Called from the thread with the reason for which it has given up.
            backoff: Number and length of the pauses.
        """
        self.name = name
        self._turn, self._at_end = turn, at_end
        self._explained, self._on_fatal, self._backoff = explained, on_fatal, backoff
        self._faults = FaultLog(_log)
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    @property
    def is_alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    def start(self) -> None:
        """Starts the thread, which calls ``turn`` from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread after the current turn; does not wait for it."""
        self._stopping.set()

    def join(self, timeout_s: float | None = None) -> bool:
        """Waits for the end of the thread, if it was started; returns whether it has ended."""
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            self._repeat()
        finally:
            try:
                self._at_end()
            except Exception as error:
                _log.error("thread_end_failed", thread=self.name, exc_info=error)

    def _repeat(self) -> None:
        failures = unexplained = 0
        while not self._stopping.is_set():
            try:
                self._turn()
            except StoreDamaged:
                # Reported once, by the part that found it, and not before a restart over.
                failures += 1
                self._is_explained()
                self._stopping.wait(self._backoff.pause_s(failures))
            except Exception as error:
                failures += 1
                unexplained = 0 if self._is_explained() else unexplained + 1
                self._faults.error(
                    "thread_failed", thread=self.name, failures=failures, exc_info=error
                )
                if unexplained >= self._backoff.failures:
                    self._give_up(unexplained, error)
                    return
                self._stopping.wait(self._backoff.pause_s(failures))
            else:
                failures = unexplained = 0
                self._faults.over("thread_failed", "thread_works_again", thread=self.name)

    def _is_explained(self) -> bool:
        try:
            return self._explained()
        except Exception as error:
            self._faults.error("explanation_failed", thread=self.name, exc_info=error)
            return False

    def _give_up(self, failures: int, error: Exception) -> None:
        message = (
            f"the thread {self.name!r} failed {failures} times in a row, the last time with "
            f"{type(error).__name__}: {error}. The process ends, so that its supervisor can "
            "restart it"
        )
        _log.critical("thread_gave_up", thread=self.name, failures=failures, exc_info=error)
        self._on_fatal(message)
