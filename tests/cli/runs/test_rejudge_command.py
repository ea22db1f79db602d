from __future__ import annotations

import json
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from drivora_service.oracles.oracles_version import ORACLES, oracles_version
from drivora_service.oracles.verdict import Outcome
from tests.cli.conftest import Drivora


@pytest.fixture
def results(drivora: Drivora, scenario_file: Path, tmp_path: Path) -> Path:
    """A run with its report."""
    out = tmp_path / "results"
    assert drivora("run", scenario_file, "--out", out).code == 0
    return out


def test_what_changed_is_said_and_decides_the_exit_code(drivora: Drivora, results: Path) -> None:
    same = drivora("rejudge", results)
    assert same.code == 0, same.err
    assert "Traces: 1; compared: 1; changed: 0" in same.out

    # As an earlier version may have judged it, before fault and severity were known.
    report = results / "crossing.report.json"
    content = json.loads(report.read_text())
    for verdict in content["verdicts"]:
        for key in ("severity", "undetermined", "avoidable", "physically_avoidable"):
            del verdict[key]
    collision = next(v for v in content["verdicts"] if v["oracle"] == "collision")
    collision.update(outcome="violated", at_fault=True)
    dropped = content["verdicts"].pop()
    report.write_text(json.dumps(content))
    changed = drivora("rejudge", results / "crossing.trace.parquet", "--json")
    assert changed.code == 1
    (run,) = changed.json()["runs"]
    assert run["compared"]
    assert {(c["oracle"], c["before"], c["after"]) for c in run["changes"]} == {
        ("collision", "violated (at fault)", "passed"),
        (dropped["oracle"], "not judged", Outcome(dropped["outcome"]).in_words),
    }
    table = drivora("rejudge", results)
    assert "violated (at fault)" in table.out
    assert "Traces: 1; compared: 1; changed: 1" in table.out


def test_a_trace_without_a_report_is_judged_and_not_compared(
    drivora: Drivora, results: Path, tmp_path: Path
) -> None:
    alone = tmp_path / "alone" / "crossing.trace.parquet"
    alone.parent.mkdir()
    shutil.copy(results / alone.name, alone)
    ended = drivora("rejudge", alone)
    assert ended.code == 0
    assert "no report beside it" in ended.out


def test_what_cannot_be_judged_is_named(drivora: Drivora, tmp_path: Path) -> None:
    broken = tmp_path / "broken.trace.parquet"
    broken.write_text("no trace")
    ended = drivora("rejudge", broken)
    assert ended.code == 3
    assert str(broken) in ended.out
    assert drivora("rejudge", tmp_path / "none").code == 2
    assert drivora("rejudge", "none.trace.parquet").code == 2


def test_a_trace_without_the_hash_of_its_report_is_damaged(
    drivora: Drivora, scenario_file: Path, results: Path
) -> None:
    assert (
        drivora("run", scenario_file, "--agent", "scripted", "--out", results / "other").code == 0
    )
    other = results / "other" / "crossing.trace.parquet"
    shutil.copy(other, results / other.name)
    report = json.loads((results / "crossing.report.json").read_text())
    ended = drivora("rejudge", results / other.name)
    assert ended.code == 3
    assert f"run {report['id']}: its trace file crossing.trace.parquet is damaged" in ended.out
    assert "Traces: 1; compared: 0; changed: 0; damaged: 1" in ended.out
    (run,) = drivora("rejudge", results / other.name, "--json").json()["runs"]
    assert (run["run"], run["damaged"], run["compared"]) == (report["id"], True, False)
    assert run["verdicts"] == []


