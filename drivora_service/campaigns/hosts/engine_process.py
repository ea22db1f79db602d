"""The process in which the service runs a campaign."""

from __future__ import annotations

import contextlib
import faulthandler
import os
import signal
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.evaluation.queue_evaluator import QueueEvaluator
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.hosts.engine_limits import CallBoard, EngineLimits
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.stored_campaigns import run_stored
from drivora_service.campaigns.search.conducting import Watcher
from drivora_service.campaigns.search.tester_calls import limit_memory
from drivora_service.errors import (
    Conflict,
    DrivoraError,
    PluginError,
    StoreDamaged,
    StoreUnavailable,
)
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.oracles.laws.sources import LawSource
from drivora_service.store.campaigns.campaign_warnings import CampaignWarning
from drivora_service.store.database import open_database
from drivora_service.store.traces.trace_places import TracePlaces
from drivora_service.visible_text import visible_text
from drivora_service.worker.parent_death import die_with_parent

CANNOT_RUN = 75
"""Exit code of a process that cannot run its campaign now: it is not queued, another process has
taken it over, or the database cannot be used."""

DAMAGED = 76
"""Exit code of a process that found the database damaged."""

_FAILED = 1
_PATIENCE_S = 60.0
"""Seconds for which an engine, which serves no client, waits for other writers."""
_LOG_BYTES = 1 << 20
_TAIL_BYTES = 16_384


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineSetup:
    """The configuration of every engine's process.

    Attributes:
        database_url: Database of the service; not shown, since it may hold a password.
        campaigns: Folder of all campaigns.
        traces: Where the traces are.
        workers: Number of runs that the service performs at once.
        limits: What each process may use.
        laws: The user's law files.
    """

    database_url: str = field(repr=False)
    campaigns: Path
    traces: TracePlaces
    shipped_networks: Path
    imported_networks: Path | None
    workers: int
    limits: EngineLimits = field(default_factory=EngineLimits)
    agents: Path | None = None
    laws: tuple[LawSource, ...] = ()

    def folder(self, campaign_id: str) -> CampaignFolder:
        """Returns the folder of a campaign."""
        return CampaignFolder(self.campaigns, campaign_id, self.traces.of_failures())

    def log(self, campaign_id: str) -> Path:
        """Returns the path of the log of a campaign's process."""
        return self.folder(campaign_id).path / "engine.log"

    def board(self, campaign_id: str) -> Path:
        """Returns the path of the file that says in which call of its tester a process is."""
        return self.folder(campaign_id).path / "engine.call"


def log_tail(path: Path, lines: int) -> str:
    """Returns the last lines of a log; "" if there is none."""
    try:
        with path.open("rb") as log:
            log.seek(max(0, log.seek(0, os.SEEK_END) - _TAIL_BYTES))
            text = log.read().decode(errors="replace")
    except FileNotFoundError:
        return ""
    return "\n".join(text.splitlines()[-lines:])


def run_engine(setup: EngineSetup, campaign_id: str, queued: Connection) -> None:
    """Runs a campaign until it ends or pauses, or the service ends; stores the final state.

    Args:
        setup: Configuration of every engine.
        campaign_id: Id of the campaign.
        queued: Receives a message for every queued run.
    """
    die_with_parent()
    # A session of its own: the service handles an interrupt typed at a terminal.
    os.setsid()
    _print_to(setup.log(campaign_id))
    faulthandler.enable()
    signal.signal(signal.SIGTERM, _interrupt_once)
    limit_memory(setup.limits.memory_bytes)
    print(f"process {os.getpid()} runs campaign {campaign_id}", flush=True)
    try:
        _run_campaign(setup, campaign_id, queued)
    except StoreDamaged as error:
        print(f"campaign {campaign_id}: {error}", flush=True)
        sys.exit(DAMAGED)


def _run_campaign(setup: EngineSetup, campaign_id: str, queued: Connection) -> None:
    board = CallBoard(setup.board(campaign_id))
    database = open_database(setup.database_url, patience_s=_PATIENCE_S)
    with database.read() as transaction:
        record = transaction.campaigns.get(campaign_id)

    @contextlib.contextmanager
    def open_evaluator(workers: int | None) -> Iterator[Evaluator]:
        few = workers is not None and workers < setup.workers
        evaluator = QueueEvaluator(
            database,
            record,
            setup.traces,
            most=workers if few else None,
            on_queued=lambda: queued.send_bytes(b"queued"),
        )
        with contextlib.closing(evaluator):
            yield evaluator

    def warn(warning: CampaignWarning) -> None:
        _say(f"campaign {campaign_id}: warning: {warning.message} {warning.advice}")

    try:
        ended = run_stored(
            database,
            campaign_id,
            setup.folder(campaign_id),
            catalogues=Catalogues(
                NetworkCatalogue(setup.shipped_networks, setup.imported_networks),
                setup.agents,
                setup.laws,
            ),
            evaluator=open_evaluator,
            watcher=Watcher(on_call=board.write, on_warning=warn),
            only_queued=True,
            is_locked=True,
        )
    except StoreDamaged:
        raise
    except DrivoraError as error:
        _say(f"campaign {campaign_id}: {error}")
        if isinstance(error, PluginError):
            _say(error.log)
        sys.exit(CANNOT_RUN if isinstance(error, Conflict | StoreUnavailable) else _FAILED)
    except KeyboardInterrupt:
        # What was found is stored; a traceback in the log would look like a fault.
        print(f"campaign {campaign_id}: its process was asked to end (SIGTERM)", flush=True)
        sys.exit(_FAILED)
    finally:
        database.close()
    print(f"campaign {campaign_id} is {ended.state}", flush=True)


def _say(text: str) -> None:
    """Prints a text, which may be of an agent or a plug-in, to the log."""
    print(visible_text(text, has_lines=True), flush=True)


def _interrupt_once(_number: int, _frame: FrameType | None) -> None:
    """Interrupts the tester, so that what was found is stored; a second signal has no effect."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise KeyboardInterrupt


def _print_to(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    log = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    if os.fstat(log).st_size > _LOG_BYTES:
        os.ftruncate(log, 0)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.close(log)
