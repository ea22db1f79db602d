"""Runs, campaigns and failures of one ADS with different parameters, in the store."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from importlib import import_module
from pathlib import Path

from sqlalchemy import text

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.database import Database, open_database
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.runs.result_records import ResultFilter
from drivora_service.store.runs.run_counts import ConfigurationCount
from drivora_service.store.runs.run_records import JobFilter
from drivora_service.store.upkeep.facet_verification import facet_findings
from tests.store.samples import claim, finish, finished, new_run, register

DATA = Path(__file__).parent / "data"
PLAIN = AgentConfiguration(words="idm", id="aaaaaaaa")
SLOWED = AgentConfiguration(words="idm · reaction_time 1.0", id="bbbbbbbb")


def fill(database: Database) -> dict[str, AgentConfiguration]:
    """Ends two runs of one ADS with other parameters, each with a failure."""
    owner = register(database)
    with database.write() as transaction:
        ids = transaction.jobs.submit(
            [new_run(one.words, configuration=one) for one in (PLAIN, SLOWED)]
        )
    claim(database, owner, 2)
    finish(database, owner, *(finished(one, "collision") for one in ids))
    return dict(zip(ids, (PLAIN, SLOWED), strict=True))


def test_runs_of_one_agent_with_other_parameters_are_told_apart(database: Database) -> None:
    known = fill(database)
    with database.read() as transaction:
        every = transaction.jobs.page(JobFilter(agent="idm")).items
        slowed = transaction.jobs.page(JobFilter(configuration_id=SLOWED.id)).items
        by_oracle = transaction.jobs.page(
            JobFilter(configuration_id=SLOWED.id, oracle="collision")
        ).items
        numbers = transaction.results.numbers(
            ResultFilter(runs=JobFilter(configuration_id=SLOWED.id)), after=0, limit=9
        )
    assert {
        run.id: AgentConfiguration(words=run.configuration, id=run.configuration_id)
        for run in every
    } == known
    assert [run.configuration for run in slowed] == [SLOWED.words]
    assert [run.id for run in by_oracle] == [run.id for run in slowed]
    assert len(numbers) == 1


def test_runs_are_counted_by_configuration(database: Database) -> None:
    fill(database)
    with database.read() as transaction:
        every = transaction.jobs.counts_by_filter(JobFilter())
        slowed = transaction.jobs.counts_by_filter(JobFilter(configuration_id=SLOWED.id))
        assert list(facet_findings(transaction.session)) == []
    both = tuple(ConfigurationCount(id=one.id, words=one.words, runs=1) for one in (PLAIN, SLOWED))
    assert (every.total, every.agent, every.configurations) == (2, {"idm": 2}, both)
    # As of every part: what a list would have with another value of it.
    assert (slowed.total, slowed.configurations) == (1, both)


def test_failures_are_those_of_a_configuration(database: Database) -> None:
    fill(database)
    with database.read() as transaction:
        every = transaction.found.page(FoundFilter(agent="idm")).items
        slowed = transaction.found.page(FoundFilter(configuration_id=SLOWED.id)).items
    assert {(one.configuration, one.configuration_id) for one in every} == {
        (one.words, one.id) for one in (PLAIN, SLOWED)
    }
    assert [one.configuration for one in slowed] == [SLOWED.words]


def test_a_run_without_a_known_configuration_shows_its_agent(database: Database) -> None:
    with database.write() as transaction:
        (run_id,) = transaction.jobs.submit([new_run(agent="idm,other")])
    with database.read() as transaction:
        run = transaction.jobs.get(run_id)
        counts = transaction.jobs.counts_by_filter(JobFilter())
    assert (run.configuration, run.configuration_id) == ("idm,other", "")
    assert counts.configurations == ()


def test_runs_of_older_versions_get_their_configuration_from_their_scenarios(
    tmp_path: Path,
) -> None:
    path = tmp_path / "old.sqlite3"
    slow = {"name": "idm", "parameters": {"reaction_time": 1.0}}
    own = {"name": "own-planner", "parameters": {}}
    with closing(sqlite3.connect(path)) as old:
        old.executescript((DATA / "revision_0020.sql").read_text())
        documents = [sha for (sha,) in old.execute("SELECT DISTINCT document_sha256 FROM runs")]
        for place, sha256 in enumerate(documents):
            egos = [{"id": "ego", "agent": (slow, own)[place % 2]}]
            body = json.dumps({"ego_vehicles": egos})
            old.execute("UPDATE documents SET body = ? WHERE sha256 = ?", (body, sha256))
        campaign = {"agent": slow, "scenario": {"ego_vehicles": []}, "scenarios": None}
        old.execute("UPDATE campaigns SET document = ?", (json.dumps(campaign),))
        before = dict(old.execute("SELECT id, document_sha256 FROM runs").fetchall())
        old.commit()
    database = open_database(f"sqlite:///{path}")
    slowed = AgentCatalogue().configuration(
        [AgentChoice(name="idm", parameters={"reaction_time": 1.0})]
    )
    with database.read() as transaction:
        runs = transaction.jobs.page(JobFilter(), limit=100).items
        found = transaction.jobs.page(JobFilter(configuration_id=slowed.id), limit=100).items
        campaigns = transaction.campaigns.page().items
        failures = transaction.found.page(FoundFilter(configuration_id=slowed.id)).items
        assert list(facet_findings(transaction.session)) == []
    database.close()
    wanted = {run_id for run_id, sha256 in before.items() if documents.index(sha256) % 2 == 0}
    assert {run.id for run in found} == wanted
    assert 0 < len(wanted) < len(runs)
    # An ADS that this installation does not know: its defaults are not known either.
    assert {(run.configuration, run.configuration_id) for run in runs if run.id not in wanted} == {
        (run.agent, "") for run in runs if run.id not in wanted
    }
    assert {(one.configuration, one.configuration_id) for one in campaigns} == {
        (slowed.words, slowed.id)
    }
    assert any(one.campaign_id for one in failures)


def test_the_migration_fills_in_what_would_have_been_written(database: Database) -> None:
    fill(database)
    agents = AgentCatalogue()
    slow = AgentChoice(name="idm", parameters={"reaction_time": 1.0})
    slowed = agents.configuration([slow])
    egos = [{"id": "ego", "agent": {"name": "idm", "parameters": dict(slow.parameters)}}]
    migration = import_module("drivora_service.store.migrations.versions.0021_configurations")
    with database.engine.begin() as connection:
        # As the databases of the version before were: nothing is known of parameters.
        body = {"body": json.dumps({"ego_vehicles": egos})}
        connection.execute(text("UPDATE documents SET body = :body"), body)
        for table in ("runs", "found_failures", "facets"):
            nothing = "configuration = agent, configuration_id = ''"
            connection.execute(text(f"UPDATE {table} SET {nothing}"))
        migration._fill_runs(connection, agents, frozenset(agents.names()))
        migration._fill_campaigns(connection, agents, frozenset(agents.names()))
        migration._fill_found(connection)
        migration._fill_facets(connection)
    with database.read() as transaction:
        runs = transaction.jobs.page(JobFilter(configuration_id=slowed.id)).items
        failures = transaction.found.page(FoundFilter(configuration_id=slowed.id)).items
        by_oracle = transaction.jobs.page(
            JobFilter(configuration_id=slowed.id, oracle="collision")
        ).items
        assert list(facet_findings(transaction.session)) == []
    assert [run.configuration for run in runs] == [slowed.words] * 2
    assert (len(failures), len(by_oracle)) == (2, 2)
