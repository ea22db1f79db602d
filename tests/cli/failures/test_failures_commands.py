"""``drivora failures``: failures, their groups, and what is decided about them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from drivora_service.cli.failures.failure_output import print_counts
from drivora_service.oracles.verdicts.failure_definition import state_definition
from drivora_service.store.failures.found_counting import FoundCounts
from tests.api.test_found_failures import crash
from tests.cli.conftest import Drivora

HIT = "collision|npc_obstacle, front|standing"


@pytest.fixture(scope="module")
def crashed_data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the first test leaves its data folder with a run that fails, for the others."""
    return tmp_path_factory.mktemp("crashed") / "data"


@pytest.fixture
def crashed(drivora: Drivora, tmp_path: Path, crashed_data: Path) -> dict[str, Any]:
    """The collision of a run in the data folder of the test."""
    data = tmp_path / "data"
    if crashed_data.exists():
        shutil.copytree(crashed_data, data)
    else:
        file = tmp_path / "crash.json"
        file.write_text(json.dumps(crash()))
        assert drivora("run", file, "--json", "--workers", "1").json()["status"] == "finished"
        shutil.copytree(data, crashed_data)
    (run,) = drivora("runs", "list", "--json").json()
    found: dict[str, Any]
    (found,) = drivora("failures", "list", "--oracle", "collision", "--json").json()
    assert found["run_id"] == run["id"]
    return found


def test_what_was_decided_is_shown_with_the_group(
    drivora: Drivora, crashed: dict[str, Any]
) -> None:
    group = crashed["group_id"]
    listed = drivora("failures", "list", "--group", group)
    assert f" {crashed['id']} " in listed.out
    assert "an obstacle" in listed.out
    assert "1 failures; 1 at fault and avoidable" in listed.out
    assert f"run {crashed['run_id']}\n" in listed.out
    assert f"drivora plot {crashed['run_id']} (or: runs show, replay, minimize)" in listed.out
    until = f"{crashed['avoidable_until']:.2f} s"
    assert f"Avoidable until {until}." in " ".join(
        drivora("runs", "show", crashed["run_id"], COLUMNS="300").out.split()
    )
    decided = drivora(
        *("failures", "decide", group, "--status", "known", "--note", "Seen.", "--by", "Ada"),
        "--json",
    ).json()
    assert (decided["status"], decided["note"], decided["changed_by"]) == ("known", "Seen.", "Ada")
    drivora("failures", "decide", group, "--assignee", "Bo", "--label", "container")
    shown = drivora("failures", "show", group)
    for text in ("known", "container", "Bo", crashed["sentence"], "Seen."):
        assert text in shown.out
    assert "Ada: status new → known" in shown.out
    assert ": label (none) → container" in shown.out
    assert drivora("failures", "show", group, "--json").json()["names"] == [HIT]
    ids = [g["id"] for g in drivora("failures", "groups", "--status", "known", "--json").json()]
    assert ids == [group]
    others = drivora("failures", "groups", "--status", "new", "--json").json()
    assert group not in [g["id"] for g in others]


def test_groups_are_merged_and_split(
    drivora: Drivora, crashed: dict[str, Any], tmp_path: Path
) -> None:
    late = crash() | {"npc_obstacles": [], "max_sim_time": 1.0}
    file = tmp_path / "late.json"
    file.write_text(json.dumps(late))
    assert drivora("run", file, "--json", "--workers", "1").json()["violations"] == 1
    all_of_them = drivora("failures", "groups", "--json").json()
    others = [g["id"] for g in all_of_them if g["id"] != crashed["group_id"]]
    assert others, "the ego of the other run misses its destination"
    merged = drivora("failures", "merge", crashed["group_id"], *others, "--json").json()
    assert merged["failures"] == sum(g["failures"] for g in all_of_them)
    assert len(drivora("failures", "groups", "--json").json()) == 1
    part = drivora(
        *("failures", "split", merged["id"], "--failure", str(crashed["id"])),
        *("--label", "this one", "--json"),
    ).json()
    assert (part["label"], part["failures"], part["names"]) == ("this one", 1, [HIT])
    shown = drivora("failures", "show", merged["id"]).out
    assert "split 1 failures off" in shown
    assert "into it" in shown
    assert "split it off" in drivora("failures", "show", part["id"]).out
    by_name = drivora("failures", "split", part["id"], "--failure", str(crashed["id"]))
    assert by_name.code == 2
    assert "nothing would be left of the group" in by_name.err


def test_groups_are_compared_with_a_baseline(drivora: Drivora, crashed: dict[str, Any]) -> None:
    table = drivora("failures", "groups", "--baseline", "2020-01-01T00:00:00Z")
    assert table.out.rstrip().endswith("new, 0 same, 0 gone")
    later = ("--baseline", "2100-01-01T00:00:00Z", "--since-baseline")
    assert drivora("failures", "groups", *later, "new", "--json").json() == []
    gone = drivora("failures", "groups", *later, "gone", "--json").json()
    assert crashed["group_id"] in [g["id"] for g in gone]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("groups", "--status", "old"), "known: new, known, fixed, will_not_fix"),
        (("groups", "--since-baseline", "new"), "needs --baseline"),
        (("groups", "--baseline", "x", "--since-baseline", "old"), "known: new, same, gone"),
        (("groups", "--baseline", "last week"), "2026-11-20T08:00:00Z"),
        (("list", "--accountability", "some"), "known: avoidable"),
        (("decide", "0" * 24), "--status"),
        (("decide", "0" * 24, "--note", "n"), "unknown group of failures"),
        (("merge", "0" * 24, "1" * 24), "unknown group of failures"),
        (("split", "0" * 24), "--failure"),
        (("show", "0" * 24), "unknown group of failures"),
    ],
)
def test_what_cannot_be_done_is_told(
    drivora: Drivora, arguments: tuple[str, ...], told: str
) -> None:
    drivora("store", "migrate")
    ended = drivora("failures", *arguments)
    assert (ended.code, ended.out) == (2, "")
    assert told in " ".join(ended.err.split())


def test_failures_of_one_agent_with_other_parameters_are_listed_apart(
    drivora: Drivora, crashed: dict[str, Any], tmp_path: Path
) -> None:
    file = tmp_path / "crash.json"
    file.write_text(json.dumps(crash()))
    fast = ("--agent-parameter", "speed=9")
    run = drivora("run", file, "--json", "--workers", "1", *fast).json()
    found = drivora(
        *("failures", "list", "--oracle", "collision", "--json"),
        *("--configuration", run["configuration_id"]),
    ).json()
    assert [one["run_id"] for one in found] == [run["id"]]
    assert found[0]["configuration"] == "scripted · speed 9.0"
    assert "speed 9.0" in drivora("failures", "list").out
    assert crashed["configuration"] == "scripted"
    assert crashed["configuration_id"] != run["configuration_id"]


@pytest.mark.parametrize("command", ["list", "groups"])
@pytest.mark.usefixtures("crashed")
def test_unknown_names_are_refused(drivora: Drivora, command: str) -> None:
    for kind in ("batch", "campaign", "study", "oracle"):
        answer = drivora("failures", command, f"--{kind}", "nosuch")
        assert answer.code == 2
        assert f"unknown {kind} 'nosuch'" in answer.err


def test_runs_in_which_the_ads_failed_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    counts = FoundCounts(
        failures=0,
        avoidable=0,
        preventable=0,
        runs=0,
        agent_failed_runs=2,
        definition=state_definition(()),
    )
    print_counts(counts)
    shown = capsys.readouterr().out
    assert "0 failures in 0 runs" in shown
    assert "and 2 runs in which the ADS failed" in shown
