"""A small study, as a document, and studies whose runs are computed."""

from __future__ import annotations

import contextlib
import copy
from pathlib import Path
from typing import Any

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.stored_campaigns import run_stored
from drivora_service.store.database import Database
from drivora_service.studies.service_studies import ServiceStudies
from drivora_service.studies.study_reading import read_study
from drivora_service.studies.study_storing import store_study
from tests.campaigns.analytic import Computed
from tests.studies.computed_study import perform


def study_content() -> dict[str, Any]:
    """Two scenarios, two agents, two methods and two repetitions."""
    return {
        "name": "crossings",
        "scenarios": [
            {"label": "first", "document": copy.deepcopy(SCENARIO)},
            {
                "label": "second",
                "document": {**copy.deepcopy(SCENARIO), "seed": 2},
                "space": {"vehicles": 1, "walkers": 2},
            },
        ],
        "agents": [{"name": "idm"}, {"name": "idm-mobil"}],
        "methods": [{"name": "random"}, {"name": "avfuzzer", "label": "fuzzer"}],
        "repetitions": 2,
        "seed": 3,
        "space": {"vehicles": 2, "walkers": 1},
        "oracles": ["collision"],
        "budget": {"simulations": 8},
    }


class Waiting:
    """A host of campaigns that only accepts them, without runs of its own."""

    def open(self, transaction: object, campaign_id: str) -> None:
        """Accepts a campaign."""

    def resume(self, campaign_id: str) -> None:
        """Accepts a campaign."""

    def wake(self) -> None:
        """Does nothing."""


def stored(database: Database, catalogues: Catalogues, root: Path, **changes: Any) -> str:
    """Stores a study; returns its id."""
    host = ServiceStudies(database, Waiting())
    study = read_study(study_content() | changes, catalogues)
    with database.write() as transaction:
        return store_study(transaction, study, host)


def run_computed(database: Database, catalogues: Catalogues, root: Path, study_id: str) -> None:
    """Runs every campaign of a study with computed runs."""
    with database.read() as transaction:
        ids = transaction.studies.campaign_ids(study_id)
    for campaign_id in ids:
        run_stored(
            database,
            campaign_id,
            CampaignFolder(root / "campaigns", campaign_id),
            catalogues=catalogues,
            evaluator=lambda _workers: contextlib.closing(Computed(work=perform)),
        )