def test_traces_of_the_data_folder_are_judged_with_what_is_stored_of_their_runs(
    drivora: Drivora, results: Path, tmp_path: Path
) -> None:
    data = tmp_path / "data"
    run_id = json.loads((results / "crossing.report.json").read_text())["id"]
    (file,) = data.glob("traces/*/*.parquet")
    for place in (data, data / "traces", file.parent, file, run_id):
        same = drivora("rejudge", place, "--json")
        assert same.code == 0, same.err
        (run,) = same.json()["runs"]
        assert (run["run"], run["compared"], run["changes"]) == (run_id, True, [])
        assert run["trace"] == (run_id if place == run_id else str(file))
    with closing(sqlite3.connect(data / "drivora.sqlite3")) as connection, connection:
        ((body,),) = connection.execute("SELECT body FROM reports").fetchall()
        content = json.loads(body)
        dropped = content["verdicts"].pop()
        connection.execute("UPDATE reports SET body = ?", (json.dumps(content),))
    changed = drivora("rejudge", data, "--json")
    assert changed.code == 1
    (run,) = changed.json()["runs"]
    assert [(c["oracle"], c["before"]) for c in run["changes"]] == [
        (dropped["oracle"], "not judged")
    ]
    # A file that no run has, such as one of a run that is under way, is of no verdict.
    shutil.copy(file, file.with_name(f"other{run_id[-2:]}.parquet"))
    assert drivora("rejudge", data).code == 1
    stray = drivora("rejudge", file.with_name(f"other{run_id[-2:]}.parquet"))
    assert stray.code == 0
    assert "not judged: no stored run has this trace" in stray.out
    unknown = drivora("rejudge", "0" * 24)
    assert unknown.code == 3
    assert f"{'0' * 24}: unknown run '{'0' * 24}'" in unknown.out


def test_other_folders_with_the_data_folder_around_them_are_those_of_commands(
    drivora: Drivora, results: Path, tmp_path: Path
) -> None:
    inside = tmp_path / "data" / "results"
    shutil.copytree(results, inside)
    ended = drivora("rejudge", inside)
    assert ended.code == 0
    assert "Traces: 1; compared: 1; changed: 0; damaged: 0" in ended.out
    (tmp_path / "empty").mkdir()
    assert drivora("rejudge", tmp_path / "empty").code == 2


def test_a_store_of_older_oracles_is_judged_again_without_being_changed(
    drivora: Drivora, results: Path, tmp_path: Path
) -> None:
    data = tmp_path / "data"
    content = json.loads((results / "crossing.report.json").read_text())
    assert content["versions"][ORACLES] == oracles_version()
    shown = drivora("runs", "show", content["id"])
    assert "another version" not in shown.out
    assert "another version" not in drivora("rejudge", data).out

    with closing(sqlite3.connect(data / "drivora.sqlite3")) as connection, connection:
        ((body,),) = connection.execute("SELECT body FROM reports").fetchall()
        older = json.loads(body)
        older["versions"][ORACLES] = "of-old"
        collision = next(v for v in older["verdicts"] if v["oracle"] == "collision")
        collision.update(outcome="violated", at_fault=True)
        connection.execute("UPDATE reports SET body = ?", (json.dumps(older),))
    shown = drivora("runs", "show", content["id"])
    assert "judged by another version of the oracles" in shown.out
    assert f"drivora rejudge {content['id']}" in shown.out

    before = (data / "drivora.sqlite3").read_bytes()
    judged = drivora("rejudge", data)
    assert judged.code == 1
    assert "Changed verdicts by oracle" in judged.out
    assert "Traces: 1; compared: 1; changed: 1; damaged: 0" in judged.out
    assert "Judged before by another version of the oracles: 1" in judged.out
    (run,) = drivora("rejudge", data, "--json").json()["runs"]
    assert run["by_other_oracles"]
    assert (data / "drivora.sqlite3").read_bytes() == before


def test_a_report_without_the_version_of_its_oracles_is_of_other_ones(
    drivora: Drivora, results: Path
) -> None:
    report = results / "crossing.report.json"
    content = json.loads(report.read_text())
    del content["versions"][ORACLES]
    report.write_text(json.dumps(content))
    (run,) = drivora("rejudge", results, "--json").json()["runs"]
    assert (run["by_other_oracles"], run["changes"]) == (True, [])
