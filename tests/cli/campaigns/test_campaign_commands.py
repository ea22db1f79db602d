"""``drivora campaign``, also killed in the middle."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.store.database import Database, open_database
from drivora_service.studies.coverage.law_coverage import law_coverage
from tests.campaigns.analytic import sequence
from tests.cli.conftest import Drivora
from tests.command_process import Begun, begin

CAMPAIGN = """
name: crossing
tester:
  name: random
agent:
  name: idm
scenario:
  file: crossing.json
space:
  vehicles: 2
  walkers: 2
oracles: [collision, discomfort]
budget:
  simulations: 24
seed: 3
workers: 2
"""


@pytest.fixture
def campaign_file(tmp_path: Path) -> Path:
    (tmp_path / "crossing.json").write_text(json.dumps(SCENARIO))
    path = tmp_path / "campaign.yaml"
    path.write_text(CAMPAIGN)
    return path


def database(tmp_path: Path) -> Database:
    return open_database(f"sqlite:///{tmp_path / 'data' / 'drivora.sqlite3'}")


def evaluations(tmp_path: Path, campaign_id: str) -> list[EvaluationRecord]:
    opened = database(tmp_path)
    try:
        return list(StoreJournal(opened, campaign_id).evaluations())
    finally:
        opened.close()


def begin_campaign(tmp_path: Path, *arguments: str | Path) -> Begun:
    """Begins a command and does not wait for it."""
    log = tmp_path / "campaign.log"
    environment = {**os.environ, "DRIVORA_DATA_DIR": str(tmp_path / "data")}
    return begin("campaign", *arguments, folder=tmp_path, environment=environment, out=log, err=log)


def start(tmp_path: Path, *arguments: str | Path) -> subprocess.Popen[bytes]:
    """Does the same as a shell would, with a fork server of its own that ends with it."""
    command = [sys.executable, "-m", "drivora_service.cli", "campaign", *map(str, arguments)]
    with (tmp_path / "campaign.log").open("ab") as log:
        return subprocess.Popen(
            command,
            stdout=log,
            stderr=log,
            cwd=tmp_path,
            env={**os.environ, "DRIVORA_DATA_DIR": str(tmp_path / "data")},
        )


def wait_until_told(
    tmp_path: Path, process: subprocess.Popen[bytes] | Begun, more_than: int
) -> str:
    """Waits until the newest campaign has told more than so many evaluations; gives its id."""
    opened = database(tmp_path)
    try:
        deadline = time.monotonic() + 120.0
        while time.monotonic() < deadline and process.poll() is None:
            with opened.read() as transaction:
                for record in transaction.campaigns.page(limit=1).items:
                    if record.counts.evaluations > more_than:
                        return record.id
            time.sleep(0.02)
    finally:
        opened.close()
    raise AssertionError((tmp_path / "campaign.log").read_text())


def test_an_evaluator_that_would_not_use_the_executor_is_refused(
    drivora: Drivora, campaign_file: Path
) -> None:
    ended = drivora("campaign", "run", campaign_file, "--evaluator", "mine", "--executor", "ray")
    assert ended.code == 2
    assert "would not use the executor 'ray'" in ended.err


def test_a_bad_file_is_refused_with_every_place(drivora: Drivora, campaign_file: Path) -> None:
    wrong = CAMPAIGN.replace("name: random", "name: randon").replace("seed: 3", "sed: 3")
    campaign_file.write_text(wrong)
    drivora("store", "migrate")
    ended = drivora("campaign", "run", campaign_file)
    assert ended.code == 2
    assert "/tester/name: " in ended.err
    assert "/sed: " in ended.err
    assert drivora("campaign", "list", "--json").json() == []


@pytest.mark.parametrize(
    ("scenario", "said"),
    [
        ("{file: nowhere.json}", "/scenario/file: there is no file"),
        ("{file: 3}", "found no file name"),
        ("{file: [}", "not YAML"),
        ("{map_region: {town: tee-town}}", "/scenario/ego_vehicles"),
    ],
)
def test_a_bad_scenario_is_named(
    drivora: Drivora, campaign_file: Path, scenario: str, said: str
) -> None:
    campaign_file.write_text(CAMPAIGN.replace("\n  file: crossing.json", f" {scenario}"))
    ended = drivora("campaign", "run", campaign_file)
    assert ended.code == 2
    assert said in ended.err


def test_what_is_not_there_is_wrong_use(drivora: Drivora, tmp_path: Path) -> None:
    drivora("store", "migrate")
    assert drivora("campaign", "run", tmp_path / "none.yaml").code == 2
    for command in ("show", "resume", "pause", "cancel"):
        ended = drivora("campaign", command, "0123")
        assert ended.code == 2
        assert "unknown campaign '0123'" in ended.err


@pytest.mark.slow
def test_a_campaign_that_cannot_begin_is_stored_as_failed_and_can_be_resumed(
    drivora: Drivora, campaign_file: Path, tmp_path: Path
) -> None:
    data = tmp_path / "other data"
    data.mkdir()
    blocked = data / "campaigns"
    blocked.write_text("in the way")
    campaign_file.write_text(CAMPAIGN.replace("simulations: 24", "simulations: 1"))
    ended = drivora("campaign", "run", campaign_file, "--data-dir", data, "--json")
    assert ended.code == 3
    failed = ended.json()
    assert failed["state"] == "failed"
    assert str(blocked) in failed["message"]
    assert f"drivora campaign resume {failed['id']} --data-dir '{data}'" in ended.err
    again = drivora("campaign", "resume", failed["id"], "--data-dir", data, "--json")
    assert (again.code, again.json()["state"]) == (3, "failed")
    blocked.unlink()
    done = drivora("campaign", "resume", failed["id"], "--data-dir", data, "--json")
    assert done.code == 0, done.err
    assert done.json()["state"] == "finished"


@pytest.mark.slow
def test_a_campaign_from_its_file_to_its_failures(
    drivora: Drivora, campaign_file: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    refused = drivora("campaign", "run", campaign_file, "--gate-oracle", "near_miss")
    assert refused.code == 2
    assert "the campaign has no oracle 'near_miss'; known: collision, discomfort" in refused.err
    ended = drivora("campaign", "run", campaign_file, "--out", out, "--gate", "--json")
    result = ended.json()
    assert ended.code == (1 if result["counts"]["violating"] else 0)
    assert result["state"] == "finished"
    assert result["simulations"] == result["budget"] == 24
    assert result["counts"]["violating"] > 0
    assert sum(kind["violations"] for kind in result["kinds"]) == len(result["failures"])
    assert json.loads((out / "campaign.json").read_text())["id"] == result["id"]

    failing = result["failures"][0]["evaluation"]
    scenario = out / f"{failing:06d}.json"
    again = drivora("run", scenario, "--json").json()
    shown = drivora("campaign", "show", result["id"], "--evaluation", failing, "--json").json()
    assert again["trace_sha256"] == shown["trace_sha256"]
    assert shown["lineage"] == []
    assert (out / f"{failing:06d}.trace.parquet").is_file()
    printed = drivora("campaign", "scenario", result["id"], failing)
    assert printed.out == scenario.read_text()

    (listed,) = drivora("campaign", "list", "--json").json()
    assert listed["id"] == result["id"]
    shown_at_length = drivora("campaign", "show", result["id"], "--out", tmp_path / "again").out
    first = min(kind["first"] for kind in result["kinds"])
    assert f"drivora plot {result['id']}-{first} (or: runs show, replay, minimize)" in (
        shown_at_length
    )
    evaluation = drivora("campaign", "show", result["id"], "--evaluation", first).out
    assert f"Run {result['id']}-{first}: drivora plot {result['id']}-{first}" in evaluation
    assert "Lineage" in drivora("campaign", "show", result["id"], "--evaluation", 3).out
    assert drivora("campaign", "resume", result["id"]).code == 3

    # The folder can be written again, by either command.
    written = {path.name: path.read_bytes() for path in out.iterdir()}
    shutil.rmtree(out)
    resumed = drivora("campaign", "resume", result["id"], "--out", out)
    assert resumed.code == 0
    assert "is finished; its folder is written again" in resumed.err
    for folder in (out, tmp_path / "again"):
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == written


@pytest.mark.slow(seconds=30)
def test_a_killed_campaign_goes_on_as_if_nothing_had_happened(
    drivora: Drivora, campaign_file: Path, tmp_path: Path
) -> None:
    luck = random.Random(5)
    campaign_file.write_text(CAMPAIGN.replace("simulations: 24", "simulations: 48"))
    process: subprocess.Popen[bytes] | Begun = start(tmp_path, "run", campaign_file)
    killed: list[int] = []
    campaign_id = ""
    for kill in range(3):
        told = len(evaluations(tmp_path, campaign_id)) if campaign_id else 0
        found = wait_until_told(tmp_path, process, told + luck.randrange(5))
        campaign_id = campaign_id or found
        time.sleep(luck.uniform(0.0, 0.2))
        process.kill()
        process.wait()
        killed.append(len(evaluations(tmp_path, campaign_id)))
        assert drivora("campaign", "show", campaign_id, "--json").json()["state"] == "interrupted"
        if kill < 2:
            process = begin_campaign(tmp_path, "resume", campaign_id, "--workers", str(1 + kill))
    assert 0 < killed[0] < killed[1] < killed[2] < 48
    result: dict[str, Any] = drivora("campaign", "resume", campaign_id, "--json").json()
    assert result["state"] == "finished"
    whole = drivora("campaign", "run", campaign_file, "--json").json()["id"]
    assert sequence(evaluations(tmp_path, campaign_id)) == sequence(evaluations(tmp_path, whole))
    assert {f["confirmation"] for f in result["failures"]} == {"confirmed"}


@pytest.mark.slow
def test_an_interrupt_pauses_and_another_process_can_ask_for_it(
    drivora: Drivora, campaign_file: Path, tmp_path: Path
) -> None:
    # It must not end before the command that asks for a pause has got ready.
    campaign_file.write_text(CAMPAIGN.replace("simulations: 24", "simulations: 2000"))
    process = begin_campaign(tmp_path, "run", campaign_file, "--out", "my findings")
    campaign_id = wait_until_told(tmp_path, process, 2)
    process.send_signal(signal.SIGINT)
    assert process.wait(60.0) == 130
    log = (tmp_path / "campaign.log").read_text()
    assert "interrupted: the campaign is paused and its " in log
    assert f"resume it with: drivora campaign resume {campaign_id} --out 'my findings'" in log
    assert "Traceback" not in log
    assert drivora("campaign", "show", campaign_id, "--json").json()["state"] == "paused"

    told = len(evaluations(tmp_path, campaign_id))
    process = begin_campaign(tmp_path, "resume", campaign_id)
    wait_until_told(tmp_path, process, told + 2)
    asked = drivora("campaign", "pause", campaign_id, "--json").json()
    assert asked["state"] in ("running", "paused")
    assert process.wait(60.0) == 3
    paused = drivora("campaign", "show", campaign_id, "--json").json()
    assert paused["state"] == "paused"
    assert told + 2 < paused["counts"]["evaluations"] < 2000
    assert drivora("campaign", "cancel", campaign_id, "--json").json()["state"] == "cancelled"
    ended = drivora("campaign", "resume", campaign_id)
    assert ended.code == 3
    assert "cancelled" in ended.err


@pytest.mark.slow(seconds=60)
def test_a_campaign_that_the_database_stops_says_so_and_can_be_resumed(
    campaign_file: Path, tmp_path: Path
) -> None:
    campaign_file.write_text(CAMPAIGN.replace("simulations: 24", "simulations: 2000"))
    process = begin_campaign(tmp_path, "run", campaign_file)
    campaign_id = wait_until_told(tmp_path, process, 0)
    file = tmp_path / "data" / "drivora.sqlite3"
    with closing(sqlite3.connect(file, timeout=30.0, isolation_level=None)) as other:
        other.execute("BEGIN EXCLUSIVE")
        assert process.wait(100.0) == 3
    log = (tmp_path / "campaign.log").read_text()
    assert "the database cannot be used now: database is locked" in log
    assert f"interrupted; resume it with: drivora campaign resume {campaign_id}" in log


@pytest.mark.slow
def test_a_folder_of_seed_scenarios_is_searched_in_turns(
    drivora: Drivora, campaign_file: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "seeds"
    span = ("--min-length", "50", "--max-length", "300")
    made = drivora("seeds", "generate", "--town", "tee-town", "--num", "2", *span, "--out", folder)
    assert made.code == 0
    (folder / "crossing.json").write_text(json.dumps(SCENARIO))
    (tmp_path / "crossing.json").unlink()
    campaign_file.write_text(CAMPAIGN.replace("file: crossing.json", "folder: seeds"))
    campaign = drivora("campaign", "run", campaign_file, "--json").json()
    assert [(seed["name"], seed["simulations"]) for seed in campaign["seeds"]] == [
        ("crossing", 8),
        ("tee-town_0001", 8),
        ("tee-town_0002", 8),
    ]
    found = evaluations(tmp_path, campaign["id"])
    for number, seed in enumerate(campaign["seeds"]):
        own = [record for record in found if record.seed_number == number]
        assert seed["town"] == "tee-town"
        assert seed["evaluations"] == len(own)
        assert seed["violating"] == sum(bool(record.violations) for record in own)
        assert seed["kinds"] == len({kind for record in own for kind in record.failure_kinds})
    assert "Seed scenarios" in drivora("campaign", "show", campaign["id"]).out
    report = drivora("campaign", "report", campaign["id"]).out
    assert "| tee-town_0001 | tee-town | 8 |" in report
    # Laws have judged the runs of this method, which does not search by them.
    verdicts = [verdict for record in found for verdict in record.report.verdicts]
    covered = law_coverage(verdicts)
    assert covered is not None
    assert f"| coverage of traffic laws | {covered:.1%} of the ways to violate them |" in report
