from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import pytest
import typer
from typer.core import TyperGroup

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.main import app
from tests.cli.conftest import Drivora


def command_names(group: TyperGroup, prefix: str = "") -> Iterator[str]:
    """Yields the names of the commands of a group, with those of the groups around them."""
    for name, command in group.commands.items():
        if isinstance(command, TyperGroup):
            yield from command_names(command, f"{prefix}{name} ")
        else:
            yield f"{prefix}{name}"


COMMANDS = sorted(command_names(typer.main.get_group(app)))


def test_help_names_commands_and_exit_codes(drivora: Drivora) -> None:
    ended = drivora("--help")
    assert ended.code == 0
    assert "1 a gate failed" in ended.out
    assert all(name.partition(" ")[0] in ended.out for name in COMMANDS)


def test_help_loads_neither_simulator_nor_compiler() -> None:
    heavy = "{'numba', 'libsumo', 'matplotlib', 'fastapi', 'sqlalchemy', 'pyarrow', 'numpy'}"
    code = f"import sys, drivora_service.cli.main; print({heavy} & set(sys.modules))"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "set()"


def test_lists_and_runs_load_the_filters_of_motion_in_no_command() -> None:
    modules = (
        "cli.runs.file_running",
        "command_app",
        "oracles.built_in",
        "metrics.built_in_metrics",
        "feedback.catalogue",
    )
    imports = "; ".join(f"import drivora_service.{module}" for module in modules)
    code = f"import sys; {imports}; print('scipy.signal' in sys.modules)"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "False"


def test_every_command_is_in_the_reference(repository: Path) -> None:
    reference = (repository / "docs" / "reference" / "cli.md").read_text()
    assert {"run", "oracles list", "campaign compare", "agents benchmark"} <= {*COMMANDS}
    assert [name for name in COMMANDS if f"`drivora {name}" not in reference] == []


def test_version(drivora: Drivora) -> None:
    assert drivora("--version").out.strip() == version("drivora")


def test_a_wrong_setting_is_a_usage_error(drivora: Drivora) -> None:
    ended = drivora("networks", "list", DRIVORA_WORKERS="many")
    assert ended.code == 2
    assert "DRIVORA_WORKERS" in ended.err


def test_validate_names_every_problem_with_its_place(drivora: Drivora, tmp_path: Path) -> None:
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    good.write_text(json.dumps(SCENARIO))
    bad.write_text(json.dumps({**SCENARIO, "seed": -1, "surprise": 1}))
    ended = drivora("validate", good, bad, "--json")
    assert ended.code == 1
    first, second = ended.json()["results"]
    assert (first["valid"], second["valid"]) == (True, False)
    assert {p["pointer"] for p in second["problems"]} == {"/seed", "/surprise"}
    assert drivora("validate", good).code == 0
    assert "/surprise" in drivora("validate", bad).out


def test_a_service_validates_too(drivora: Drivora, tmp_path: Path, service_url: str) -> None:
    lost = tmp_path / "lost.json"
    lost.write_text(json.dumps({**SCENARIO, "map_region": {"town": "Town99"}}))
    ended = drivora("validate", lost, "--server", service_url, "--json")
    assert ended.code == 1
    assert ended.json()["results"][0]["problems"][0]["pointer"] == "/map_region/town"


@pytest.mark.parametrize("suffix", [".json", ".yaml"])
@pytest.mark.parametrize("served", [False, True])
def test_validate_names_mistakes_of_shape_and_place_together(
    drivora: Drivora, tmp_path: Path, service_url: str, suffix: str, served: bool
) -> None:
    lost = tmp_path / f"lost{suffix}"
    walker = {"id": "w", "model": "0001", "route": [{"x": 9e5, "y": 0.0}]}
    # JSON is YAML as well; with a comment it is nothing else.
    lost.write_text(f"# {suffix}\n" if suffix == ".yaml" else "")
    with lost.open("a") as file:
        file.write(json.dumps({**SCENARIO, "seed": -1, "npc_walkers": [walker]}))
    options = ["--server", service_url] if served else []
    (result,) = drivora("validate", lost, "--json", *options).json()["results"]
    assert [p["pointer"] for p in result["problems"]] == ["/seed", "/npc_walkers/0/route/0"]


