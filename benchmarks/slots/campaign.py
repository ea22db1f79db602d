"""The own processor time of a campaign, with the engine, the journal and the slots in it."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from datetime import UTC, datetime
from pathlib import Path

from benchmarks.slots.service import Point, Recording, point_of
from benchmarks.slots.spent import Spent, measure_spent
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import MAX_LOOKAHEAD
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.stored_campaigns import new_campaign, run_stored
from drivora_service.campaigns.search.conducting import Watcher
from drivora_service.execution.executor import Executor
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.store.campaigns.campaign_records import CampaignRequest
from drivora_service.store.database import open_database

_EXAMPLES = Path(__file__).parents[2] / "openscenario_schemas" / "examples" / "campaigns"
_SPARE = 4
"""Candidates that may wait, for each slot."""


def measure(
    executor: Executor,
    folder: Path,
    *,
    kind: str,
    run_s: float,
    seconds: float,
    warm_s: float,
) -> Point:
    """Runs a campaign of random search, and measures after it has begun.

    Args:
        executor: Performs the runs; closed at the end.
        folder: For the database and the campaign.
        kind: See :class:`Point`.
        run_s: Expected seconds of a run.
        seconds: Time to measure.
        warm_s: Time before, from when every slot has ended a run.
    """
    recording = Recording(executor)
    budget = round(3.0 * (seconds + warm_s + 1.0) * executor.capacity / run_s)
    due: list[float] = []
    marks: list[tuple[datetime, Spent]] = []

    def requested() -> CampaignRequest:
        now = time.monotonic()
        if not due and recording.is_warm:
            due.extend((now + warm_s, now + warm_s + seconds))
        if len(marks) < len(due) and now >= due[len(marks)]:
            marks.append((datetime.now(UTC), measure_spent(executor)))
        return CampaignRequest.PAUSE if len(marks) > 1 else CampaignRequest.NONE

    @contextmanager
    def evaluator(_workers: int | None) -> Iterator[Evaluator]:
        with closing(LocalEvaluator(recording)) as created:
            yield created

    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    database = open_database(f"sqlite:///{folder / 'drivora.sqlite3'}")
    try:
        valid = read_campaign(_document(budget, _SPARE * executor.capacity), catalogues)
        with database.write() as transaction:
            campaign = transaction.campaigns.create(new_campaign(valid))
        run_stored(
            database,
            campaign.id,
            CampaignFolder(folder / "campaigns", campaign.id),
            catalogues=catalogues,
            evaluator=evaluator,
            watcher=Watcher(requested=requested),
        )
    finally:
        database.close()
    (first, before), (last, after) = marks
    return point_of(
        recording.ends, executor, kind=kind, between=(first, last), used=after.since(before)
    )


def _document(budget: int, lookahead: int) -> dict[str, object]:
    return {
        "name": "slots",
        "agent": {"name": "idm"},
        "scenario": json.loads((_EXAMPLES / "highway-in-rain.json").read_text()),
        "space": {"vehicles": 4, "walkers": 0, "weather": False},
        "tester": {"name": "random"},
        "oracles": ["collision"],
        "budget": {"simulations": budget},
        "lookahead": min(lookahead, MAX_LOOKAHEAD),
    }
