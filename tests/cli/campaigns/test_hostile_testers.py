"""A command ends when it is interrupted, although the tester of its campaign never returns."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest

from tests.campaigns.hosts.hostile_testers import install_hostile_testers
from tests.cli.conftest import Drivora
from tests.command_process import begin

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


@pytest.mark.parametrize(("tester", "found"), [("later", 1), ("sleep", 0)])
def test_an_interrupt_pauses_a_campaign_whose_tester_never_returns(
    campaign: Path, tester: str, found: int, drivora: Drivora
) -> None:
    campaign.write_text(CAMPAIGN.replace("NAME", tester))
    log = campaign.with_name("campaign.log")
    process = begin(
        "campaign",
        "run",
        campaign.name,
        "--workers",
        "1",
        folder=campaign.parent,
        environment={**os.environ, "DRIVORA_DATA_DIR": str(campaign.parent / "data")},
        out=log,
        err=log,
    )
    deadline = time.monotonic() + 120.0
    while True:
        listed = drivora("campaign", "list", "--json")
        if listed.code == 0 and (items := listed.json()):
            one = items[0]
            if one["state"] == "running" and one["counts"]["evaluations"] >= found:
                break
        assert time.monotonic() < deadline
        time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    assert process.wait(60.0) == 130
    said = log.read_text()
    assert "interrupted: the campaign is paused" in said
    assert "Traceback" not in said
    shown = drivora("campaign", "show", one["id"], "--json").json()
    assert shown["state"] == "paused"
    assert shown["counts"]["evaluations"] == found


def test_a_tester_that_takes_all_memory_ends_its_campaign_and_not_the_command(
    campaign: Path, drivora: Drivora
) -> None:
    campaign.write_text(CAMPAIGN.replace("NAME", "reserve"))
    ended = drivora("campaign", "run", campaign.name, "--workers", "1")
    assert ended.code == 3
    assert "its tester ran out of memory when it was asked; 4096 MiB are allowed" in ended.out
    assert "failed; resume it with: drivora campaign resume" in ended.err
    assert "Traceback" not in ended.err