def test_seeds_are_made_as_asked_and_the_same_again(drivora: Drivora, tmp_path: Path) -> None:
    asked = "seeds generate --num 3 --town tee-town --min-length 50 --max-length 200 --seed 1"
    for folder in ("a", "b"):
        ended = drivora(*asked.split(), "--out", tmp_path / folder, "--json")
        assert ended.code == 0, ended.err
    names = [f"tee-town_{number:04d}.json" for number in (1, 2, 3)]
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == names
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_seeds_that_do_not_exist_end_with_the_reason(drivora: Drivora, tmp_path: Path) -> None:
    options = "--num 2 --town tee-town --min-length 90000 --max-length 95000"
    ended = drivora("seeds", "generate", *options.split(), "--out", tmp_path / "s")
    assert ended.code == 3
    assert len(ended.err) > 20
    contradiction = "--num 2 --town tee-town --min-length 200 --max-length 100"
    assert drivora("seeds", "generate", *contradiction.split()).code == 2
    one = ("seeds", "generate", "--town", "tee-town", "--num", "1", "--out", tmp_path / "set")
    assert drivora(*one, "--agent-parameter", "speed_factor=0.8").code == 0
    (written,) = (tmp_path / "set").glob("*.json")
    (ego,) = json.loads(written.read_text())["ego_vehicles"]
    assert ego["agent"] == {"name": "idm", "parameters": {"speed_factor": 0.8}}
    for wrong, said in (("speed=1", "has no parameter 'speed'"), ("other:a=1", "have one ego")):
        refused = drivora(*one, "--agent-parameter", wrong)
        assert refused.code == 2
        assert said in refused.err
    assert drivora("seeds", "generate", "--town", "Nowhere").code == 2


def test_leaderboard_routes_become_seeds(
    drivora: Drivora, tmp_path: Path, shared_data: Path
) -> None:
    routes = sorted((shared_data / "routes").glob("leaderboard1_*.xml"))[0]
    ended = drivora("seeds", "import", routes, "--out", tmp_path / "s", "--json")
    assert ended.code == 0, ended.err
    assert len(ended.json()["files"]) >= 1


def test_networks_are_listed_shown_and_imported(
    drivora: Drivora, repository: Path, service_url: str
) -> None:
    source = repository / "sumo_nets" / "tee-town" / "tee-town.net.xml"
    assert "tee-town" in {one["name"] for one in drivora("networks", "list", "--json").json()}
    imported = drivora("networks", "import", source, "--name", "copy", "--json")
    assert imported.code == 0, imported.err
    assert imported.json() == drivora("networks", "show", "copy", "--json").json()
    assert "copy" in drivora("networks", "list").out.split()
    assert drivora("networks", "show", "Nowhere").code == 2
    there = drivora("networks", "show", "tee-town", "--server", service_url, "--json").json()
    assert there["sha256"] == imported.json()["sha256"]


def test_networks_are_imported_on_a_service(
    drivora: Drivora, repository: Path, service_url: str
) -> None:
    source = repository / "sumo_nets" / "tee-town" / "tee-town.net.xml"
    options = ("--name", "sent", "--server", service_url)
    sent = drivora("networks", "import", source, *options)
    assert sent.code == 0, sent.err
    assert sent.out == drivora("networks", "import", source, "--name", "sent").out
    assert "sent" in drivora("networks", "list", "--server", service_url).out.split()
    again = drivora("networks", "import", source, *options)
    assert (again.code, "'sent' is already imported; replace it" in again.err) == (3, True)
    assert drivora("networks", "import", source, *options, "--replace").code == 0
    here = drivora("networks", "import", source, *options, "--data-dir", "data")
    assert (here.code, "--data-dir is for work in this process" in here.err) == (2, True)
    missing = drivora("networks", "import", "none.osm", *options)
    assert (missing.code, "cannot read none.osm" in missing.err) == (3, True)


