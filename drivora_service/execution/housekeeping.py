"""The thread of a service that removes expired runs and traces."""

from __future__ import annotations

import threading
from collections.abc import Callable
from datetime import UTC, datetime

from drivora_service.execution.supervised import Backoff, SupervisedThread
from drivora_service.store.database import Database
from drivora_service.store.traces.trace_folders import FailureTraces, RunTraces
from drivora_service.store.upkeep.retention import Retention, retain

_EVERY_S = 3600.0
_STOP_S = 5.0


class Housekeeping:
    """Removes expired runs and traces once an hour, if any retention time is set."""

    def __init__(
        self,
        database: Database,
        traces: RunTraces,
        campaign_traces: FailureTraces,
        retention: Retention,
        *,
        every_s: float = _EVERY_S,
        explained: Callable[[], bool] = lambda: False,
    ) -> None:
        """Creates the housekeeping; :meth:`start` starts its thread.

        Args:
            database: Holds the runs and campaigns.
            traces: Folder of the traces of runs.
            campaign_traces: Folder of the traces of failures.
            retention: Retention times.
            every_s: Seconds between two passes.
            explained: Whether a known fault explains a failure.
        """
        self._database, self._traces, self._campaign_traces = database, traces, campaign_traces
        self._retention, self._every_s = retention, every_s
        self._stopping = threading.Event()
        # A service that keeps old runs is still of use: this thread never ends it.
        backoff = Backoff(longest_s=every_s, failures=1 << 60)
        self._thread = SupervisedThread(
            "housekeeping", self._turn, explained=explained, backoff=backoff
        )

    def start(self) -> None:
        """Starts the thread; without a retention time there is nothing to do, and no thread."""
        if not self._retention.keeps_everything:
            self._thread.start()

    def stop(self) -> None:
        """Ends the current pass after its transaction, and waits for that."""
        self._stopping.set()
        self._thread.stop()
        self._thread.join(_STOP_S)

    def _turn(self) -> None:
        retain(
            self._database,
            self._traces,
            self._campaign_traces,
            self._retention,
            now=datetime.now(UTC),
            stopping=self._stopping.is_set,
        )
        self._stopping.wait(self._every_s)
