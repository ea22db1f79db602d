from __future__ import annotations

import json

from drivora_service.store.campaigns.campaign_records import CampaignState, NewCampaign
from drivora_service.store.database import Database
from drivora_service.store.upkeep.network_use import NetworkUse
from tests.store.samples import claim, finish, finished, new_run, register

NONE = NetworkUse(runs=0, campaigns=0, minimizations=0)


def use(database: Database, name: str) -> NetworkUse:
    with database.read() as transaction:
        return transaction.network_use(name)


def test_runs_count_until_they_have_ended(database: Database) -> None:
    town = new_run().town
    assert use(database, town) == NONE
    with database.write() as transaction:
        transaction.jobs.submit([new_run(), new_run()], owner_id="", queue_limit=10)
    assert use(database, town).runs == 2
    owner = register(database)
    for run in claim(database, owner, 1):
        assert use(database, town).runs == 2
        finish(database, owner, finished(run))
    assert use(database, town) == NetworkUse(runs=1, campaigns=0, minimizations=0)
    assert use(database, "elsewhere") == NONE


def test_campaigns_count_on_the_network_of_each_seed_scenario(database: Database) -> None:
    towns = ["tee-town", "rural"]
    seeds = [{"scenario": {"map_region": {"town": town}}} for town in towns]
    campaign = NewCampaign(
        name="search",
        document=json.dumps({"name": "search", "scenarios": seeds}),
        tester="random",
        agent="idm",
        town=", ".join(towns),
        network_sha256="a" * 64,
        budget=10,
    )
    with database.write() as transaction:
        of_service = transaction.campaigns.create(campaign).id
        transaction.campaign_runs.open(of_service)
        # That of a command, whose end is not known.
        transaction.campaigns.create(campaign)
    assert [use(database, town).campaigns for town in (*towns, "old-town")] == [1, 1, 0]
    with database.write() as transaction:
        transaction.campaigns.begin(of_service)
    assert use(database, "rural").campaigns == 1
    with database.write() as transaction:
        transaction.campaigns.end(of_service, CampaignState.PAUSED)
    assert use(database, "rural") == NONE


def test_the_numbers_in_words() -> None:
    assert NONE.counted == ""
    assert NetworkUse(runs=1, campaigns=2, minimizations=1).counted == (
        "1 run, 2 campaigns, 1 minimisation"
    )