def test_agents(drivora: Drivora, service_url: str) -> None:
    here = drivora("agents", "list", "--json").json()
    there = drivora("agents", "list", "--server", service_url, "--json").json()
    assert [agent["name"] for agent in here] == [agent["name"] for agent in there]
    listed = drivora("agents", "list").out
    assert all(f"\n {agent['name']} " in listed for agent in here)
    assert "fop cannot be used yet: run `drivora agents install fop`" in listed
    shown = drivora("agents", "show", "idm")
    assert all(word in shown.out for word in ("speed_factor", "1.0", "from 0.1 to 2"))
    assert "takes no parameters" in drivora("agents", "show", "fop").out
    (idm,) = [agent for agent in there if agent["name"] == "idm"]
    assert drivora("agents", "show", "idm", "--server", service_url, "--json").json() == idm
    assert drivora("agents", "show", "nobody").code == 2


def test_agents_of_the_operator_and_their_installation(drivora: Drivora, tmp_path: Path) -> None:
    home = tmp_path / "mine" / "driver"
    home.mkdir(parents=True)
    (home / "agent.yaml").write_text(
        "{name: driver, kind: baseline, description: drives, source: here, licence: MIT,"
        " command: ['{python}']}"
    )
    (home / "requirements.txt").write_text("")
    folder = str(home.parent)
    listed = drivora("agents", "list", "--json", DRIVORA_AGENTS_DIR=folder).json()
    (entry,) = [agent for agent in listed if agent["name"] == "driver"]
    assert (entry["installed"], entry["reason"]) == (False, "run `drivora agents install driver`")
    assert "driver" not in {agent["name"] for agent in drivora("agents", "list", "--json").json()}
    installed = drivora("agents", "install", "driver", DRIVORA_AGENTS_DIR=folder)
    assert (installed.code, "installed driver" in installed.out) == (0, True), installed.err
    assert "licence: MIT" in installed.err
    again = drivora("agents", "install", "driver", DRIVORA_AGENTS_DIR=folder)
    assert "needs nothing more" in again.out
    assert drivora("agents", "install", "nobody").code == 2


def test_testers(drivora: Drivora, service_url: str) -> None:
    here = drivora("testers", "list", "--json").json()
    assert here == drivora("testers", "list", "--server", service_url, "--json").json()
    assert "random" in drivora("testers", "list").out
    shown = drivora("testers", "show", "avfuzzer")
    assert "population" in shown.out
    assert drivora("testers", "show", "avfuzzer", "--json").json() in here
    assert drivora("testers", "show", "nobody").code == 2


def test_oracles(drivora: Drivora, service_url: str) -> None:
    here = drivora("oracles", "list", "--json").json()
    assert here == drivora("oracles", "list", "--server", service_url, "--json").json()
    listed = drivora("oracles", "list").out
    assert [line.split()[0] for line in listed.splitlines() if " built in " in line] == [
        oracle["name"] for oracle in here
    ]
    shown = drivora("oracles", "show", "speeding")
    (speeding,) = [oracle for oracle in here if oracle["name"] == "speeding"]
    assert all(f" {key} " in shown.out for key in speeding["thresholds"])
    assert drivora("oracles", "show", "speeding", "--json").json() == speeding
    assert drivora("oracles", "show", "nothing").code == 2


def test_the_schemas_are_printed_and_checked(drivora: Drivora) -> None:
    assert drivora("schema").json()["title"].startswith("OpenScenario")
    assert drivora("schema", "campaign").json()["title"].startswith("Campaign")
    assert drivora("schema", "--check").code == 0
    assert drivora("schema", "--check", "--write").code == 2


