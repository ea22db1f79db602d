"""``drivora replay`` of runs on a real service, and of all failures of campaigns."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli.conftest import Drivora, install_agents
from tests.cli.runs.test_replay_command import assert_as_pandas_finds_it
from tests.forked_service import forked_service

SEARCHES = (("random", "sumo-krauss"), ("avfuzzer", "idm"))
"""Methods, and the agents whose failures they look for."""
LEAST_FAILURES = 10
CAMPAIGN: dict[str, Any] = {
    "scenario": {**SCENARIO, "max_sim_time": 20.0, "background_traffic": {"count": 5}},
    "space": {"vehicles": 4, "walkers": 2},
    "oracles": ["collision", "discomfort", "near_miss", "speeding", "lane_keeping"],
    "budget": {"simulations": 10},
    "seed": 3,
}


def campaign_file(folder: Path, method: str, agent: str) -> Path:
    path = folder / f"{method}-{agent}.json"
    path.write_text(
        json.dumps(
            {
                **CAMPAIGN,
                "name": f"{method} of {agent}",
                "tester": {"name": method},
                "agent": {"name": agent},
            }
        )
    )
    return path


def test_a_service_replays_its_runs(
    drivora: Drivora, scenario_file: Path, service_url: str, tmp_path: Path
) -> None:
    server = ("--server", service_url)
    ended = drivora("run", scenario_file, "--seed", "5", "--agent", "sumo-idm", *server, "--json")
    run = ended.json()
    assert run["status"] == "finished"
    replayed = drivora("replay", run["id"], *server, "--out", tmp_path / "out", "--json")
    assert replayed.code == 0, replayed.err
    (replay,) = replayed.json()["runs"]
    assert replay["outcome"] == "identical"
    assert replay["frames_compared"]
    assert replay["replay"]["trace_sha256"] == run["trace_sha256"]
    assert [*(tmp_path / "out").iterdir()] == []
    again = drivora("runs", "show", replay["replay"]["id"], *server, "--json").json()
    assert again["label"] == f"replay of {run['id']}"
    assert again["seed"] == 5
    assert not (tmp_path / "data").exists()
    assert drivora("replay", "0123456789abcdef01234567", *server).code == 2
    both = drivora("replay", run["id"], *server, "--workers", "1")
    assert both.code == 2


@pytest.mark.slow
def test_a_service_finds_the_first_draw_of_an_agent_without_a_seed(
    drivora: Drivora, scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_agents(tmp_path / "site", version="1.0")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "site"), prepend=":")
    with forked_service(tmp_path / "service", workers=1) as url:
        run = drivora("run", scenario_file, "--agent", "dicing", "--server", url, "--json").json()
        out = tmp_path / "out"
        ended = drivora("replay", run["id"], "--server", url, "--out", out, "--json")
    assert ended.code == 1, ended.err
    (replay,) = ended.json()["runs"]
    told = replay["divergence"]
    assert (told["step"], told["actor"], told["signal"]) == (20, "ego", "ego_acceleration")
    assert_as_pandas_finds_it(replay, out)


@pytest.mark.slow(seconds=40)
def test_all_failures_of_two_methods_and_two_agents_replay_bit_for_bit(
    drivora: Drivora, tmp_path: Path
) -> None:
    data = tmp_path / "data"
    failing = 0
    for method, agent in SEARCHES:
        ran = drivora(
            *("campaign", "run", campaign_file(tmp_path, method, agent)),
            *("--workers", "2", "--json"),
        )
        assert ran.code == 0, ran.err
        campaign = ran.json()
        numbers = sorted({failure["evaluation"] for failure in campaign["failures"]})
        ended = drivora("replay", "--campaign", campaign["id"], "--workers", "2", "--json")
        assert ended.code == 0, ended.err
        replays = ended.json()["runs"]
        ids = [f"{campaign['id']}-{number}" for number in numbers]
        assert sorted(one["run"]["id"] for one in replays) == sorted(ids)
        for one in replays:
            assert one["outcome"] == "identical"
            assert one["frames_compared"]
            number = int(one["run"]["id"].rpartition("-")[2])
            traces = data / "campaigns" / campaign["id"] / "traces"
            (again,) = (data / "traces").glob(f"*/{one['replay']['id']}.parquet")
            stored = pq.read_table(traces / f"{number:06d}.trace.parquet")
            assert stored.equals(pq.read_table(again))
        failing += len(numbers)
    assert failing >= LEAST_FAILURES


@pytest.mark.slow(seconds=30)
def test_failures_of_a_campaign_of_a_service_are_replayed(
    drivora: Drivora, tmp_path: Path, service_url: str
) -> None:
    server = ("--server", service_url)
    file = campaign_file(tmp_path, "random", "idm")
    campaign = drivora("campaign", "run", file, *server, "--json").json()
    ended = drivora("replay", "--campaign", campaign["id"], *server, "--json")
    assert ended.code == 0, ended.err
    replays = ended.json()["runs"]
    assert len(replays) == len({failure["evaluation"] for failure in campaign["failures"]}) > 3
    assert {one["outcome"] for one in replays} == {"identical"}
    assert all(one["frames_compared"] for one in replays)
    # Of the evaluations that passed, only the hash is kept.
    passed = next(
        f"{campaign['id']}-{number}"
        for number in range(CAMPAIGN["budget"]["simulations"])
        if f"{campaign['id']}-{number}" not in {one["run"]["id"] for one in replays}
    )
    ended = drivora("replay", passed, *server, "--json")
    assert ended.code == 0, ended.err
    (replay,) = ended.json()["runs"]
    assert replay["outcome"] == "identical"
    assert replay["reason"] == "the hashes were compared, not the frames: the run has no recording"
