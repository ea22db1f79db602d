"""A campaign's process that runs: its limits, and its end if it does not follow a request."""

from __future__ import annotations

import contextlib
import os
import signal
import time
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

import structlog

from drivora_service.campaigns.hosts.engine_limits import EngineWatch, read_board
from drivora_service.campaigns.hosts.engine_process import EngineSetup
from drivora_service.execution.fork_server import kill_process
from drivora_service.store.campaigns.campaign_records import CampaignRequest
from drivora_service.store.locks.work_locks import HeldWork
from drivora_service.worker.process_readings import (
    descendants_of,
    list_children,
    proportional_memory,
    read_process,
)

_log = structlog.get_logger(__name__)


class RunningEngine:
    """The process of one campaign, seen by its supervisor.

    Attributes:
        queued: Receives a message for every queued run; ``None`` once the process has closed it.
        fault: The limit that it exceeded, for which it was killed; "": none.
    """

    def __init__(
        self,
        setup: EngineSetup,
        campaign_id: str,
        *,
        lock: HeldWork,
        process: BaseProcess,
        queued: Connection,
    ) -> None:
        """Takes a process that has just been started.

        Args:
            setup: Configuration of every process.
            campaign_id: Id of the campaign.
            lock: The campaign's lock, which is released at the end.
            process: The process.
            queued: As the attribute.
        """
        self.campaign_id, self.process = campaign_id, process
        self.queued: Connection | None = queued
        self.fault = ""
        self._setup, self._lock = setup, lock
        self._watch = EngineWatch(setup.limits, now=time.monotonic())
        self._asked_at: float | None = None
        self._is_terminated = self._is_killed = False

    def hurry(self, request: CampaignRequest, now: float) -> None:
        """Ends a process that has not followed a request, as its tester may never return.

        It is first asked to end (``SIGTERM``), so that it stores what was found.

        Args:
            request: The pending request, or none.
            now: Monotonic seconds.
        """
        if request is CampaignRequest.NONE:
            self._asked_at = None
            return
        if self._asked_at is None:
            self._asked_at = now
        limits, waited = self._setup.limits, now - self._asked_at
        if waited > limits.grace_s + limits.end_s and not self._is_killed:
            _log.warning("engine_killed", campaign=self.campaign_id, request=request)
            self._kill()
        elif waited > limits.grace_s and not self._is_terminated:
            _log.info("engine_terminated", campaign=self.campaign_id, request=request)
            self._is_terminated = True
            self.process.terminate()

    def check_limits(self, now: float) -> None:
        """Kills the process if it exceeds a limit, which is then its fault."""
        pid = self.process.pid
        if pid is None or self._is_killed:
            return
        started = 0
        if list_children(pid) != []:
            started = proportional_memory(descendants_of(pid, spare=lambda _: False))
        board = read_board(self._setup.board(self.campaign_id))
        self.fault = self._watch.check(read_process(pid), started, board, now)
        if self.fault:
            _log.warning("engine_killed", campaign=self.campaign_id, reason=self.fault)
            self._kill()

    def close(self) -> None:
        """Kills the process, if it lives, waits until it is gone, and releases the campaign."""
        kill_process(self.process)
        self._lock.release()
        if self.queued is not None:
            self.queued.close()
        with contextlib.suppress(OSError):
            self._setup.board(self.campaign_id).unlink()

    def _kill(self) -> None:
        """Kills a process that lives, with what it has started, which has its process group."""
        self._is_killed = True
        pid = self.process.pid
        with contextlib.suppress(OSError):
            # Before it has made a group of its own, it is in that of the service.
            if pid is not None and os.getpgid(pid) == pid:
                os.killpg(pid, signal.SIGKILL)
        self.process.kill()
