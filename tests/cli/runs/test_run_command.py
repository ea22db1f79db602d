from __future__ import annotations

import json
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.exporting import document_content
from tests.cli.conftest import Drivora
from tests.simulation.test_jumping import beside_a_truck

EXAMPLES = Path(__file__).parents[3] / "openscenario_schemas" / "examples"
PROMISED = {
    "status",
    "verdicts",
    "metrics",
    "scores",
    "trace_sha256",
    "steps",
    "sim_time_s",
    "wall_time_s",
    "step_cost_us",
    "agent_cost_us",
    "agents",
    "privileged",
}


def test_one_scenario_prints_one_object_and_leaves_its_trace(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    ended = drivora(
        "run", scenario_file, "--agent", "sumo-idm", "--seed", "3", "--out", out, "--json"
    )
    assert ended.code == 0, ended.err
    result = ended.json()
    assert set(result) >= PROMISED
    assert result["status"] == "finished"
    # It is SUMO that drives, which sees everything.
    assert result["privileged"] == [verdict["ego"] for verdict in result["verdicts"][:1]]
    trace = read_trace(out / "crossing.trace.parquet")
    assert trace_sha256(trace) == result["trace_sha256"]
    assert trace.step_count == result["steps"]
    assert json.loads((out / "crossing.report.json").read_text()) == result


def test_parameters_of_agents_are_set_and_kept_with_the_trace(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    setting = ("--agent-parameter", "speed_factor=0.5", "--agent-parameter", "ego:speed_factor=0.6")
    ended = drivora("run", scenario_file, *setting, "--out", out, "--json")
    assert ended.code == 0, ended.err
    agents = {"ego": {"name": "idm", "parameters": {"speed_factor": 0.6, "reaction_time": 0.0}}}
    assert ended.json()["agents"] == agents
    assert read_trace(out / "crossing.trace.parquet").meta["agents"] == agents
    usual = drivora("run", scenario_file, "--json").json()
    default = {"speed_factor": 1.0, "reaction_time": 0.0}
    assert usual["agents"] == {"ego": {"name": "idm", "parameters": default}}
    assert usual["sim_time_s"] < ended.json()["sim_time_s"]

    wrong = drivora("run", scenario_file, "--agent-parameter", "speed=1", "--json")
    assert wrong.code == 3
    (problem,) = wrong.json()["error"]["problems"]
    assert problem["pointer"] == "/ego_vehicles/0/agent/parameters/speed"
    malformed = drivora("run", scenario_file, "--agent-parameter", "speed")
    assert malformed.code == 2
    assert "allowed: NAME=VALUE" in " ".join(malformed.err.split())


def test_a_verdict_without_anything_to_judge_is_a_dash_with_its_reason(
    drivora: Drivora, scenario_file: Path
) -> None:
    ended = drivora("run", scenario_file)
    (line,) = (line for line in ended.out.splitlines() if line.split()[:1] == ["deadlock"])
    assert line.split()[2] == "-"
    assert "The run has no other ego to wait for." in " ".join(ended.out.split())
    verdicts = drivora("run", scenario_file, "--json").json()["verdicts"]
    (verdict,) = (verdict for verdict in verdicts if verdict["oracle"] == "deadlock")
    assert verdict["outcome"] == "not_applicable"


def test_a_folder_is_a_batch_in_which_broken_files_harm_no_run(
    drivora: Drivora, tmp_path: Path
) -> None:
    folder = tmp_path / "scenarios"
    folder.mkdir()
    (folder / "good.json").write_text(json.dumps(SCENARIO))
    (folder / "lost.json").write_text(json.dumps({**SCENARIO, "map_region": {"town": "Town99"}}))
    (folder / "broken.json").write_text("{")
    ended = drivora("run", folder, "--workers", "2", "--json")
    assert ended.code == 3
    statuses = {run["scenario"]: run["status"] for run in ended.json()["runs"]}
    assert statuses["good"] == "finished"
    assert sorted(statuses.values()) == ["finished", "invalid", "invalid"]
    lost = next(run for run in ended.json()["runs"] if run["scenario"] == "lost")
    assert lost["error"]["problems"][0]["pointer"] == "/map_region/town"
    (stored,) = drivora("runs", "list", "--json").json()
    assert stored["label"] == "good"


def test_a_gate_fails_on_a_violated_oracle(drivora: Drivora, tmp_path: Path) -> None:
    x, y = 3.01, 104.32
    hit = {
        **SCENARIO,
        "npc_obstacles": [
            {"id": "stone", "model": "static.prop.container", "location": {"x": x, "y": y - 20}}
        ],
    }
    hit["ego_vehicles"] = [{**SCENARIO["ego_vehicles"][0], "agent": {"name": "sumo-idm"}}]
    path = tmp_path / "hit.json"
    path.write_text(json.dumps({**hit, "max_sim_time": 5.0}))
    ended = drivora("run", path, "--gate", "--json")
    violated = [v for v in ended.json()["verdicts"] if v["outcome"] == "violated"]
    assert violated
    assert ended.code == 1
    assert "gate failed: 1 failing run" in ended.err
    oracle = next(v["oracle"] for v in violated if v["severity"] != "observation")
    assert drivora("run", path, "--gate-oracle", f"{oracle}=1").code == 0
    assert drivora("run", path, "--gate-oracle", oracle).code == 1
    refused = drivora("run", path, "--gate-oracle", "sleeping")
    assert refused.code == 2
    assert "no oracle 'sleeping'" in refused.err


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["nope.json"], 2, "there is no file"),
        (["crossing.json", "--agent", "nobody"], 2, ", idm, "),
        (["crossing.json", "--seed", "-1"], 2, "--seed"),
        ([], 2, "Missing argument"),
        (["crossing.json", "--server", "http://127.0.0.1:9"], 3, "does not answer"),
    ],
)
def test_exit_codes(
    drivora: Drivora, scenario_file: Path, arguments: list[str], code: int, said: str
) -> None:
    ended = drivora("run", *arguments)
    assert ended.code == code
    assert said in ended.err


