"""Engines whose testers take too much, or never come back, end in bounded time."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import psutil
import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.hosts.engine_limits import EngineLimits, read_board
from drivora_service.campaigns.hosts.engine_process import EngineSetup
from drivora_service.campaigns.search.tester_calls import TesterCall
from drivora_service.store.campaigns.campaign_records import CampaignRequest, CampaignState
from drivora_service.store.database import Database
from tests.campaigns.hosts.engine_service import Service, wait_until
from tests.campaigns.hosts.hostile_testers import install_hostile_testers

pytestmark = pytest.mark.slow

CANCELLED, FAILED = CampaignState.CANCELLED, CampaignState.FAILED


@pytest.fixture
def service(
    database: Database, catalogues: Catalogues, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Service]:
    install_hostile_testers(tmp_path / "site", monkeypatch)
    limits = EngineLimits(memory_bytes=512 << 20, call_s=2.0, grace_s=0.3, end_s=0.7)
    made = Service(database, catalogues, tmp_path, limits)
    yield made
    made.supervisor.stop()


def test_a_tester_that_takes_too_much_ends_its_campaign_and_no_other(
    service: Service, content: dict[str, Any]
) -> None:
    names = ("grow", "reserve", "map-pages", "sleep")
    hungry = {name: service.post(content, tester=name) for name in names}
    other = service.post(content)
    service.supervise(at_once=5).start()
    engine = service.engine(other)
    messages = {name: service.until(FAILED, one).message for name, one in hungry.items()}
    for name in ("grow", "reserve"):
        assert messages[name] == (
            "its tester ran out of memory when it was asked; 512 MiB are allowed for a campaign's "
            "process. Choose smaller parameters, or raise DRIVORA_CAMPAIGN_MEMORY_MB and resume "
            "the campaign"
        )
    assert "MiB, when its tester was asked; 512 MiB are allowed." in messages["map-pages"]
    assert messages["sleep"] == (
        "its tester has not come back since it was asked; 2 s are allowed for a call. Choose "
        "other parameters, or raise DRIVORA_TESTER_DEADLINE_S and resume the campaign"
    )
    assert psutil.pid_exists(engine)
    assert service.engine_pid(other) == engine
    assert service.record(other).state is CampaignState.RUNNING
    assert service.supervisor.fault == ""


def test_a_request_is_followed_although_the_tester_never_comes_back(
    service: Service, content: dict[str, Any]
) -> None:
    service.setup = _patient(service)
    cancelled = {name: service.post(content, tester=name) for name in ("loop", "ignore", "match")}
    paused = service.post(content, tester="sleep")
    service.supervise().start()
    everyone = [*cancelled.values(), paused]
    for one in everyone:
        wait_until(partial(_is_asked, service, one))
    engines = [psutil.Process(service.engine_pid(one)) for one in everyone]
    begun = time.monotonic()
    for one in cancelled.values():
        service.ask(one, CampaignRequest.CANCEL)
    service.ask(paused, CampaignRequest.PAUSE)
    for one in cancelled.values():
        assert service.until(CANCELLED, one).message == ""
    service.until(CampaignState.PAUSED, paused)
    assert time.monotonic() - begun < 20.0
    wait_until(lambda: not any(engine.is_running() for engine in engines))
    log = service.setup.log(cancelled["loop"]).read_text()
    assert log.endswith("its process was asked to end (SIGTERM)\n")


def test_the_service_ends_although_a_tester_never_comes_back(
    service: Service, content: dict[str, Any]
) -> None:
    service.setup = _patient(service)
    campaign = service.post(content, tester="ignore")
    service.supervise().start()
    wait_until(partial(_is_asked, service, campaign))
    engine = psutil.Process(service.engine_pid(campaign))
    begun = time.monotonic()
    service.supervisor.stop()
    assert time.monotonic() - begun < 10.0
    assert not engine.is_running()
    assert service.record(campaign).state is CampaignState.RUNNING


def _is_asked(service: Service, campaign_id: str) -> bool:
    return read_board(service.setup.board(campaign_id))[1] is TesterCall.ASK


def _patient(service: Service) -> EngineSetup:
    """Returns the setup with time enough for all calls, so that only requests end engines."""
    limits = replace(service.setup.limits, call_s=600.0)
    return replace(service.setup, limits=limits)
