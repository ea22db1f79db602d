"""The thread of a service that removes what is older than it is to be kept."""

from __future__ import annotations

import threading
from collections.abc import Callable
from datetime import UTC, datetime

from drivora_service.execution.supervised import Patience, SupervisedThread
from drivora_service.store.database import Database
from drivora_service.store.retention import Retention, retain
from drivora_service.store.traces import CampaignTraces, TraceFolder

_EVERY_S = 3600.0
_STOP_S = 5.0


class Housekeeping:
    """Removes old runs and traces once an hour, if anything is ever to be removed."""

    def __init__(
        self,
        database: Database,
        traces: TraceFolder,
        campaign_traces: CampaignTraces,
        retention: Retention,
        *,
        every_s: float = _EVERY_S,
        explained: Callable[[], bool] = lambda: False,
    ) -> None:
        """Prepares the thread.

        Args:
            database: Where the runs and campaigns are.
            traces: Where the traces of runs are.
            campaign_traces: Where the traces of failures are.
            retention: What is kept for how long.
            every_s: Seconds between two passes.
            explained: Whether a failure is due to a fault that is known.
        """
        self._database, self._traces, self._campaign_traces = database, traces, campaign_traces
        self._retention, self._every_s = retention, every_s
        self._stopping = threading.Event()
        # A service whose old runs stay is still of use: this thread never ends it.
        patience = Patience(longest_s=every_s, failures=1 << 60)
        self._thread = SupervisedThread(
            "housekeeping", self._turn, explained=explained, patience=patience
        )

    def start(self) -> None:
        """Starts the thread, unless everything is kept."""
        if not self._retention.keeps_everything:
            self._thread.start()

    def stop(self) -> None:
        """Has the pass that goes on end after its transaction, and waits for that."""
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
