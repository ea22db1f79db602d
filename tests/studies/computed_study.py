"""Stored campaigns of real testers on a real network whose runs are computed, not simulated."""

from __future__ import annotations

import contextlib
import copy
import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.stored_campaigns import new_campaign, run_stored
from drivora_service.feedback.measurement import Measurement
from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignRecord
from drivora_service.store.database import Database, open_database
from tests.campaigns.analytic import Computed


def perform(spec: RunSpec) -> RunReport:
    """Computes a run: it fails where the first NPC vehicle starts fast, and at that place.

    Where it starts a little slower, the ego is hit by another's fault. A seed scenario, which has
    none, does not fail.
    """
    scenario = json.loads(spec.document)
    vehicles = scenario["npc_vehicles"]
    start = vehicles[0]["route"][0] if vehicles else {"x": 0.0, "y": 0.0, "speed": 0.0}
    violated = start["speed"] > 10.0
    is_hit = 8.0 < start["speed"] <= 10.0
    verdict = Verdict(
        oracle="collision",
        ego="ego",
        outcome=Outcome.VIOLATED if violated or is_hit else Outcome.PASSED,
        message="",
        at_fault=violated,
        avoidable=tuple(Answer)[int(start["x"]) % 3] if violated else None,
        time=start["speed"] if violated else None,
        step=1 if violated else None,
        location=(start["x"], start["y"]) if violated else None,
        counterpart="vehicle_0" if violated else "",
        evidence={"ego_speed": start["speed"]},
    )
    gap = 20.0 - float(start["speed"])
    return RunReport(
        run_id=spec.run_id,
        status=RunStatus.FINISHED,
        verdicts=(verdict,),
        scores={"min_gap": gap},
        measurement=Measurement(objectives={"min_gap": gap, "safety_margin": gap}),
        trace_sha256=hashlib.sha256(spec.document.encode()).hexdigest(),
        steps=100,
        sim_time_s=5.0,
        wall_time_s=0.1 + 0.01 * len(scenario["npc_walkers"]),
        privileged=tuple(
            ego["id"]
            for ego in scenario["ego_vehicles"]
            if ego["agent"]["name"].startswith("sumo-")
        ),
    )


class Study:
    """A database with finished campaigns."""

    def __init__(self, database: Database, catalogues: Catalogues, root: Path) -> None:
        self.database, self.catalogues, self.root = database, catalogues, root

    def create(self, content: dict[str, Any], **changes: Any) -> str:
        valid = read_campaign(copy.deepcopy(content) | changes, self.catalogues)
        with self.database.write() as transaction:
            return transaction.campaigns.create(new_campaign(valid)).id

    def run(self, content: dict[str, Any], **changes: Any) -> CampaignRecord:
        return self.continued(self.create(content, **changes))

    def continued(self, campaign_id: str) -> CampaignRecord:
        return run_stored(
            self.database,
            campaign_id,
            CampaignFolder(self.root, campaign_id),
            catalogues=self.catalogues,
            evaluator=lambda _workers: contextlib.closing(Computed(work=perform)),
        )


@contextlib.contextmanager
def opened(folder: Path, catalogues: Catalogues) -> Iterator[Study]:
    """Opens a data folder."""
    database = open_database(f"sqlite:///{folder / 'drivora.sqlite3'}")
    try:
        yield Study(database, catalogues, folder / "campaigns")
    finally:
        database.close()


def campaign_content() -> dict[str, Any]:
    """A small campaign, as a document."""
    return {
        "name": "crossing",
        "tester": {"name": "random"},
        "agent": {"name": "idm"},
        "scenario": copy.deepcopy(SCENARIO),
        "space": {"vehicles": 2, "walkers": 2},
        "oracles": ["collision"],
        "budget": {"simulations": 12},
        "seed": 3,
    }