def test_the_store_is_looked_after(drivora: Drivora, tmp_path: Path) -> None:
    assert drivora("store", "migrate", "--json").json()["schema"]
    assert drivora("store", "verify", "--json").json() == []
    assert drivora("store", "backup", tmp_path / "copy", "--json").json()["runs"] == 0
    assert drivora("store", "backup", tmp_path / "copy").code == 3
    assert drivora("store", "prune", "--older-than", "0", "--json").json()["runs"] == 0


def test_tokens_are_shown_once(drivora: Drivora) -> None:
    made = drivora("tokens", "create", "ci", "--scope", "read", "--json").json()
    assert made["token"].startswith("drv_")
    listed = drivora("tokens", "list", "--json")
    assert listed.json()[0]["name"] == "ci"
    assert made["token"] not in listed.out
    assert drivora("tokens", "create", "ci").code == 2
    assert drivora("tokens", "revoke", "ci").code == 0
    assert drivora("tokens", "revoke", "ci").code == 2


def test_a_service_beyond_loopback_needs_tokens(drivora: Drivora) -> None:
    ended = drivora("serve", "--host", "0.0.0.0", "--port", "0")
    assert ended.code == 2
    assert "drivora tokens create" in ended.err


@pytest.mark.slow
def test_the_demo_shows_the_whole_way(drivora: Drivora, tmp_path: Path) -> None:
    ended = drivora("demo", "--num", "4", "--simulations", "70")
    assert ended.code == 0, ended.err
    assert "4 of 4 runs judged" in ended.out
    assert "70 of 70 simulations" in ended.out
    failures = tmp_path / "demo-data" / "failures"
    scenario = next(failures.glob("0*.json"))
    assert scenario.with_suffix(".png").is_file()
    again = drivora("run", scenario, "--json").json()
    found = json.loads((failures / "campaign.json").read_text())["failures"]
    assert found[0]["verdict"] in again["verdicts"]
    assert (tmp_path / "demo-data" / "run.svg").is_file()
    assert not (tmp_path / "demo-data" / "service.json").exists()


_LAW = """\
laws:
  - name: never_fast
    title: Never fast
    source: nobody
    description: The ego is fast.
    severity: minor
    formula: always (speed < 2)
"""


def test_laws(drivora: Drivora, tmp_path: Path) -> None:
    folder = tmp_path / "laws"
    folder.mkdir()
    (folder / "own.yaml").write_text(_LAW)
    checked = drivora("laws", "check", str(folder / "own.yaml"))
    assert checked.code == 0
    assert "violated in 1 way:\n  1. speed >= 2\n" in checked.out
    told = drivora("laws", "check", str(folder / "own.yaml"), "--json").json()
    assert told["files"][0]["laws"][0]["sub_violations"] == ["speed >= 2"]

    settings = {"DRIVORA_LAWS_DIR": str(folder)}
    listed = drivora("laws", "list", "--json", **settings).json()
    assert listed["broken"] == []
    assert [law["name"] for law in listed["laws"]][-1] == "never_fast"
    assert "own.yaml" in drivora("laws", "list", **settings).out
    shown = drivora("oracles", "show", "never_fast", **settings).out
    assert "Formula: always (speed < 2)" in shown
    assert drivora("oracles", "show", "never_fast").code == 2

    wrong = folder / "wrong.yaml"
    wrong.write_text(_LAW.replace("never_fast", "other").replace("speed", "sped"))
    refused = drivora("laws", "check", str(wrong))
    assert refused.code == 1
    assert "wrong.yaml:7:22: unknown name 'sped'; did you mean 'speed'?" in refused.err
    told = drivora("laws", "check", str(wrong), "--json")
    assert told.code == 1
    assert told.json()["files"][0]["problems"][0]["code"] == "formula"
    assert "wrong.yaml cannot be used" in drivora("laws", "list", **settings).err
    listed = drivora("laws", "list", "--json", **settings).json()
    assert [one["file"] for one in listed["broken"]] == ["wrong.yaml"]