def test_a_table_for_people(drivora: Drivora, scenario_file: Path) -> None:
    ended = drivora("run", scenario_file, "--data-dir", "elsewhere")
    assert ended.code == 0, ended.err
    assert "crossing" in ended.out
    assert "collision" in ended.out
    hint = next(line for line in ended.out.splitlines() if line.startswith("Draw it: drivora "))
    assert drivora(*hint.removeprefix("Draw it: drivora ").split()).code == 0


def test_a_service_gives_the_same_run(
    drivora: Drivora, scenario_file: Path, tmp_path: Path, service_url: str
) -> None:
    here = drivora("run", scenario_file, "--json").json()
    out = tmp_path / "out"
    there = drivora("run", scenario_file, "--server", service_url, "--out", out, "--json").json()
    assert there["trace_sha256"] == here["trace_sha256"]
    assert there["label"] == here["label"] == "crossing"
    assert set(there) >= PROMISED
    picture = tmp_path / "run.svg"
    drawn = drivora("plot", there["id"], "--server", service_url, "--out", picture)
    assert drawn.code == 0, drawn.err
    assert picture.read_text().startswith("<?xml")
    plain = drivora("plot", out / "crossing.trace.parquet", "--out", tmp_path / "run.png")
    assert plain.code == 0, plain.err


def test_a_picture_marks_the_oracles_that_are_asked_for(drivora: Drivora, tmp_path: Path) -> None:
    assert drivora("run", EXAMPLES / "walker-behind-van.json", "--out", tmp_path).code == 0

    def picture(*oracles: str) -> bytes:
        options = [part for oracle in oracles for part in ("--oracle", oracle)]
        trace, target = tmp_path / "walker-behind-van.trace.parquet", tmp_path / "run.svg"
        drawn = drivora("plot", trace, "--out", target, *options)
        assert drawn.code == 0, drawn.err
        return target.read_bytes()

    everything, both, one = picture(), picture("collision", "destination"), picture("collision")
    assert len(everything) > len(both) > len(one) > len(picture("red_light"))
    trace = tmp_path / "walker-behind-van.trace.parquet"
    strip = tmp_path / "strip.svg"
    assert drivora("plot", trace, "--moments", "4", "--out", strip).code == 0
    assert "<svg" in strip.read_text()
    mixed = drivora("plot", trace, "--moments", "4", "--color-by", "time", "--out", strip)
    assert mixed.code == 2
    assert "leave it out with --moments" in mixed.err
    wrong = drivora("plot", tmp_path / "walker-behind-van.trace.parquet", "--oracle", "crash")
    assert wrong.code == 2
    assert "collision" in wrong.err


def test_a_service_names_the_problems_of_each_scenario(
    drivora: Drivora, tmp_path: Path, service_url: str
) -> None:
    path = tmp_path / "lost.json"
    path.write_text(json.dumps({**SCENARIO, "map_region": {"town": "Town99"}}))
    ended = drivora("run", path, "--server", service_url, "--json")
    assert ended.code == 3
    assert ended.json()["error"]["problems"][0]["pointer"] == "/map_region/town"


def test_a_run_that_the_simulator_spoilt_says_so(drivora: Drivora, tmp_path: Path) -> None:
    file = tmp_path / "jump.json"
    file.write_text(json.dumps(document_content(beside_a_truck(1.4))))
    ended = drivora("run", file, "--out", tmp_path / "out")
    assert ended.code == 0, ended.err
    told = " ".join(ended.out.split())
    assert "spoilt by" in told
    assert "jump: ego: Artefact of the simulation at 0.35 s, not the ego's fault: truck" in told
    again = drivora("run", file, "--out", tmp_path / "out", "--json").json()
    assert not [verdict for verdict in again["verdicts"] if verdict["outcome"] == "violated"]
    assert again["metrics"]["driving_score"] is None


def test_a_speed_in_another_unit_is_noted_and_driven(
    drivora: Drivora, scenario_file: Path, tmp_path: Path
) -> None:
    content = json.loads(scenario_file.read_text("utf-8"))
    content["ego_vehicles"][0]["initial_speed"] = 50.0
    fast = tmp_path / "fast.json"
    fast.write_text(json.dumps(content), encoding="utf-8")
    ended = drivora("run", fast)
    assert ended.code == 0, ended.err
    assert "fast: note: /ego_vehicles/0/initial_speed: ego 'ego' starts at 50 m/s (180" in ended.err
    assert "speeds are in m/s" not in ended.out
