"""Engines in processes of their own, without workers for their queued runs."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.records.stored_campaigns import new_campaign
from drivora_service.search.catalogue import TesterCatalogue
from drivora_service.store.campaigns.campaign_records import (
    CampaignRequest,
    CampaignState,
)
from drivora_service.store.database import Database
from drivora_service.store.locks.work_locks import LongWork
from tests.campaigns.hosts.engine_service import WAITING, Service, wait_until
from tests.damaged_files import overwrite_page

pytestmark = pytest.mark.slow

RUNNING, QUEUED = CampaignState.RUNNING, CampaignState.QUEUED


DYING = """
import os

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.testers.random_search import RandomParameters


def die(*_given):
    print("about to die", flush=True)
    os._exit(7)


DYING = TesterPlugin(
    name="dying",
    title="Dying",
    description="takes its process down",
    source="the tests",
    parameters=RandomParameters,
    feedback=FeedbackChoice(name="general"),
    create=die,
    is_generational=False,
)
"""


@pytest.fixture
def service(database: Database, catalogues: Catalogues, tmp_path: Path) -> Iterator[Service]:
    made = Service(database, catalogues, tmp_path)
    yield made
    made.supervisor.stop()


def test_an_engine_queues_runs_and_never_loads_the_simulator(
    service: Service, content: dict[str, Any]
) -> None:
    campaign = service.post(content)
    service.supervisor.start()
    engine = psutil.Process(service.engine(campaign))
    assert service.record(campaign).state is RUNNING
    wait_until(lambda: bool(service.queued))
    assert engine.pid != os.getpid()
    assert not [m.path for m in engine.memory_maps() if "libsumo" in m.path]
    service.supervisor.stop()
    assert not engine.is_running()
    assert service.record(campaign).state is RUNNING


def test_the_next_supervisor_resumes_a_campaign_and_queues_nothing_twice(
    service: Service, content: dict[str, Any]
) -> None:
    campaign = service.post(content)
    service.supervisor.start()
    first = service.engine(campaign)
    service.supervisor.stop()
    service.supervise().start()
    wait_until(lambda: service.engine_pid(campaign) != first)
    service.ask(campaign, CampaignRequest.PAUSE)
    service.until(CampaignState.PAUSED, campaign)
    assert service.queued_runs(campaign) == WAITING


def test_only_so_many_run_at_once(service: Service, content: dict[str, Any]) -> None:
    first, second = service.post(content), service.post(content)
    service.supervise(at_once=1).start()
    service.engine(first)
    assert service.record(second).state is QUEUED
    service.ask(first, CampaignRequest.CANCEL)
    service.until(CampaignState.CANCELLED, first)
    service.until(RUNNING, second)


def test_campaigns_of_commands_are_left_alone(service: Service, content: dict[str, Any]) -> None:
    valid = read_campaign(content, service.catalogues)
    with service.database.write() as transaction:
        embedded = transaction.campaigns.create(new_campaign(valid)).id
    held, free = service.post(content), service.post(content)
    lock = service.database.locks.hold(LongWork.campaign(held))
    try:
        service.supervisor.start()
        service.until(RUNNING, free)
        assert service.record(held).state is QUEUED
        assert service.record(embedded).state is QUEUED
    finally:
        lock.release()
    service.until(RUNNING, held)


def test_requests_during_a_downtime_are_followed(service: Service, content: dict[str, Any]) -> None:
    campaign = service.post(content)
    with service.database.write() as transaction:
        transaction.campaigns.begin(campaign)
        transaction.campaigns.ask_for(campaign, CampaignRequest.PAUSE)
    service.supervisor.start()
    service.until(CampaignState.PAUSED, campaign)
    assert not (service.setup.log(campaign)).exists()


def test_a_campaign_that_was_paused_while_its_engine_started_does_not_run(
    service: Service, content: dict[str, Any]
) -> None:
    campaign = service.post(content)
    service.supervisor.start()
    wait_until(lambda: service.setup.log(campaign).exists())
    service.ask(campaign, CampaignRequest.PAUSE)
    service.until(CampaignState.PAUSED, campaign)
    service.supervisor.stop()
    assert service.record(campaign).state is CampaignState.PAUSED


@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGTERM])
def test_an_engine_that_is_killed_is_started_again(
    service: Service, content: dict[str, Any], by: signal.Signals
) -> None:
    campaign = service.post(content)
    service.supervisor.start()
    first = service.engine(campaign)
    # Batch systems and users send SIGTERM to all processes of a service that is to end.
    os.kill(first, by)
    wait_until(lambda: service.engine_pid(campaign) != first)
    assert service.record(campaign).state is RUNNING
    assert service.supervisor.fault == ""


def test_a_campaign_whose_engine_always_dies_has_failed(
    service: Service,
    content: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    site = tmp_path / "site"
    info = site / "dying_tester-1.0.dist-info"
    info.mkdir(parents=True)
    (site / "dying_tester.py").write_text(DYING)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: dying-tester\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[drivora_service.testers]\ndying = dying_tester:DYING\n"
    )
    # Engines get the path of the process that starts them.
    monkeypatch.syspath_prepend(site)
    assert "dying" in TesterCatalogue().names()
    campaign = service.post(content, tester="dying")
    service.supervisor.start()
    failed = service.until(CampaignState.FAILED, campaign)
    assert "died 4 times after 0 evaluations, the last time of exit code 7" in failed.message
    assert failed.message.endswith("about to die")
    assert service.setup.log(campaign).read_text().count("about to die") == 4


def test_the_message_of_an_engine_is_kept(service: Service, content: dict[str, Any]) -> None:
    campaign = service.post(content)
    with service.database.write() as transaction:
        transaction.session.connection().exec_driver_sql(
            "UPDATE campaigns SET network_sha256 = 'other'"
        )
    service.supervisor.start()
    failed = service.until(CampaignState.FAILED, campaign)
    assert "has changed since campaign" in failed.message


def test_a_damage_that_an_engine_finds_ends_all_engines_and_blames_no_campaign(
    service: Service, content: dict[str, Any]
) -> None:
    healthy = service.post(content)
    service.supervisor.start()
    pid = service.engine(healthy)
    file = service.database.file
    assert file is not None
    overwrite_page(file, "runs")
    unlucky = service.post(content)
    service.supervisor.wake()
    wait_until(lambda: bool(service.database.damage.found))
    wait_until(lambda: not psutil.pid_exists(pid))
    assert "the database is damaged" in service.database.damage.found
    states = {service.record(one).state for one in (healthy, unlucky)}
    assert states <= {RUNNING, QUEUED}
