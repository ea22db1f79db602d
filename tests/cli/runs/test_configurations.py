"""Runs of one ADS and of its slowed version: named apart, filtered, exported."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pandas as pd

from tests.cli.conftest import Drivora

SLOWED = "idm · reaction_time 1.0"


def test_an_agent_and_its_slowed_version_are_two(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    def run(*options: str) -> dict[str, Any]:
        return dict(drivora("run", scenario_file, "--agent", "idm", "--json", *options).json())

    plain = run()
    slowed = run("--agent-parameter", "reaction_time=1.0")
    written = run("--agent-parameter", "reaction_time=0.0")
    assert [one["agent"] for one in (plain, slowed, written)] == ["idm"] * 3
    assert [one["configuration"] for one in (plain, slowed, written)] == ["idm", SLOWED, "idm"]
    assert plain["configuration_id"] == written["configuration_id"] != slowed["configuration_id"]

    shown = drivora("runs", "list").out
    assert " ".join(shown.split()).count("reaction_time 1.0") == 1, shown
    only = drivora("runs", "list", "--configuration", slowed["configuration_id"], "--json").json()
    assert [one["id"] for one in only] == [slowed["id"]]
    same = drivora("runs", "list", "--configuration", plain["configuration_id"], "--json").json()
    assert {one["id"] for one in same} == {plain["id"], written["id"]}
    long = drivora("runs", "show", slowed["id"]).out
    assert f"Configuration {slowed['configuration_id']}: {SLOWED}" in long

    (replayed,) = drivora("replay", slowed["id"], "--json").json()["runs"]
    assert replayed["run"]["configuration"] == SLOWED
    assert replayed["replay"]["configuration_id"] == slowed["configuration_id"]

    out = tmp_path / "out"
    assert drivora("export", "--out", out).code == 0
    assert (
        drivora(
            "export", "--out", tmp_path / "only", "--configuration", slowed["configuration_id"]
        ).code
        == 0
    )
    exported = pd.read_parquet(out / "runs.parquet").set_index("run_id")
    assert exported.loc[plain["id"], "configuration"] == "idm"
    assert exported.loc[slowed["id"], "configuration"] == SLOWED
    assert exported.loc[slowed["id"], "configuration_id"] == slowed["configuration_id"]
    with (tmp_path / "only" / "runs.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["configuration"] for row in rows} == {SLOWED}
    unknown = drivora("export", "--out", tmp_path / "none", "--configuration", "0" * 8)
    assert unknown.code == 2
    assert slowed["configuration_id"] in unknown.err
