"""A database with campaigns and the supervisor of their engines, without workers for their runs."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.hosts.campaign_requests import ask_for
from drivora_service.campaigns.hosts.campaign_supervisor import CampaignSupervisor
from drivora_service.campaigns.hosts.engine_limits import EngineLimits
from drivora_service.campaigns.hosts.engine_process import EngineSetup
from drivora_service.campaigns.records.stored_campaigns import new_campaign
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
)
from drivora_service.store.database import Database
from drivora_service.store.traces.trace_places import TracePlaces
from tests.campaign_engines import engine_pid

_LONG_S = 120.0


class Service:
    """A database with campaigns, and what keeps their engines."""

    def __init__(
        self,
        database: Database,
        catalogues: Catalogues,
        folder: Path,
        limits: EngineLimits = EngineLimits(),  # noqa: B008 # frozen
    ) -> None:
        self.database, self.catalogues = database, catalogues
        self.setup = EngineSetup(
            database_url=str(database.engine.url),
            campaigns=folder / "campaigns",
            traces=TracePlaces.below(folder),
            shipped_networks=shipped_networks(),
            imported_networks=None,
            workers=2,
            limits=limits,
        )
        self.queued: list[int] = []
        self.supervisor = self.supervise()

    def supervise(self, at_once: int = 4) -> CampaignSupervisor:
        self.supervisor = CampaignSupervisor(
            self.database, self.setup, at_once=at_once, on_queued=lambda: self.queued.append(1)
        )
        return self.supervisor

    def post(self, content: dict[str, Any], *, tester: str = "") -> str:
        valid = read_campaign(content, self.catalogues)
        with self.database.write() as transaction:
            record = transaction.campaigns.create(new_campaign(valid))
            transaction.campaign_runs.open(record.id)
            if tester:
                transaction.session.connection().exec_driver_sql(
                    "UPDATE campaigns SET document = replace(document, 'random', ?) WHERE id = ?",
                    (tester, record.id),
                )
        return record.id

    def record(self, campaign_id: str) -> CampaignRecord:
        with self.database.read() as transaction:
            return transaction.campaigns.get(campaign_id)

    def queued_runs(self, campaign_id: str) -> int:
        with self.database.read() as transaction:
            batch = transaction.batches.get(self.record(campaign_id).batch_id)
        return batch.size

    def ask(self, campaign_id: str, request: CampaignRequest) -> None:
        ask_for(self.database, campaign_id, request)

    def until(self, state: CampaignState, campaign_id: str) -> CampaignRecord:
        wait_until(lambda: self.record(campaign_id).state is state)
        return self.record(campaign_id)

    def engine_pid(self, campaign_id: str) -> int:
        """Returns the process of a campaign that was started last."""
        return engine_pid(self.setup.folder(campaign_id).path)

    def engine(self, campaign_id: str) -> int:
        """Returns the process of a campaign, once it has queued as many runs as may wait."""
        wait_until(lambda: self.queued_runs(campaign_id) == WAITING)
        return self.engine_pid(campaign_id)


WAITING = 9
"""Runs of a campaign that wait: its eight candidates and its seed scenario."""


def wait_until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + _LONG_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)
