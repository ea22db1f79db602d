"""``drivora compare`` on runs that were really made."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.cli.conftest import Drivora

_SEEDS = "seeds generate --town signal-grid --num 8 --seed 3 --min-length 60 --max-length 120"


@pytest.fixture
def scenarios(drivora: Drivora, tmp_path: Path) -> Path:
    """Seeds with background traffic, so that other vehicles take part."""
    folder = tmp_path / "seeds"
    ended = drivora(*_SEEDS.split(), "--out", folder)
    assert ended.code == 0, ended.err
    for path in folder.iterdir():
        content = {**json.loads(path.read_text()), "background_traffic": {"count": 12}}
        path.write_text(json.dumps(content))
    return folder


def counted(run: dict[str, Any]) -> set[str]:
    """The oracles that count as failures of a run, from its verdicts alone."""
    return {
        verdict["oracle"]
        for verdict in run["verdicts"]
        if verdict["outcome"] == "violated"
        and verdict["severity"] != "observation"
        and not (
            verdict["oracle"] == "destination"
            and verdict["evidence"].get("reason") in ("collision", "stuck", "route_deviation")
        )
        and not verdict["undetermined"]
        and (
            verdict["at_fault"] is None
            or (verdict["at_fault"] and verdict["avoidable"] in (None, "yes", "not_measurable"))
        )
    }


def exact_p(first: int, second: int) -> float:
    """McNemar's test from binomial coefficients."""
    n = first + second
    tail = sum(math.comb(n, k) for k in range(min(first, second) + 1)) / 2**n
    return float(min(1.0, 2.0 * tail))


@pytest.mark.slow(seconds=40)
def test_two_versions_of_an_ads_are_told_apart(
    drivora: Drivora, scenarios: Path, tmp_path: Path, service_url: str
) -> None:
    sides: list[dict[str, Any]] = []
    for name, options in (
        ("base", ("--agent", "idm")),
        ("fast", ("--agent", "idm", "--agent-parameter", "speed_factor=1.4")),
    ):
        ended = drivora("run", scenarios, *options, "--name", name, "--json")
        assert ended.code == 0, ended.err
        sides.append(ended.json())
    a, b = ({run["scenario"]: run for run in side["runs"]} for side in sides)
    out = tmp_path / "out"
    ended = drivora("compare", "base", sides[1]["batch_id"], "--out", out, "--json")
    assert ended.code == 0, ended.err
    found = ended.json()
    assert (found["a"]["batch"], found["a"]["name"]) == (sides[0]["batch_id"], "base")
    a_only = [name for name in a if counted(a[name]) and not counted(b[name])]
    b_only = [name for name in a if counted(b[name]) and not counted(a[name])]
    table = found["failures"]
    assert (table["a_only"], table["b_only"]) == (len(a_only), len(b_only))
    assert b_only, "an ego that drives faster than it may has more failures"
    assert table["a_only"] + table["b_only"] + table["both"] + table["neither"] == 8
    assert table["p"] == pytest.approx(exact_p(len(a_only), len(b_only)))
    assert f"fails in {len(b_only)} of 8 scenarios in which A" in found["sentence"]
    assert [one["name"] for one in found["differences"]] == ["idm.speed_factor"]
    metrics = {row["metric"]: row for row in found["metrics"]}
    for name in ("driving_score", "mean_speed_mps", "min_gap_m"):
        both = [(a[one]["metrics"][name], b[one]["metrics"][name]) for one in a]
        known = [(x, y) for x, y in both if x is not None and y is not None]
        row = metrics[name]
        assert (row["pairs"], row["not_measurable"]) == (len(known), len(both) - len(known))
        if known:
            difference = sum(y - x for x, y in known) / len(known)
            assert row["difference"] == pytest.approx(difference, abs=1e-9)
    speeds = metrics["mean_speed_mps"]
    assert 0.0 < speeds["low"] < speeds["difference"] < speeds["high"]
    pairs = {pair["scenario"]: pair for pair in found["pairs"]}
    assert pairs.keys() == a.keys()
    for name, pair in pairs.items():
        assert (pair["a"]["run"], pair["b"]["run"]) == (a[name]["id"], b[name]["id"])
        assert {one["oracle"] for one in pair["b"]["failures"]} == counted(b[name])
        assert pair["same_trace"] == (a[name]["trace_sha256"] == b[name]["trace_sha256"])
    rows = list(csv.DictReader((out / "pairs.csv").read_text().splitlines()))
    assert {row["scenario"] for row in rows} == set(pairs)
    printed = drivora("compare", "base", "fast", "--metric", "success")
    assert "A: idm, batch" in printed.out
    assert "Pairs that tell A from B" in printed.out
    server = ("--server", service_url)
    there = drivora(
        "compare", scenarios, "--agent-a", "idm", "--parameter-b", "speed_factor=1.4", *server,
        "--json",
    )  # fmt: skip
    assert there.code == 0, there.err
    told = there.json()
    # The same scenarios, agents and seeds have the same traces, wherever they are run.
    assert told["failures"] == table
    assert told["a"]["name"] == "drivora compare, A"


def test_one_command_runs_both_and_names_what_cannot_be_run(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    odd = tmp_path / "odd.json"
    odd.write_text(json.dumps({**SCENARIO, "seed": -1}))
    same = drivora("compare", scenario_file, odd, "--agent-a", "idm", "--agent-b", "idm", "--json")
    assert same.code == 3
    assert "odd.json: /seed" in same.err
    (pair,) = same.json()["pairs"]
    assert (pair["scenario"], pair["same_trace"]) == ("crossing", True)
    assert "the batches do not differ" in "".join(same.json()["notes"])
    nothing = drivora("compare", odd, "--agent-a", "idm")
    assert nothing.code == 3


def test_batches_without_a_scenario_in_common_are_told(
    drivora: Drivora, scenario_file: Path
) -> None:
    for seed in ("1", "2"):
        assert drivora("run", scenario_file, "--seed", seed, "--name", seed).code == 0
    ended = drivora("compare", "1", "2")
    assert ended.code == 3
    assert "Nothing is compared" in ended.out
    assert "left out: crossing, seed 1: the seeds differ: 1 and 2" in ended.out


def test_what_is_wrong_with_the_command_is_said(drivora: Drivora, scenario_file: Path) -> None:
    ran = drivora("run", scenario_file)
    assert ran.code == 0
    assert ran.err.strip().rpartition("batch ")[2] in drivora("runs", "list", "--json").out
    for arguments, message in (
        (("one",), "found 1 batches; allowed: two"),
        (("one", "two"), "unknown batch 'one'"),
        (("drivora run", "drivora run", "--metric", "beauty"), "unknown metric 'beauty'"),
        (("drivora run", "drivora run", "--oracle", "luck"), "unknown oracle 'luck'"),
        (("one", "two", "--counts", "none"), "known: accountable, preventable, at_fault, possibly"),
        (("one", "two", "--unfinished", "some"), "known: agent, all, none"),
        (("one", "two", "--workers", "2"), "--workers and --seed are for scenarios"),
        ((scenario_file, "--agent-a", "nobody"), "unknown agent 'nobody'"),
        ((scenario_file, "--parameter-b", "x"), "allowed: NAME=VALUE"),
    ):
        ended = drivora("compare", *arguments)
        assert ended.code == 2, (arguments, ended.err)
        assert message in ended.err, arguments
