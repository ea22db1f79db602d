"""``drivora suite``, with real runs."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml
from junitparser import JUnitXml

from drivora_service.suites.suite_seeds import seed_of_run
from tests.cli.conftest import Drivora, Ended

# Each command runs an ADS in several scenarios.
pytestmark = pytest.mark.slow

EXAMPLES = "openscenario_schemas/examples"


@pytest.fixture
def suite(tmp_path: Path, repository: Path) -> Path:
    """A suite of three scenarios, of which ``idm`` fails in one."""
    folder = tmp_path / "suite"
    (folder / "scenarios").mkdir(parents=True)
    for name in ("wet-arterial", "signalised-grid"):
        shutil.copy(repository / EXAMPLES / f"{name}.json", folder / "scenarios")
    case = json.loads(
        (repository / EXAMPLES / "responsibility/ego-creeps-into-standing-leader.json").read_text()
    )
    (folder / "creeping.json").write_text(json.dumps(case))
    document = {
        "name": "three",
        "scenarios": [
            {"file": "scenarios/*.json", "tags": ["driving"]},
            {"file": "creeping.json", "tags": ["scripted"], "oracles": ["collision"]},
        ],
    }
    (folder / "suite.yaml").write_text(yaml.safe_dump(document))
    return folder


def content_of(ended: Ended) -> dict[str, Any]:
    told: dict[str, Any] = ended.json()
    return told


def states(ended: Ended) -> dict[str, str]:
    return {one["scenario"]: one["state"] for one in content_of(ended)["scenarios"]}


def test_from_a_first_run_to_a_gate_with_a_baseline(
    drivora: Drivora, suite: Path, tmp_path: Path
) -> None:
    files = {name: tmp_path / "out" / name for name in ("j.xml", "r.html", "s.md", "c.csv", "r")}
    options = ("--junit", "--report", "--summary", "--csv", "--results")
    wanted = [text for pair in zip(options, files.values(), strict=True) for text in pair]
    first = drivora("suite", "run", suite, "--json", *wanted)
    assert first.code == 1, first.err
    assert states(first) == {
        "signalised-grid": "passes",
        "wet-arterial": "passes",
        "creeping": "fails the gate",
    }
    (junit,) = JUnitXml.fromfile(str(files["j.xml"]))
    assert (junit.tests, junit.failures) == (4, 2)
    assert "<svg" not in files["r.html"].read_text()
    assert "data:image/svg+xml;base64," in files["r.html"].read_text()
    assert all(path.stat().st_mode & 0o777 == 0o644 for path in files.values())

    baseline = tmp_path / "baseline.json"
    dry = drivora("suite", "baseline", suite, files["r"], "--baseline", baseline, "--dry-run")
    assert dry.code == 0, dry.err
    assert not baseline.exists()
    accepted = drivora("suite", "baseline", suite, files["r"], "--baseline", baseline)
    assert "holds 1 failures of 3 scenarios" in accepted.out

    same = drivora("suite", "run", suite, "--baseline", baseline)
    assert same.code == 0, same.err
    assert "Gate passed: 1 same against the baseline" in same.out

    # What counts otherwise cannot be compared with it.
    gate = tmp_path / "gate.yaml"
    gate.write_text("counts: any\n")
    others = ("--baseline", baseline, "--gate-file", gate)
    for refused in (
        drivora("suite", "run", suite, *others),
        drivora("suite", "gate", suite, files["r"], *others),
    ):
        assert refused.code == 2
        assert "count different failures in 3 of 3 scenarios" in refused.err

    # A regression: the ADS drives faster than allowed.
    faster = ("--agent", "idm", "--agent-parameter", "speed_factor=1.3", "--tag", "driving")
    worse = drivora("suite", "run", suite, "--baseline", baseline, "--json", *faster)
    assert worse.code == 1, worse.err
    told = content_of(worse)
    new = {one["oracle"] for one in told["failures"] if one["class"] == "new"}
    assert "speeding" in new
    # Confirmed once, and where runs differ from seed to seed twice.
    assert {one["of"] for one in told["failures"]} <= {5, 9}
    assert told["reasons"][0].startswith(f"{len(told['failures'])} new failure")

    again = drivora("suite", "run", suite, "--last-failed", "--json", *faster)
    assert set(states(again)) == {
        name for name, state in states(worse).items() if state == "fails the gate"
    }

    # The failure is corrected.
    fixed = tmp_path / "fixed.json"
    content = json.loads(baseline.read_text())
    failure = content["scenarios"]["creeping"]["failures"][0]
    content["scenarios"]["wet-arterial"]["failures"] = [{**failure, "counterpart": "gone"}]
    fixed.write_text(json.dumps(content))
    passed = drivora("suite", "run", suite, "--baseline", fixed, "--select", "wet", "--json")
    assert passed.code == 0
    assert content_of(passed)["counts"]["fixed"] == 1


def test_shards_are_judged_together(drivora: Drivora, suite: Path, tmp_path: Path) -> None:
    paths = [tmp_path / f"{number}.json" for number in (1, 2)]
    for number, path in enumerate(paths, start=1):
        ended = drivora("suite", "run", suite, "--shard", f"{number}/2", "--results", path)
        assert ended.code == 0, ended.err
        assert "this is a shard" in ended.err
    together = drivora("suite", "gate", suite, *paths, "--json", "--junit", tmp_path / "j.xml")
    assert together.code == 1
    assert states(together)["creeping"] == "fails the gate"
    assert len(states(together)) == 3
    one = drivora("suite", "gate", suite, paths[1])
    assert one.code == 2
    assert "without 1/2" in one.err
    twice = drivora("suite", "gate", suite, paths[0], paths[0])
    assert twice.code == 2
    assert "name each file once" in twice.err


def test_a_shard_confirms_what_changed(drivora: Drivora, suite: Path, tmp_path: Path) -> None:
    results, baseline = tmp_path / "r.json", tmp_path / "b.json"
    drivora("suite", "run", suite, "--results", results)
    drivora("suite", "baseline", suite, results, "--baseline", baseline)
    content = json.loads(baseline.read_text())
    assert content["scenarios"]["creeping"].pop("failures")
    baseline.write_text(json.dumps(content))
    options = ("--select", "creeping", "--shard", "1/1", "--baseline", baseline)
    ended = drivora("suite", "run", suite, *options, "--results", results)
    assert "scenarios whose change is to be confirmed: 1; 4 further runs of each" in ended.err
    together = drivora("suite", "gate", suite, results, "--baseline", baseline, "--json")
    (failure,) = content_of(together)["failures"]
    assert (failure["class"], failure["runs"], failure["of"]) == ("new", 5, 5)


def test_known_failures_do_not_fail_the_gate(drivora: Drivora, suite: Path) -> None:
    document = yaml.safe_load((suite / "suite.yaml").read_text())
    document["scenarios"][1]["known_failures"] = [{"oracle": "collision", "reason": "issue 17"}]
    (suite / "suite.yaml").write_text(yaml.safe_dump(document))
    ended = drivora("suite", "run", suite, "--select", "creeping", "--json")
    assert ended.code == 0, ended.err
    assert states(ended) == {"creeping": "known failures only"}


def test_repetitions_differ_in_their_seeds(drivora: Drivora, suite: Path) -> None:
    ended = drivora(
        *("suite", "run", suite, "--select", "wet", "--repetitions", 3, "--seed", 7, "--json")
    )
    assert ended.code in (0, 1), ended.err
    runs = content_of(ended)["runs"]
    seeds = [seed_of_run("wet-arterial", 0, number, given=7) for number in range(3)]
    assert [(run["repetition"], run["seed"]) for run in runs] == list(enumerate(seeds))
    shown = drivora("runs", "show", runs[1]["run_id"], "--json").json()
    assert (shown["seed"], shown["label"]) == (seeds[1], "wet-arterial")


def test_a_gate_file_limits_means_and_shares(drivora: Drivora, suite: Path, tmp_path: Path) -> None:
    gate = tmp_path / "gate.yaml"
    gate.write_text(
        "fail_on: []\nlimits: [{oracles: [collision], most_scenarios: 1}]\n"
        "metrics: [{metric: driving_score, at_least: 100}]\n"
    )
    ended = drivora("suite", "run", suite, "--gate-file", gate, "--json")
    assert ended.code == 1
    collisions, score = content_of(ended)["limits"]
    assert (collisions["value"], collisions["fails"]) == (1, False)
    assert score["fails"]
    assert ended.json()["reasons"] == [
        f"mean driving_score: {score['value']:.4g}; allowed: at least 100"
    ]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--select", "nothing"), "none of the 3 scenarios is chosen"),
        (("--tag", "x"), "tags: driving, scripted"),
        (("--shard", "3/2"), "--shard '3/2'"),
        (("--last-failed",), "was not run from this folder before"),
        (("--baseline", "none.json"), "none.json cannot be read"),
        (("--gate-file", "none.yaml"), "none.yaml cannot be read"),
        (("--junit", "/proc/x/j.xml"), "cannot write"),
        (("--agent", "nobody"), "unknown agent 'nobody'"),
    ],
)
def test_wrong_use_is_told_before_the_work(
    drivora: Drivora, suite: Path, arguments: tuple[str, ...], message: str
) -> None:
    ended = drivora("suite", "run", suite, *arguments)
    assert ended.code == 2, ended.err
    assert message in ended.err


def test_problems_of_a_suite_are_named_in_its_files(drivora: Drivora, suite: Path) -> None:
    broken = suite / "scenarios" / "wet-arterial.json"
    broken.write_text(broken.read_text().replace('"map_region"', '"map_regoin"'))
    ended = drivora("suite", "list", suite)
    assert ended.code == 2
    assert "/scenarios/0: " in ended.err
    assert "wet-arterial.json: /map_regoin" in ended.err


def test_scenarios_are_listed_without_a_run(drivora: Drivora, suite: Path) -> None:
    listed = drivora("suite", "list", suite, "--tag", "driving", "--json").json()
    assert [(one["scenario"], one["tags"]) for one in listed] == [
        ("signalised-grid", ["driving"]),
        ("wet-arterial", ["driving"]),
    ]
    assert "signalised-grid" in drivora("suite", "list", suite / "scenarios").out
    assert "creeping" in drivora("suite", "list", suite / "creeping.json").out


def test_failures_of_a_campaign_become_a_suite(
    drivora: Drivora, tmp_path: Path, repository: Path
) -> None:
    campaign = {
        "name": "found",
        "tester": {"name": "random"},
        "agent": {"name": "idm"},
        "scenario": {"file": str(repository / EXAMPLES / "campaigns/orchard-lane.json")},
        "space": {"egos": 5, "optional": True, "max_ego_delay": 3.0, "vehicles": 0, "walkers": 0},
        "budget": {"simulations": 60},
    }
    (tmp_path / "campaign.json").write_text(json.dumps(campaign))
    searched = drivora("campaign", "run", tmp_path / "campaign.json", "--json").json()
    counting = [
        one
        for one in searched["failures"]
        if one["verdict"]["at_fault"] is not False
        and not one["verdict"]["undetermined"]
        and one["verdict"]["avoidable"] != "no"
    ]
    assert counting
    options = ("--suite", tmp_path / "found", "--each", "failure", "--json")
    exported = drivora("campaign", "export", searched["id"], *options)
    assert exported.code == 0, exported.err
    added = exported.json()["added"]
    assert len(added) == len({one["evaluation"] for one in counting})
    ended = drivora("suite", "run", tmp_path / "found", "--json")
    assert ended.code == 1
    assert set(states(ended).values()) == {"fails the gate"}
    traces = {run["trace_sha256"] for run in content_of(ended)["runs"]}
    found = {
        drivora("campaign", "show", searched["id"], "--evaluation", number, "--json").json()[
            "trace_sha256"
        ]
        for number in {one["evaluation"] for one in counting}
    }
    assert traces == found
    again = drivora("campaign", "export", searched["id"], *options).json()
    assert (again["added"], again["known"]) == ([], len(added))


def test_decisions_are_the_history_of_the_suite(drivora: Drivora, suite: Path) -> None:
    assert drivora("suite", "run", suite).code == 1
    assert drivora("suite", "run", suite, "--select", "driving").code == 0
    # A shard by itself is not judged.
    drivora("suite", "run", suite, "--shard", "1/2")
    history = drivora("suite", "history", "three", "--json").json()
    assert [run["fails"] for run in history["runs"]] == [True, False]
    assert [run["pass_rate"]["mean"] for run in history["runs"]] == [pytest.approx(2 / 3), 1.0]
    first, last = (run["pass_rate"] for run in history["runs"])
    assert 0.0 < first["low"] < 2 / 3 < first["high"] < 1.0
    assert last["high"] == 1.0
    lines = {one["scenario"]: one["outcomes"] for one in history["scenarios"]}
    assert [o and o["state"] for o in lines["creeping"]] == ["fails_gate", None]
    assert [o["state"] for o in lines["wet-arterial"]] == ["passes", "passes"]
    failed = lines["creeping"][0]
    shown = drivora("runs", "show", failed["run_id"], "--json").json()
    assert any(one["outcome"] == "violated" for one in shown["verdicts"])
    assert failed["failures"][0].startswith("collision: ")
    printed = drivora("suite", "history", "three").out
    assert "67 % (" in printed
    assert "creeping" in printed
    assert "wet-arterial" not in printed, "it always passes"
    assert "three" in drivora("suite", "history").out
    nothing = drivora("suite", "history", "four")
    assert nothing.code == 2
    assert "known: three" in nothing.err
