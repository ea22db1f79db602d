"""What the lists of failures count is what they state."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.failure_definition import (
    Counted,
    FailureDefinition,
    KnownFailure,
    definition_to_json,
)
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.runs.run_records import Priority, RunOptions
from tests.store.campaigns.test_campaign_repository import append, create, evaluation
from tests.store.samples import claim, ended, finish, new_run, register

DATA = Path(__file__).parent / "data"


def violated(oracle: str, **changes: object) -> Verdict:
    verdict = Verdict(
        oracle=oracle, ego="ego", outcome=Outcome.VIOLATED, message=oracle, at_fault=True, time=1
    )
    return replace(verdict, **changes)  # type: ignore[arg-type] # names of its fields


CRASH = violated("collision")
TAILGATING = violated("tailgating", severity=Severity.OBSERVATION, at_fault=None)
NOT_ARRIVED = violated("destination", follows="collision")


def post(database: Database, definition: FailureDefinition, *reports: tuple[Verdict, ...]) -> str:
    """Stores a batch of runs with these verdicts."""
    text = definition_to_json(definition)
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CI)
        runs = [
            new_run(str(place), options=RunOptions(definition=text))
            for place in range(len(reports))
        ]
        ids = transaction.jobs.submit(runs, batch_id=batch.id)
    owner = register(database)
    claim(database, owner, len(ids))
    for run_id, verdicts in zip(ids, reports, strict=True):
        report = RunReport(run_id=run_id, status=RunStatus.FINISHED, verdicts=verdicts)
        finish(database, owner, ended(report))
    return batch.id


def listed(database: Database, wanted: FoundFilter) -> list[str]:
    """Returns the oracles of the failures of a filter, which its counts and groups count, too."""
    with database.read() as transaction:
        items = transaction.found.page(wanted).items
        assert transaction.found.counts(wanted).failures == len(items)
    return sorted(one.oracle for one in items)


def test_what_only_the_definition_of_a_run_counts_is_not_counted_on_request(
    database: Database,
) -> None:
    own = FailureDefinition(oracles=("destination", "tailgating"))
    verdicts = (CRASH, TAILGATING, NOT_ARRIVED)
    chosen, usual = post(database, own, verdicts), post(database, FailureDefinition(), verdicts)
    assert listed(database, FoundFilter(batch_id=chosen)) == ["destination", "tailgating"]
    for counts in Counted:
        for batch in (chosen, usual):
            wanted = FoundFilter(batch_id=batch, counts=counts)
            assert listed(database, wanted) == ["collision"]
            with database.read() as transaction:
                definition = transaction.found.counts(wanted).definition
            assert definition is not None
            assert definition.words.endswith("of all oracles but observations")
            for oracle in ("destination", "tailgating"):
                assert listed(database, replace(wanted, oracle=oracle)) == []


def test_observations_that_a_campaign_counts_are_not_counted_on_request(
    database: Database,
) -> None:
    record = evaluation(0, violated=(True, True, True))
    near = replace(record.violations[0], oracle="near_miss", severity=Severity.OBSERVATION)
    late = replace(record.violations[1], oracle="destination", follows="collision")
    campaign = create(database)
    append(database, campaign, replace(record, violations=(near, late, record.violations[2])))
    assert len(listed(database, FoundFilter(campaign_id=campaign))) == 3
    for counts in (Counted.ACCOUNTABLE, Counted.ANY):
        wanted = FoundFilter(campaign_id=campaign, counts=counts)
        assert listed(database, wanted) == ["collision"]


def test_a_group_of_what_only_runs_count_is_shown(database: Database) -> None:
    post(database, FailureDefinition(oracles=("tailgating",)), (TAILGATING,))
    with database.read() as transaction:
        (group,) = transaction.groups.page().items
        assert transaction.groups.get(group.id) == group
        assert transaction.found.has_oracle("tailgating")
        assert not transaction.found.has_oracle("nosuch")


def test_runs_in_which_the_ads_failed_are_counted_beside(database: Database) -> None:
    known = FailureDefinition(known=(KnownFailure(oracle="agent_failed"),))
    texts = definition_to_json(FailureDefinition()), definition_to_json(known)
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CI)
        runs = [
            new_run(str(place), options=RunOptions(definition=text))
            for place, text in enumerate(texts)
        ]
        ids = transaction.jobs.submit(runs, batch_id=batch.id)
    owner = register(database)
    claim(database, owner, 2)
    failure = RunFailure(cause="agent_raised", message="no")
    for run_id in ids:
        report = RunReport(run_id=run_id, status=RunStatus.AGENT_FAILED, failure=failure)
        finish(database, owner, ended(report))
    post(database, FailureDefinition(), (CRASH,))
    for wanted, number in (
        (FoundFilter(batch_id=batch.id), 1),
        (FoundFilter(), 1),
        (FoundFilter(counts=Counted.ACCOUNTABLE), 2),
        (FoundFilter(agent="idm", town="tee-town"), 1),
        (FoundFilter(agent="other"), 0),
        (FoundFilter(oracle="collision"), None),
    ):
        with database.read() as transaction:
            assert transaction.found.counts(wanted).agent_failed_runs == number, wanted


@pytest.mark.parametrize(
    ("oracle", "before", "after"),
    [
        ("near_miss", '"severity":"major"', '"severity":"observation"'),
        ("destination", '"evidence":{', '"evidence":{"reason":"collision",'),
    ],
)
def test_migrated_observations_of_campaigns_are_not_counted_on_request(
    tmp_path: Path, oracle: str, before: str, after: str
) -> None:
    path = tmp_path / "old.sqlite3"
    with closing(sqlite3.connect(path)) as old:
        old.executescript((DATA / "revision_0021.sql").read_text())
        of_failure = "campaign_seq = 1 AND number = 0 AND place = 0"
        for table in ("failures", "found_failures"):
            old.execute(f"UPDATE {table} SET oracle = '{oracle}' WHERE {of_failure}")
        old.execute(
            "UPDATE failures SET verdict = "
            f"replace(replace(verdict, 'collision', '{oracle}'), '{before}', '{after}') "
            f"WHERE {of_failure}"
        )
        old.commit()
    database = open_database(f"sqlite:///{path}")
    with database.read() as transaction:
        (campaign,) = {one.campaign_id for one in transaction.found.page().items} - {""}
    assert oracle in listed(database, FoundFilter(campaign_id=campaign))
    everything = FoundFilter(campaign_id=campaign, counts=Counted.ANY)
    assert oracle not in listed(database, everything)
    assert "collision" in listed(database, everything)
    database.close()
