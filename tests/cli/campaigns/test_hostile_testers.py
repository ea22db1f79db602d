"""A command ends when it is interrupted, although the tester of its campaign never returns."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

import pytest

from tests.campaigns.hosts.hostile_testers import install_hostile_testers
from tests.cli.conftest import Drivora
from tests.command_process import Begun, begin

pytestmark = pytest.mark.slow

CAMPAIGN = """
name: crossing
tester: {name: NAME}
scenario: {file: crossing.json}
space: {vehicles: 1, walkers: 0}
budget: {simulations: 12}
"""


@pytest.fixture
def campaign(tmp_path: Path, scenario_file: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    assert scenario_file.name == "crossing.json"
    site = tmp_path / "site"
    install_hostile_testers(site, monkeypatch)
    # What the command is started with, too.
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(site), os.environ.get("PYTHONPATH", "")]))
    return tmp_path / "campaign.yaml"


STUDY = """
name: crossings
methods: [{name: later}, {name: ignore}]
scenarios: [{file: crossing.json}]
space: {vehicles: 1, walkers: 0}
budget: {simulations: 12}
"""


@pytest.mark.parametrize(("tester", "found"), [("later", 1), ("sleep", 0)])
def test_an_interrupt_pauses_a_campaign_whose_tester_never_returns(
    campaign: Path, tester: str, found: int, drivora: Drivora
) -> None:
    campaign.write_text(CAMPAIGN.replace("NAME", tester))
    process, log = begin_to_run(campaign, "campaign")
    (one,) = wait_for_running(drivora, 1, found)
    process.send_signal(signal.SIGINT)
    assert process.wait(60.0) == 130
    said = log.read_text()
    assert "interrupted: the campaign is paused" in said
    assert "Traceback" not in said
    shown = drivora("campaign", "show", one["id"], "--json").json()
    assert shown["state"] == "paused"
    assert shown["counts"]["evaluations"] == found


def test_an_interrupt_pauses_a_study_whose_testers_never_return(
    campaign: Path, drivora: Drivora
) -> None:
    campaign.write_text(STUDY)
    process, log = begin_to_run(campaign, "study")
    wait_for_running(drivora, 2, 1)
    process.send_signal(signal.SIGINT)
    assert process.wait(60.0) == 130
    said = log.read_text()
    assert "interrupted: the study is paused and its 1 simulations are kept" in said
    assert "Traceback" not in said
    listed = drivora("campaign", "list", "--json").json()
    assert [one["state"] for one in listed] == ["paused", "paused"]


def begin_to_run(file: Path, what: str) -> tuple[Begun, Path]:
    log = file.with_name("run.log")
    begun = begin(
        what,
        "run",
        file.name,
        "--workers",
        "1",
        folder=file.parent,
        environment={**os.environ, "DRIVORA_DATA_DIR": str(file.parent / "data")},
        out=log,
        err=log,
    )
    return begun, log


def wait_for_running(drivora: Drivora, campaigns: int, found: int) -> list[dict[str, Any]]:
    """Waits until so many campaigns run, and have so many evaluations together."""
    deadline = time.monotonic() + 120.0
    while True:
        listed = drivora("campaign", "list", "--json")
        items: list[dict[str, Any]] = listed.json() if listed.code == 0 else []
        running = [one for one in items if one["state"] == "running"]
        told = sum(one["counts"]["evaluations"] for one in running)
        if len(running) == campaigns and told >= found:
            return running
        assert time.monotonic() < deadline
        time.sleep(0.2)


def test_a_tester_that_takes_all_memory_ends_its_campaign_and_not_the_command(
    campaign: Path, drivora: Drivora
) -> None:
    campaign.write_text(CAMPAIGN.replace("NAME", "reserve"))
    ended = drivora("campaign", "run", campaign.name, "--workers", "1")
    assert ended.code == 3
    assert "its tester ran out of memory when it was asked; 4096 MiB are allowed" in ended.out
    assert "failed; resume it with: drivora campaign resume" in ended.err
    assert "Traceback" not in ended.err
