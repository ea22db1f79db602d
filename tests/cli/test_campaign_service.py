"""``drivora campaign --server``."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from tests.cli.conftest import Drivora

CAMPAIGN = """
name: crossing of a service
tester:
  name: avfuzzer
agent:
  name: idm
scenario:
  file: crossing.json
space:
  vehicles: 2
  walkers: 2
oracles: [collision, discomfort]
budget:
  simulations: 12
seed: 3
"""


@pytest.fixture
def campaign_file(tmp_path: Path) -> Path:
    (tmp_path / "crossing.json").write_text(json.dumps(SCENARIO))
    path = tmp_path / "campaign.yaml"
    path.write_text(CAMPAIGN)
    return path


CIRCUMSTANCES = {
    *("id", "batch_id", "run_id", "trace", "rate", "left_s", "active_s", "created_at"),
    *("started_at", "ended_at", "updated_at", "told_at", "search_s", "prepare_s", "wall_time_s"),
    *("step_cost_us", "agent_cost_us", "run_url", "runs_url", "scenario_url", "failures_url"),
    *("observations_url", "evaluations_url", "revision"),
}


def without_circumstances(value: Any) -> Any:
    """Leaves out what is of one campaign and its times."""
    if isinstance(value, dict):
        return {k: without_circumstances(v) for k, v in value.items() if k not in CIRCUMSTANCES}
    return [without_circumstances(one) for one in value] if isinstance(value, list) else value


def test_every_problem_is_named_as_without_a_service(
    drivora: Drivora, campaign_file: Path, service_url: str
) -> None:
    campaign_file.write_text(CAMPAIGN.replace("name: avfuzzer", "name: avfuzer"))
    there = drivora("campaign", "run", campaign_file, "--server", service_url)
    here = drivora("campaign", "run", campaign_file)
    assert there.code == here.code == 2
    assert "/tester/name: " in there.err
    assert there.err == here.err


def test_what_is_not_there_or_makes_no_sense(
    drivora: Drivora, campaign_file: Path, service_url: str
) -> None:
    server = ("--server", service_url)
    for command in ("show", "pause", "cancel", "resume", "report"):
        ended = drivora("campaign", command, "0123", *server)
        assert ended.code == 2
        assert "unknown campaign '0123'" in ended.err
    for option in (("--workers", "1"), ("--evaluator", "local")):
        ended = drivora("campaign", "run", campaign_file, *server, *option)
        assert ended.code == 2
        assert "its own workers" in ended.err


@pytest.mark.slow
def test_a_service_finds_what_a_command_finds(
    drivora: Drivora, campaign_file: Path, tmp_path: Path, service_url: str
) -> None:
    server = ("--server", service_url)
    out = tmp_path / "out"
    ended = drivora("campaign", "run", campaign_file, *server, "--out", out, "--gate", "--json")
    assert ended.code == 1, ended.err
    there = ended.json()
    here = drivora("campaign", "run", campaign_file, "--workers", "1", "--json").json()
    assert without_circumstances(there) == without_circumstances(here)
    assert there["failures"]
    number = there["failures"][0]["evaluation"]
    mine = drivora("campaign", "show", here["id"], "--evaluation", number, "--json").json()
    theirs = drivora(
        "campaign", "show", there["id"], "--evaluation", number, "--json", *server
    ).json()
    assert without_circumstances(theirs) == without_circumstances(mine)
    assert mine["objectives"]

    trace = read_trace(out / f"{number:06d}.trace.parquet")
    assert trace_sha256(trace) == mine["trace_sha256"]
    printed = drivora("campaign", "scenario", there["id"], number, *server)
    assert printed.out == (out / f"{number:06d}.json").read_text()
    assert printed.out == drivora("campaign", "scenario", here["id"], number).out
    listed = drivora("campaign", "list", "--json", *server).json()
    assert there["id"] in {campaign["id"] for campaign in listed}
    assert "Failures" in drivora("campaign", "show", there["id"], *server).out
    assert "Lineage" in drivora("campaign", "show", there["id"], "--evaluation", 3, *server).out
    assert drivora("campaign", "resume", there["id"], *server).code == 3


@pytest.mark.slow
def test_a_campaign_is_left_alone_paused_resumed_and_given_up(
    drivora: Drivora, campaign_file: Path, tmp_path: Path, service_url: str
) -> None:
    server = ("--server", service_url)
    campaign_file.write_text(CAMPAIGN.replace("simulations: 12", "simulations: 5000"))
    campaign = drivora("campaign", "run", campaign_file, *server, "--detach", "--json").json()
    assert campaign["state"] in ("queued", "running")

    def state_becomes(*wanted: str) -> None:
        deadline = time.monotonic() + 120.0
        while True:
            with httpx.Client(base_url=f"{service_url}/api/v1") as client:
                state = client.get(f"/campaigns/{campaign['id']}").json()["state"]
            if state in wanted:
                return
            assert time.monotonic() < deadline
            time.sleep(0.1)

    assert drivora("campaign", "pause", campaign["id"], *server).code == 0
    state_becomes("paused")
    command = [sys.executable, "-m", "drivora_service.cli", "campaign", "resume", campaign["id"]]
    watching = subprocess.Popen(
        [*command, *server], cwd=tmp_path, env=os.environ, stderr=subprocess.PIPE, text=True
    )
    state_becomes("running")
    watching.send_signal(signal.SIGINT)
    _, said = watching.communicate(timeout=240.0)
    assert "the service continues it" in said
    assert watching.returncode == 130
    state_becomes("running")
    cancelled = drivora("campaign", "cancel", campaign["id"], *server, "--json").json()
    assert cancelled["state"] in ("running", "cancelled")
    state_becomes("cancelled")
    assert drivora("campaign", "pause", campaign["id"], *server).code == 3
