"""``drivora study``, also killed in the middle, and gone on with from a copy of its data folder."""

from __future__ import annotations

import json
import os
import random
import shutil
import time
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.store.database import open_database
from tests.campaigns.analytic import sequence
from tests.cli.conftest import Drivora
from tests.command_process import Begun, begin

STUDY = """
name: crossings
scenarios: [seeds]
agents: [{name: idm}]
methods: [{name: random}, {name: avfuzzer, parameters: {population: 4}}]
repetitions: 2
space: {vehicles: 2, walkers: 1}
oracles: [collision, discomfort]
budget: {simulations: 10}
workers: 2
"""


@pytest.fixture
def study_file(tmp_path: Path) -> Path:
    (tmp_path / "seeds").mkdir()
    for name, seed in (("one", 1), ("two", 2)):
        (tmp_path / "seeds" / f"{name}.json").write_text(json.dumps({**SCENARIO, "seed": seed}))
    path = tmp_path / "study.yaml"
    path.write_text(STUDY)
    return path


def begin_study(tmp_path: Path, *arguments: str | Path) -> Begun:
    """Begins a command and does not wait for it."""
    log = tmp_path / "study.log"
    environment = {**os.environ, "DRIVORA_DATA_DIR": str(tmp_path / "data")}
    return begin("study", *arguments, folder=tmp_path, environment=environment, out=log, err=log)


def wait_until_told(data: Path, process: Begun, more_than: int) -> str:
    """Waits until the study has more than so many simulations; returns its id."""
    while not (data / "drivora.sqlite3").exists():
        assert process.poll() is None, (data.parent / "study.log").read_text()
        time.sleep(0.02)
    opened = open_database(f"sqlite:///{data / 'drivora.sqlite3'}")
    try:
        deadline = time.monotonic() + 200.0
        while time.monotonic() < deadline and process.poll() is None:
            with opened.read() as transaction:
                for study in transaction.studies.page().items:
                    if study.simulations > more_than:
                        return study.id
            time.sleep(0.02)
    finally:
        opened.close()
    raise AssertionError((data.parent / "study.log").read_text())


def evaluations(data: Path, campaign_id: str) -> list[EvaluationRecord]:
    opened = open_database(f"sqlite:///{data / 'drivora.sqlite3'}")
    try:
        return list(StoreJournal(opened, campaign_id).evaluations())
    finally:
        opened.close()


def test_a_bad_file_is_refused_with_every_place(drivora: Drivora, study_file: Path) -> None:
    drivora("store", "migrate")
    study_file.write_text(STUDY.replace("name: random", "name: randon").replace("idm", "idn"))
    ended = drivora("study", "run", study_file)
    assert ended.code == 2
    assert "/agents/0/name: " in ended.err
    assert "/methods/0/name: " in ended.err
    assert drivora("study", "list", "--json").json() == []
    study_file.write_text(STUDY.replace("[seeds]", "[nowhere]"))
    ended = drivora("study", "run", study_file)
    assert ended.code == 2
    assert "/scenarios/0: there is no file" in ended.err


def test_what_is_not_there_is_wrong_use(drivora: Drivora) -> None:
    drivora("store", "migrate")
    for command in ("show", "resume", "pause", "cancel", "compare"):
        ended = drivora("study", command, "0123")
        assert ended.code == 2
        assert "unknown study '0123'" in ended.err


@pytest.mark.slow(seconds=60)
def test_a_killed_study_goes_on_elsewhere_as_if_nothing_had_happened(
    drivora: Drivora, study_file: Path, tmp_path: Path
) -> None:
    luck = random.Random(3)
    data = tmp_path / "data"
    process = begin_study(tmp_path, "run", study_file)
    study_id = wait_until_told(data, process, 5)
    for more in (20, 45):
        time.sleep(luck.uniform(0.0, 0.2))
        process.kill()
        process.wait()
        shown = drivora("study", "show", study_id, "--json").json()
        assert shown["state"] == "interrupted"
        process = begin_study(tmp_path, "resume", study_id, "--workers", "1")
        assert wait_until_told(data, process, more) == study_id
    process.kill()
    process.wait()
    # A copy of the data folder is all that another machine needs.
    copy = tmp_path / "elsewhere"
    shutil.copytree(data, copy)
    shutil.rmtree(data)
    ended = drivora("study", "resume", study_id, "--data-dir", copy, "--json")
    assert ended.code == 0, ended.err
    result: dict[str, Any] = ended.json()
    assert result["state"] == "finished"
    assert result["simulations"] == result["budget"] == 80
    assert result["campaigns"] == {"finished": 8}
    # Each campaign is what it would have been by itself.
    for campaign in result["campaign_list"][:2]:
        document = drivora("campaign", "show", campaign["id"], "--data-dir", copy, "--json").json()[
            "document"
        ]
        alone_file = tmp_path / "alone.json"
        alone_file.write_text(json.dumps(document))
        alone = drivora("campaign", "run", alone_file, "--data-dir", copy, "--json").json()
        assert sequence(evaluations(copy, campaign["id"])) == sequence(
            evaluations(copy, alone["id"])
        )
        assert alone["study_id"] == ""
    assert (
        "By scenario and agent: all repetitions together"
        in drivora("study", "show", study_id, "--data-dir", copy).out
    )
    assert drivora("study", "resume", study_id, "--data-dir", copy).code == 3

    compared = drivora("study", "compare", study_id, "--data-dir", copy, "--out", tmp_path / "out")
    assert compared.code == 0, compared.err
    assert "Overview by method, against random" in compared.out
    assert (tmp_path / "out" / "values.svg").is_file()
    exported = drivora("study", "export", study_id, "--data-dir", copy, "--out", tmp_path / "out")
    assert exported.code == 0, exported.err
    table = pq.read_table(tmp_path / "out" / "evaluations.parquet")
    simulated = [row for row in table.column("status").to_pylist() if row != "invalid"]
    assert len(simulated) == 80


@pytest.mark.slow(seconds=30)
def test_a_study_is_paused_and_cancelled_by_other_commands(
    drivora: Drivora, study_file: Path, tmp_path: Path
) -> None:
    study_file.write_text(STUDY.replace("simulations: 10", "simulations: 2000"))
    process = begin_study(tmp_path, "run", study_file)
    study_id = wait_until_told(tmp_path / "data", process, 2)
    refused = drivora("study", "resume", study_id)
    assert refused.code == 3
    assert f"is running study {study_id} already" in refused.err
    assert drivora("study", "pause", study_id).code == 0
    assert process.wait(60.0) == 3
    paused = drivora("study", "show", study_id, "--json").json()
    assert paused["state"] == "paused"
    assert 2 < paused["simulations"] < 16_000
    (listed,) = drivora("study", "list", "--json").json()
    assert (listed["id"], listed["state"]) == (study_id, "paused")

    # While another command runs it, it is cancelled.
    process = begin_study(tmp_path, "resume", study_id)
    wait_until_told(tmp_path / "data", process, paused["simulations"] + 2)
    cancelled = drivora("study", "cancel", study_id)
    assert cancelled.code == 0
    assert f"study {study_id} is running, cancel requested" in cancelled.out
    assert process.wait(60.0) == 3
    ended = drivora("study", "show", study_id, "--json").json()
    assert ended["state"] == "cancelled"
    assert ended["campaigns"] == {"cancelled": 8}
    assert ended["simulations"] > paused["simulations"]
    assert drivora("study", "cancel", study_id).out == f"study {study_id} is cancelled\n"
    refused = drivora("study", "resume", study_id)
    assert refused.code == 3
    assert "are over" in refused.err
