"""Campaigns of real runs: the same with any number of workers, paused and resumed."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LOCAL
from drivora_service.campaigns.evaluator import Evaluator, EvaluatorContext
from drivora_service.campaigns.hosts.campaign_requests import ask_for
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.campaigns.records.stored_campaigns import new_campaign, run_stored
from drivora_service.campaigns.search.conducting import Watcher
from drivora_service.campaigns.search.engine import Told
from drivora_service.errors import CampaignError, Conflict, UnknownName
from drivora_service.execution.executor import Limits
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
    Confirmation,
    EvaluationRecord,
)
from drivora_service.store.database import Database
from drivora_service.store.locks.work_locks import LongWork
from drivora_service.worker.setup import WorkerSetup
from tests.agents.remote.folders import add_agent
from tests.campaigns.analytic import sequence

PAUSE, NONE = CampaignRequest.PAUSE, CampaignRequest.NONE


class Campaigns:
    """Campaigns in a database, run by local workers."""

    def __init__(self, database: Database, catalogues: Catalogues, folder: Path) -> None:
        self.database, self.catalogues, self.root = database, catalogues, folder

    def create(self, content: dict[str, Any]) -> str:
        valid = read_campaign(content, self.catalogues)
        with self.database.write() as transaction:
            return transaction.campaigns.create(new_campaign(valid)).id

    def folder(self, campaign_id: str) -> CampaignFolder:
        return CampaignFolder(self.root / "campaigns", campaign_id)

    def run(self, campaign_id: str, workers: int, watcher: Watcher | None = None) -> CampaignRecord:
        @contextlib.contextmanager
        def evaluator(_wanted: int | None) -> Iterator[Evaluator]:
            context = EvaluatorContext(
                workers=workers,
                setup=WorkerSetup(shipped_networks=shipped_networks(), agents=self.root / "agents"),
                limits=Limits(),
                folder=self.root / "workers",
            )
            with contextlib.closing(LOCAL.create(context)) as made:
                yield made

        return run_stored(
            self.database,
            campaign_id,
            self.folder(campaign_id),
            catalogues=self.catalogues,
            evaluator=evaluator,
            watcher=watcher or Watcher(),
        )

    def evaluations(self, campaign_id: str) -> list[EvaluationRecord]:
        return list(StoreJournal(self.database, campaign_id).evaluations())

    def record(self, campaign_id: str) -> CampaignRecord:
        with self.database.read() as transaction:
            return transaction.campaigns.get(campaign_id)


@pytest.fixture
def campaigns(database: Database, catalogues: Catalogues, tmp_path: Path) -> Campaigns:
    return Campaigns(database, catalogues, tmp_path)


def after(count: int) -> tuple[Watcher, Callable[[], int]]:
    """A watcher that requests a pause after so many new evaluations."""
    told: list[int] = []
    watcher = Watcher(
        requested=lambda: PAUSE if len(told) >= count else NONE,
        on_told=lambda t: None if t.replayed else told.append(t.record.number),
    )
    return watcher, lambda: len(told)


@pytest.mark.slow
def test_workers_and_pauses_do_not_change_a_campaign(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    alone = campaigns.create(content)
    assert campaigns.run(alone, 1).state is CampaignState.FINISHED
    whole = campaigns.evaluations(alone)
    assert campaigns.record(alone).counts.simulations == 12

    paused = campaigns.create(content)
    for count in (5, 3):
        watcher, told = after(count)
        assert campaigns.run(paused, 2, watcher).state is CampaignState.PAUSED
        assert told() == count
    record = campaigns.run(paused, 2)
    assert record.state is CampaignState.FINISHED
    assert record.active_s > 0.0
    assert sequence(campaigns.evaluations(paused)) == sequence(whole)
    hashes = [e.report.trace_sha256 for e in whole]
    assert [e.report.trace_sha256 for e in campaigns.evaluations(paused)] == hashes
    assert len(set(hashes)) > 10


@pytest.mark.slow
def test_failures_are_confirmed_and_their_traces_kept(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    campaign_id = campaigns.create(content)
    campaigns.run(campaign_id, 2)
    with campaigns.database.read() as transaction:
        failures = transaction.evaluations.failures(campaign_id)
    assert failures
    by_number = {e.number: e for e in campaigns.evaluations(campaign_id)}
    for failure in failures:
        assert failure.confirmation is Confirmation.CONFIRMED
        assert failure.group is not None
        trace = read_trace(campaigns.folder(campaign_id).trace(failure.trace))
        assert trace_sha256(trace) == by_number[failure.evaluation].report.trace_sha256
        assert failure.kind.startswith(failure.verdict.oracle)
    assert {f.evaluation for f in failures} == {n for n, e in by_number.items() if e.violations}


@pytest.mark.slow
def test_a_campaign_that_fails_states_the_reason(
    database: Database, content: dict[str, Any], tmp_path: Path
) -> None:
    manifest = tmp_path / "agents" / "mute" / "agent.yaml"
    manifest.parent.mkdir(parents=True)
    manifest.write_text(
        "{name: mute, kind: baseline, description: ends at once, source: here, licence: MIT, "
        'command: ["{python}", -c, pass]}'
    )
    networks = NetworkCatalogue(shipped_networks())
    catalogues = Catalogues(networks, manifest.parents[1])
    campaigns = Campaigns(database, catalogues, tmp_path)
    content["agent"] = {"name": "mute"}
    content["budget"]["simulations"] = 30
    campaign_id = campaigns.create(content)
    with pytest.raises(CampaignError, match="agent 'mute'"):
        campaigns.run(campaign_id, 2)
    record = campaigns.record(campaign_id)
    assert record.state is CampaignState.FAILED
    assert "agent 'mute'" in record.message


def test_one_process_works_on_a_campaign(campaigns: Campaigns, content: dict[str, Any]) -> None:
    campaign_id = campaigns.create(content)
    lock = campaigns.database.locks.hold(LongWork.campaign(campaign_id))
    with pytest.raises(Conflict, match="running campaign"):
        campaigns.run(campaign_id, 1)
    lock.release()
    assert campaigns.run(campaign_id, 1, after(1)[0]).state is CampaignState.PAUSED
    assert not campaigns.database.locks.is_held(LongWork.campaign(campaign_id))


def test_a_process_that_has_lost_its_campaign_writes_no_more(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    campaign_id = campaigns.create(content)

    def lose(told: Told) -> None:
        if told.record.number == 2:
            with campaigns.database.write() as transaction:
                transaction.campaigns.begin(campaign_id, claim="of another process")

    with pytest.raises(Conflict, match="another process has taken campaign"):
        campaigns.run(campaign_id, 1, Watcher(on_told=lose))
    assert len(campaigns.evaluations(campaign_id)) <= 3
    assert campaigns.record(campaign_id).state is CampaignState.RUNNING


def test_asking_a_campaign_whose_process_was_killed_takes_effect_at_once(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    campaign_id = campaigns.create(content)
    with campaigns.database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
    lock = campaigns.database.locks.hold(LongWork.campaign(campaign_id))
    alive = ask_for(campaigns.database, campaign_id, PAUSE)
    assert (alive.state, alive.request) == (CampaignState.RUNNING, PAUSE)
    lock.release()
    dead = ask_for(campaigns.database, campaign_id, PAUSE)
    assert (dead.state, dead.request) == (CampaignState.PAUSED, NONE)


def test_a_campaign_on_a_changed_network_is_refused(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    valid = read_campaign(content, campaigns.catalogues)
    new = replace(new_campaign(valid), network_sha256="0" * 64)
    with campaigns.database.write() as transaction:
        campaign_id = transaction.campaigns.create(new).id
    with pytest.raises(CampaignError, match="'tee-town' has changed"):
        campaigns.run(campaign_id, 1)
    assert campaigns.record(campaign_id).state is CampaignState.FAILED


def test_a_campaign_of_other_versions_cannot_be_resumed(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    new = new_campaign(read_campaign(content, campaigns.catalogues))
    older = replace(new, versions={**new.versions, "libsumo": "1.2.3"})
    with campaigns.database.write() as transaction:
        campaign_id = transaction.campaigns.create(older).id
    # No evaluation yet: no version has had an effect.
    assert campaigns.run(campaign_id, 1, after(3)[0]).state is CampaignState.PAUSED
    before = campaigns.record(campaign_id).counts
    with pytest.raises(CampaignError, match=r"libsumo was 1\.2\.3 and is") as refusal:
        campaigns.run(campaign_id, 1)
    assert "Its results are kept" in str(refusal.value)
    assert campaigns.record(campaign_id).counts == before


@pytest.mark.slow
def test_a_campaign_with_another_version_of_its_ads_cannot_be_resumed(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    agents = campaigns.root / "agents"
    add_agent(agents, "drives", version="week 47")
    campaigns.catalogues = Catalogues(campaigns.catalogues.networks, agents)
    campaign_id = campaigns.create({**content, "agent": {"name": "drives"}, "lookahead": 1})
    assert campaigns.run(campaign_id, 1, after(1)[0]).state is CampaignState.PAUSED
    (first,) = campaigns.evaluations(campaign_id)
    assert first.report.versions["drives"] == "week 47"
    shutil.rmtree(agents)
    add_agent(agents, "drives", version="week 48")
    with pytest.raises(CampaignError, match="drives was week 47 and is week 48"):
        campaigns.run(campaign_id, 1)


def test_an_ended_campaign_is_not_run_again(campaigns: Campaigns, content: dict[str, Any]) -> None:
    campaign_id = campaigns.create(content)
    ask_for(campaigns.database, campaign_id, CampaignRequest.CANCEL)
    with pytest.raises(Conflict, match="cancelled"):
        campaigns.run(campaign_id, 1)
    with pytest.raises(UnknownName):
        campaigns.run("nothing", 1)
