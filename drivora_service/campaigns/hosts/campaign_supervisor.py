"""The supervisor of the processes of the service's campaigns."""

from __future__ import annotations

import multiprocessing
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait

import structlog

from drivora_service.campaigns.hosts.campaign_requests import hand_over
from drivora_service.campaigns.hosts.engine_process import (
    CANNOT_RUN,
    DAMAGED,
    EngineSetup,
    log_tail,
    run_engine,
)
from drivora_service.campaigns.hosts.running_engine import RunningEngine
from drivora_service.errors import Conflict
from drivora_service.execution.deaths import signal_name
from drivora_service.execution.fork_server import exit_code, spawn_process
from drivora_service.execution.supervised import SupervisedThread
from drivora_service.fault_log import FaultLog
from drivora_service.store.campaigns.campaign_records import CampaignRequest, CampaignState
from drivora_service.store.database import Database, Transaction
from drivora_service.store.locks.work_locks import LongWork

_LOOK_S = 0.5
"""Seconds between two polls for campaigns to run."""

_RETRY_S = 1.0
"""Seconds before an engine is restarted, doubled with each death."""

_MOST_DEATHS = 4
"""Deaths of its engine without an evaluation between them after which a campaign fails."""

_TAIL_LINES = 20

_log = structlog.get_logger(__name__)

