"""Counts needless detours whose actors enter the area that Decictor keeps free.

    drivora study run benchmarks/studies/needless-detours.yaml --data-dir FOLDER
    python -m benchmarks.invasive_detours FOLDER STUDY --method random

Decictor changes a scenario only outside the area that the ego could use on its reference path
(`search.space.usable_area`), other methods draw actors anywhere. So their detours can be such that
Decictor never proposes. Counted are all detours and every fourth other simulation.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from benchmarks.search_scenes import catalogues
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.markdown_text import table
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.model import Scenario
from drivora_service.search.space.usable_area import intruders
from drivora_service.simulation.followers.free_motion import plan_motions
from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.store.database import Database, open_database

_EVERY = 4
_MOST = 1000
"""Evaluations of a campaign that are looked at."""


def is_invasive(scenario: Scenario) -> bool:
    """Returns whether an actor is planned to enter the area of an ego."""
    names = frozenset(
        actor.id
        for actors in (scenario.npc_vehicles, scenario.npc_walkers, scenario.npc_obstacles)
        for actor in actors
    )
    network = catalogues().networks.get(scenario.map_region.town)
    return bool(intruders(scenario, network, names, plan_motions))


def count(database: Database, study_id: str, method: str) -> dict[str, Counter[tuple[bool, bool]]]:
    """Returns for each scene the numbers of simulations by detour or not, and invasive or not."""
    with database.read() as transaction:
        ids = transaction.studies.campaign_ids(study_id, (CampaignState.FINISHED,))
        records = [transaction.campaigns.get(campaign_id) for campaign_id in ids]
    found: dict[str, Counter[tuple[bool, bool]]] = {}
    for record in records:
        if record.cell is None or record.cell.method != method:
            continue
        counter = found.setdefault(record.cell.scenario, Counter())
        journal = StoreJournal(database, record.id)
        detours = {one.number for one in journal.evaluations() if one.violations}
        with database.read() as transaction:
            page = transaction.evaluations.documents(record.id, after=-1, limit=_MOST)
        for number, text in page:
            if number in detours or number % _EVERY == 0:
                counter[number in detours, is_invasive(from_canonical(text))] += 1
    return found


def main(arguments: Sequence[str]) -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="data folder of the study")
    parser.add_argument("study", help="id of the study")
    parser.add_argument("--method", default="random")
    options = parser.parse_args(arguments)
    database = open_database(f"sqlite:///{options.folder.resolve() / 'drivora.sqlite3'}")
    try:
        found = count(database, options.study, options.method)
    finally:
        database.close()
    columns = ("scene", "detours", "of these invasive", "others", "of these invasive")
    rows = [
        (
            scene,
            str(counter[True, True] + counter[True, False]),
            str(counter[True, True]),
            str(counter[False, True] + counter[False, False]),
            str(counter[False, True]),
        )
        for scene, counter in found.items()
    ]
    print("\n".join(table(columns, rows)))


if __name__ == "__main__":
    main(sys.argv[1:])
