from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

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
        (dropped["oracle"], "not judged", dropped["outcome"].replace("_", " ")),
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