_ENDS = {
    CampaignRequest.PAUSE: CampaignState.PAUSED,
    CampaignRequest.CANCEL: CampaignState.CANCELLED,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Deaths:
    """Deaths of a campaign's engine, all with the same number of evaluations."""

    count: int
    evaluations: int


class CampaignSupervisor:
    """A thread that starts, supervises and ends the processes of campaigns.

    Campaigns are resumed after the death of their process, alone or with the service. The processes
    store their own states; the supervisor stores only those of dead processes, and locks each
    campaign before it starts a process for it: of several services on one database, one runs it.
    """

    def __init__(
        self,
        database: Database,
        setup: EngineSetup,
        *,
        at_once: int,
        on_queued: Callable[[], None] = lambda: None,
        explained: Callable[[], bool] = lambda: False,
        on_fatal: Callable[[str], None] = lambda _message: None,
    ) -> None:
        """Creates the supervisor; :meth:`start` starts its thread.

        Args:
            database: Database of the service.
            setup: Configuration of every process.
            at_once: Greatest number of campaigns that run at once; the others wait.
            on_queued: Called when a campaign has queued runs.
            explained: Whether a failure is due to a known fault of the infrastructure.
            on_fatal: Called with the reason for which the thread has given up.
        """
        self._database, self._setup = database, setup
        self._at_once, self._on_queued = at_once, on_queued
        self._engines: dict[str, RunningEngine] = {}
        self._deaths: dict[str, _Deaths] = {}
        self._not_before: dict[str, float] = {}
        self._look_at = 0.0
        self._faults = FaultLog(_log)
        self._woken, self._waker = multiprocessing.Pipe(duplex=False)
        self._waking = threading.Lock()
        # The kernel ends an engine with the thread that started it, so that must be this one.
        self._thread = SupervisedThread(
            "campaigns",
            self._turn,
            at_end=self._end_engines,
            explained=explained,
            on_fatal=on_fatal,
        )

    def start(self) -> None:
        """Starts the thread, which starts a process for each queued campaign."""
        self._thread.start()

    @property
    def fault(self) -> str:
        """The reason that no campaign can be started, "" while they can."""
        return "" if self._thread.is_alive else "no campaign is started: its thread has ended"

    def wake(self) -> None:
        """Signals a new or resumed campaign; without it, the thread sees it within 1 s."""
        with self._waking:
            self._waker.send_bytes(b"wake")

    def open(self, transaction: Transaction, campaign_id: str) -> None:
        """Accepts a new campaign."""
        transaction.campaign_runs.open(campaign_id)

    def resume(self, campaign_id: str) -> None:
        """Resumes a campaign that is not running.

        Raises:
            UnknownName: There is no such campaign.
            Conflict: It is over, or a process runs it.
        """
        hand_over(self._database, campaign_id)
        self.wake()

    def stop(self) -> None:
        """Ends every engine; the campaigns are resumed when the service is started again."""
        self._thread.stop()
        self.wake()
        self._thread.join()

    def _end_engines(self) -> None:
        for engine in self._engines.values():
            engine.close()
        self._engines.clear()

    def _turn(self) -> None:
        if self._database.damage.found:
            # They do not know it, and would go on writing. Their campaigns keep their states.
            self._end_engines()
            self._database.damage.refuse()
        if self._listen():
            self._on_queued()
        for engine in list(self._engines.values()):
            code = exit_code(engine.process)
            if code is not None:
                self._clean_up(engine, code)
        now = time.monotonic()
        if now >= self._look_at:
            self._look_at = now + _LOOK_S
            self._poll(now)

    def _listen(self) -> bool:
        """Waits for a message or the next poll; returns whether runs were queued."""
        engines = list(self._engines.values())
        words: dict[Connection, RunningEngine] = {
            e.queued: e for e in engines if e.queued is not None
        }
        sentinels = [engine.process.sentinel for engine in engines]
        timeout = max(0.0, self._look_at - time.monotonic())
        ready = wait([self._woken, *words, *sentinels], timeout)
        queued = False
        for one in ready:
            if one is self._woken:
                _drain(self._woken)
            if one is self._woken or one in sentinels:
                self._look_at = 0.0
            elif isinstance(one, Connection):
                queued = True
                if not _drain(one):
                    one.close()
                    words[one].queued = None
        return queued

    def _poll(self, now: float) -> None:
        """Starts campaigns for the free room, and ends stopped ones without an engine."""
        for engine in self._engines.values():
            engine.check_limits(now)
        self._database.locks.keep()
        with self._database.read() as transaction:
            wanted = transaction.campaigns.to_run()
        for campaign in wanted:
            running = self._engines.get(campaign.id)
            if running is not None:
                running.hurry(campaign.request, now)
            if running is not None or now < self._not_before.get(campaign.id, 0.0):
                continue
            try:
                self._update_campaign(campaign.id, campaign.request)
            except OSError as error:
                # An error of its folder or lock must not hold up the other campaigns.
                self._faults.error("campaign_not_started", campaign=campaign.id, error=repr(error))
                self._not_before[campaign.id] = now + _RETRY_S

    def _update_campaign(self, campaign_id: str, request: CampaignRequest) -> None:
        if self._database.locks.is_held(LongWork.campaign(campaign_id)):
            # A command or another service runs it.
            return
        if request is not CampaignRequest.NONE:
            with self._database.write() as transaction:
                transaction.campaigns.end(campaign_id, _ENDS[request])
        elif len(self._engines) < self._at_once:
            self._begin(campaign_id)

    def _begin(self, campaign_id: str) -> None:
        try:
            lock = self._database.locks.hold(LongWork.campaign(campaign_id))
        except Conflict:
            # Another service was faster.
            return
        reader, writer = multiprocessing.Pipe(duplex=False)
        try:
            # What an engine of a service that was killed has written must not count for this one.
            self._setup.board(campaign_id).unlink(missing_ok=True)
            # Not from the fork server of the workers: an engine never needs the simulator.
            process = spawn_process(run_engine, (self._setup, campaign_id, writer))
        except OSError as error:
            # The system is short of processes or memory, which passes.
            _log.error("engine_not_started", campaign=campaign_id, error=repr(error))
            reader.close()
            lock.release()
            self._not_before[campaign_id] = time.monotonic() + _RETRY_S
            return
        finally:
            writer.close()
        self._engines[campaign_id] = RunningEngine(
            self._setup, campaign_id, lock=lock, process=process, queued=reader
        )
        _log.info("campaign_started", campaign=campaign_id, pid=process.pid)

    def _clean_up(self, engine: RunningEngine, code: int) -> None:
        campaign_id = engine.campaign_id
        if code == DAMAGED:
            # The reason is the last line of its log; the next turn ends the other engines.
            self._database.damage.note(log_tail(self._setup.log(campaign_id), 1))
            return
        with self._database.read() as transaction:
            record = transaction.campaigns.get(campaign_id)
            request = transaction.campaigns.request_of(campaign_id)
        if record.state in (CampaignState.QUEUED, CampaignState.RUNNING):
            if code == CANNOT_RUN:
                self._not_before[campaign_id] = time.monotonic() + _RETRY_S
            elif request is not CampaignRequest.NONE:
                self._end(campaign_id, _ENDS[request])
            elif engine.fault:
                self._end(campaign_id, CampaignState.FAILED, engine.fault)
            else:
                self._count_death(campaign_id, code, record.counts.evaluations)
        else:
            _log.info("campaign_ended", campaign=campaign_id, state=record.state)
            self._forget(campaign_id)
        del self._engines[campaign_id]
        engine.close()

    def _count_death(self, campaign_id: str, code: int, evaluations: int) -> None:
        known = self._deaths.get(campaign_id)
        before = known.count if known is not None and known.evaluations == evaluations else 0
        deaths = _Deaths(count=before + 1, evaluations=evaluations)
        how = signal_name(code) or f"exit code {code}"
        _log.warning("engine_died", campaign=campaign_id, how=how, deaths=deaths.count)
        if deaths.count < _MOST_DEATHS:
            self._deaths[campaign_id] = deaths
            self._not_before[campaign_id] = time.monotonic() + _RETRY_S * 2**before
            return
        tail = log_tail(self._setup.log(campaign_id), _TAIL_LINES)
        self._end(
            campaign_id,
            CampaignState.FAILED,
            f"its process died {deaths.count} times after {evaluations} evaluations, the last time "
            f"of {how}. Resume the campaign to try it again. The end of its log:\n{tail}",
        )

    def _end(self, campaign_id: str, state: CampaignState, message: str = "") -> None:
        with self._database.write() as transaction:
            transaction.campaigns.end(campaign_id, state, message=message)
        _log.info("campaign_ended", campaign=campaign_id, state=state)
        self._forget(campaign_id)

    def _forget(self, campaign_id: str) -> None:
        self._deaths.pop(campaign_id, None)
        self._not_before.pop(campaign_id, None)


def _drain(connection: Connection) -> bool:
    """Discards received messages; returns whether more may come."""
    try:
        while connection.poll():
            connection.recv_bytes()
    except EOFError:
        return False
    return True
