"""``drivora campaign run --start-from`` and ``start_from`` in files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Drivora

CAMPAIGN = """
name: {name}
tester: {tester}
agent: {{name: idm}}
scenario: {{file: crossing.json}}
space: {{vehicles: {vehicles}, walkers: 1}}
counts: any
oracles: [collision, discomfort]
budget: {{simulations: 14}}
seed: {seed}
workers: 2
"""


def write(
    folder: Path, name: str, tester: str = "{name: random}", *, vehicles: int = 2, seed: int = 3
) -> Path:
    path = folder / f"{name}.yaml"
    path.write_text(CAMPAIGN.format(name=name, tester=tester, vehicles=vehicles, seed=seed))
    return path


def values(drivora: Drivora, campaign: str, number: int) -> list[float]:
    shown = drivora("campaign", "show", campaign, "--evaluation", number, "--json").json()
    assert isinstance(shown["values"], list)
    return shown["values"]


@pytest.mark.slow(seconds=25)
def test_the_failures_and_elites_of_a_campaign_are_the_first_candidates_of_another(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    ended = drivora("campaign", "run", write(tmp_path, "first"), "--out", "kept", "--json")
    assert ended.code == 0, ended.err
    first = ended.json()
    failing = list(dict.fromkeys(one["evaluation"] for one in first["failures"]))
    assert len(failing) > 1, "otherwise this test shows nothing"
    fuzzer = write(tmp_path, "second", "{name: avfuzzer}", seed=4)
    options = ("--start-from", "first", "--start-most", "2")
    second = drivora("campaign", "run", fuzzer, *options, "--json").json()
    assert second["document"]["tester"]["start_from"]["source"].startswith("campaign ")
    started = [values(drivora, second["id"], number) for number in (0, 1)]
    assert started[0] == values(drivora, first["id"], failing[0])
    assert started == [one["values"] for one in _exported(tmp_path)][:2]
    again = drivora("campaign", "show", second["id"], "--evaluation", 0, "--json").json()
    assert again["origin"] == "start"
    # The same run as in the first campaign: it fails again.
    assert {0, 1} <= {one["evaluation"] for one in second["failures"]}
    assert "Started from 2 failures" in drivora("campaign", "show", second["id"]).out

    # From the folder, in the file, without a scenario that was taken out.
    (tmp_path / "kept" / f"{_exported(tmp_path)[0]['evaluation']:06d}.json").unlink()
    third = write(tmp_path, "third", "{name: random, start_from: {folder: kept, most: 1}}")
    ended = drivora("campaign", "run", third, "--json")
    assert "note: the search starts from 1 failure" in ended.err
    assert values(drivora, ended.json()["id"], 0) == _exported(tmp_path)[1]["values"]

    elites = ("--start-from", first["id"], "--start-with", "elites", "--start-most", "3")
    fourth = drivora("campaign", "run", fuzzer, *elites, "--json").json()
    best = first["best"]["min_gap"]["evaluation"]
    started = [values(drivora, fourth["id"], number) for number in range(3)]
    assert values(drivora, first["id"], best) in started


def _exported(folder: Path) -> list[dict[str, Any]]:
    told = json.loads((folder / "kept" / "campaign.json").read_text())
    listed = told["candidates"]
    assert isinstance(listed, list)
    return listed


def test_what_cannot_be_started_from_is_refused_with_what_differs(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    first = write(tmp_path, "first")
    kept = drivora("campaign", "run", first, "--out", "kept", "--json").json()

    def refusal(file: Path, *options: str) -> str:
        ended = drivora("campaign", "run", file, *options)
        assert ended.code == 2, ended.err
        return ended.err

    other = write(tmp_path, "other", vehicles=3)
    assert "/space/vehicles 2 there, 3 here" in refusal(other, "--start-from", kept["id"])
    assert "/space/vehicles 2 there, 3 here" in refusal(other, "--start-from", "kept")
    assert "unknown campaign 'none'" in refusal(first, "--start-from", "none")
    (tmp_path / "empty").mkdir()
    assert "holds no campaign.json" in refusal(first, "--start-from", "empty")
    from_kept = ("--start-from", "kept", "--start-with", "elites")
    assert "failures of a campaign only" in refusal(first, *from_kept)
    assert "needs --start-from" in refusal(first, "--start-most", "2")
    assert "known: failures, elites" in refusal(first, "--start-from", "kept", "--start-with", "x")
    odd = write(tmp_path, "odd", "{name: random, start_from: {campaign: first, withh: elites}}")
    assert "/tester/start_from/withh: found a key that is not known" in refusal(odd)
    scenario = json.loads(scenario_file.read_text())
    scenario["ego_vehicles"][0]["route"][0]["x"] += 0.5
    scenario_file.write_text(json.dumps(scenario))
    assert "another seed scenario" in refusal(first, "--start-from", "kept")
