"""``drivora export``: campaigns and studies of commands and of a service, and runs of both."""

from __future__ import annotations

import copy
import csv
import json
import sqlite3
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import httpx
import pandas as pd
import pytest

from drivora_service.api.documentation.recorded_examples import CAMPAIGN
from tests.cli.conftest import Drivora
from tests.cli.studies.test_study_commands import STUDY

NAMES = ("runs", "verdicts", "metrics", "agents")


def campaign_file(tmp_path: Path, **changes: Any) -> Path:
    content = {
        **copy.deepcopy(CAMPAIGN),
        "name": "braking",
        "tester": {"name": "random"},
        "space": {"vehicles": 2, "walkers": 1},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": 8},
        **changes,
    }
    path = tmp_path / "campaign.json"
    path.write_text(json.dumps(content))
    return path


def tables(folder: Path) -> dict[str, pd.DataFrame]:
    """The tables, whose CSV files have the same rows."""
    found = {}
    for name in NAMES:
        found[name] = pd.read_parquet(folder / f"{name}.parquet")
        with (folder / f"{name}.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        assert [row["run_id"] for row in rows] == found[name]["run_id"].tolist()
    return found


def in_database(data: Path, query: str) -> list[Any]:
    with closing(sqlite3.connect(data / "drivora.sqlite3")) as connection:
        return connection.execute(query).fetchall()


@pytest.mark.slow(seconds=30)
def test_runs_campaigns_and_studies_of_commands(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    assert drivora("run", scenario_file, "--agent", "idm-mobil").code == 0
    campaign = drivora("campaign", "run", campaign_file(tmp_path), "--json").json()
    (tmp_path / "seeds").mkdir()
    (tmp_path / "seeds" / "one.json").write_text(scenario_file.read_text())
    (tmp_path / "study.yaml").write_text(STUDY.replace("simulations: 10", "simulations: 2"))
    study = drivora("study", "run", tmp_path / "study.yaml", "--json").json()
    data, out = tmp_path / "data", tmp_path / "out"

    exported = drivora("export", "--out", out)
    assert exported.code == 0, exported.err
    assert exported.out.splitlines() == [
        str(out / f"{name}.{form}") for name in NAMES for form in ("parquet", "csv")
    ]
    found = tables(out)
    runs = found["runs"]
    evaluations = in_database(
        data,
        "SELECT c.id || '-' || number, violations, report FROM evaluations e"
        " JOIN campaigns c ON c.seq = e.campaign_seq ORDER BY e.campaign_seq, number",
    )
    ((run_id,),) = in_database(data, "SELECT id FROM runs")
    assert runs["run_id"].tolist() == [run_id, *(row[0] for row in evaluations)]
    assert runs["source"].tolist() == ["run", *["evaluation"] * len(evaluations)]
    assert len(evaluations) >= 8 + 8
    # The collisions of campaigns count as failures there; those of the reports are in the tables.
    reports = {row[0]: json.loads(row[2]) for row in evaluations}
    for one, verdicts in found["verdicts"].groupby("run_id", sort=False):
        if one != run_id:
            assert verdicts["oracle"].tolist() == [v["oracle"] for v in reports[one]["verdicts"]]
            assert verdicts["outcome"].tolist() == [v["outcome"] for v in reports[one]["verdicts"]]
    assert set(found["metrics"]["kind"]) == {"metric", "score", "objective"}

    wanted = {
        ("--campaign", campaign["id"]): {"campaign_id": campaign["id"]},
        ("--campaign", "braking"): {"campaign_id": campaign["id"]},
        ("--study", study["id"]): {"study_id": study["id"]},
        ("--agent", "idm-mobil"): {"agent": "idm-mobil"},
    }
    for number, (options, kept) in enumerate(wanted.items()):
        folder = tmp_path / str(number)
        assert drivora("export", "--out", folder, *options).code == 0
        ((column, value),) = kept.items()
        expected = runs.loc[runs[column] == value, "run_id"].tolist()
        assert expected
        for table in tables(folder).values():
            assert set(table["run_id"]) <= set(expected)
        assert tables(folder)["runs"]["run_id"].tolist() == expected

    assert drivora("export", "--out", tmp_path / "csv", "--format", "csv").code == 0
    assert sorted(path.name for path in (tmp_path / "csv").iterdir()) == sorted(
        f"{name}.csv" for name in NAMES
    )
    for name in NAMES:
        # Those that the service wrote, and those that were written of its Parquet files.
        assert (tmp_path / "csv" / f"{name}.csv").read_text() == (out / f"{name}.csv").read_text()


@pytest.mark.slow(seconds=30)
def test_a_campaign_of_a_service(drivora: Drivora, tmp_path: Path, service_url: str) -> None:
    """The same campaign as a command and on a service: the tables differ in nothing that counts."""
    file = campaign_file(tmp_path, name=f"exported {time.time_ns()}")
    content = json.loads(file.read_text())
    server = ("--server", service_url)
    there = drivora("campaign", "run", file, "--json", *server)
    assert there.code == 0, there.err
    assert drivora("campaign", "run", file).code == 0
    folders = {"there": server, "here": ()}
    for name, options in folders.items():
        ended = drivora("export", "--out", tmp_path / name, "--campaign", content["name"], *options)
        assert ended.code == 0, ended.err
    here, served = tables(tmp_path / "here"), tables(tmp_path / "there")
    assert set(served["runs"]["source"]) == {"run"}
    assert set(here["runs"]["source"]) == {"evaluation"}
    # A service also has the run of the seed scenario, which is no evaluation.
    is_evaluated = served["runs"]["evaluation"].notna()
    assert (~is_evaluated).sum() == 1
    simulated = served["runs"][~served["runs"]["confirms"] & is_evaluated]
    same = [
        *("evaluation", "status", "cause", "town", "agent", "seed", "scenario_sha256"),
        *("violations", "at_fault_violations", "observations", "accountability", "steps"),
        *("sim_time_s", "trace_sha256", "drivora_version", "sumo_version"),
    ]
    # With the missing number of the seed's run, pandas reads the column as floats.
    pd.testing.assert_frame_equal(
        simulated[same].reset_index(drop=True),
        here["runs"][same].reset_index(drop=True),
        check_dtype=False,
    )
    for name in ("verdicts", "metrics"):
        of_evaluations = served[name][served[name]["run_id"].isin(simulated["run_id"])]
        pd.testing.assert_frame_equal(
            of_evaluations.drop(columns="run_id").reset_index(drop=True),
            here[name].drop(columns="run_id").reset_index(drop=True),
        )
    repeated = served["runs"][served["runs"]["confirms"]]
    failing = httpx.get(
        f"{service_url}/api/v1/campaigns/{there.json()['id']}/failures?limit=500"
    ).json()["items"]
    assert set(repeated["evaluation"]) == {one["evaluation"] for one in failing}


def test_what_does_not_exist_is_wrong_use(drivora: Drivora, tmp_path: Path) -> None:
    refused = drivora("export", "--out", tmp_path / "out")
    assert refused.code == 2
    assert "no data is stored" in refused.err
    drivora("store", "migrate")
    for kind in ("batch", "campaign", "study", "agent"):
        refused = drivora("export", "--out", tmp_path / "out", f"--{kind}", "0123")
        assert refused.code == 2
        assert f"unknown {kind} '0123'" in refused.err
        assert list((tmp_path / "out").iterdir()) == []
    refused = drivora("export", "--out", tmp_path / "out", "--format", "xlsx")
    assert refused.code == 2
    assert "'xlsx' is not one of" in refused.err
    (tmp_path / "file").write_text("")
    assert drivora("export", "--out", tmp_path / "file").code == 2


def test_an_empty_store_has_empty_tables(drivora: Drivora, tmp_path: Path) -> None:
    drivora("store", "migrate")
    assert drivora("export", "--out", tmp_path / "out", "--agent", "idm").code == 0
    for table in tables(tmp_path / "out").values():
        assert len(table) == 0
        assert "run_id" in table.columns
