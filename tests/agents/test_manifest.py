"""Manifests of ADSs in processes of their own, and what is wrong with them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.entry import AgentKind
from drivora_service.agents.manifest import AgentDeadlines, command_line, read_manifest
from drivora_service.agents.manifest_files import operator_manifests, shipped_manifests
from drivora_service.errors import AgentError, UnknownName

GOOD: dict[str, Any] = {
    "name": "mine",
    "kind": "end-to-end",
    "description": "drives",
    "source": "here",
    "licence": "MIT",
    "command": ["{python}", "{folder}/drive.py", "--config={folder}/c.json", '{"a": 1}'],
}


def write(folder: Path, content: object, name: str = "mine") -> Path:
    path = folder / name / "agent.yaml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
    return path


def test_a_manifest_is_read(tmp_path: Path) -> None:
    more = {
        "variables": {"MODEL": "big"},
        "settings": ["DRIVORA_MINE_KEY"],
        "deadlines": {"step": 0.5},
    }
    path = write(tmp_path, {**GOOD, **more})
    manifest = read_manifest(path, "mine")
    assert (manifest.name, manifest.kind, manifest.licence) == ("mine", AgentKind.END_TO_END, "MIT")
    assert manifest.variables == (("MODEL", "big"),)
    assert manifest.settings == ("DRIVORA_MINE_KEY",)
    assert manifest.deadlines == AgentDeadlines(step=0.5)
    assert manifest.environment == "mine"
    assert command_line(manifest, Path("/python")) == [
        "/python",
        f"{path.parent}/drive.py",
        f"--config={path.parent}/c.json",
        '{"a": 1}',
    ]


@pytest.mark.parametrize("address", ["unix:/run/ads.sock", "localhost:50051", "[::1]:50051"])
def test_an_address_stands_in_for_a_command(tmp_path: Path, address: str) -> None:
    content = {key: value for key, value in GOOD.items() if key != "command"}
    manifest = read_manifest(write(tmp_path, {**content, "address": address}), "mine")
    assert (manifest.command, manifest.address) == ((), address)


@pytest.mark.parametrize(
    ("change", "place", "says"),
    [
        ({"name": "other"}, "/name", "'mine'"),
        ({"name": "../mine"}, "/name", "A-Z"),
        ({"kind": "magic"}, "/kind", "module-based"),
        ({"licence": None}, "/licence", ""),
        ({"version": 1.1}, "/version", "text"),
        ({"version": ""}, "/version", ""),
        ({"colour": "red"}, "/colour", ""),
        ({"command": "python drive.py"}, "/command", ""),
        ({"command": []}, "/", "neither"),
        ({"address": "localhost:1"}, "/", "both"),
        ({"command": [], "address": "http://host/"}, "/address", ""),
        ({"command": ["{home}/x"]}, "/command/0", "{python}, {folder}"),
        ({"variables": {"A": 1}}, "/variables/A", ""),
        ({"variables": {"DRIVORA_X": "1"}}, "/variables/DRIVORA_X", "Drivora's own"),
        ({"settings": ["HOME"]}, "/settings/0", "DRIVORA_"),
        ({"settings": "DRIVORA_MINE_KEY"}, "/settings", ""),
        ({"deadlines": {"step": 0}}, "/deadlines/step", ""),
        ({"deadlines": {"step": "fast"}}, "/deadlines/step", ""),
        ({"deadlines": {"think": 1}}, "/deadlines/think", ""),
        ({"variables": {"A=B": "c"}}, "/variables/A=B", ""),
        ({"parameters": {"lambda": {"type": "number"}}}, "/parameters/lambda", "word of Python"),
        (
            {"parameters": {"speed": {"type": "integer", "minimum": 0.5}}},
            "/parameters/speed",
            "whole numbers",
        ),
        (
            {"parameters": {"speed": {"type": "integer", "maximum": 1e30}}},
            "/parameters/speed",
            "whole numbers",
        ),
        ({"parameters": ["speed"]}, "/parameters", ""),
        ({"parameters": {"my speed": {"type": "number"}}}, "/parameters/my speed", ""),
        ({"parameters": {"speed": {"type": "float"}}}, "/parameters/speed/type", "'number'"),
        ({"parameters": {"speed": {}}}, "/parameters/speed/type", "missing"),
        (
            {"parameters": {"speed": {"type": "number", "minimum": 2, "maximum": 1}}},
            "/parameters/speed",
            "minimum 2 is above maximum 1",
        ),
        (
            {"parameters": {"speed": {"type": "text", "maximum": 1}}},
            "/parameters/speed",
            "are for numbers",
        ),
        (
            {"parameters": {"speed": {"type": "number", "choices": ["a"]}}},
            "/parameters/speed",
            "choices are texts",
        ),
        (
            {"parameters": {"speed": {"type": "number", "maximum": 1, "default": 2}}},
            "/parameters/speed",
            "default is 2; allowed: a number of at most 1",
        ),
    ],
)
def test_problems_are_named_with_their_place(
    tmp_path: Path, change: dict[str, object], place: str, says: str
) -> None:
    path = write(tmp_path, {**GOOD, **change})
    with pytest.raises(AgentError) as failure:
        read_manifest(path, "mine")
    assert failure.value.cause == "agent_manifest"
    assert str(path) in str(failure.value)
    assert f"{place}: " in str(failure.value)
    assert says in str(failure.value)


PARAMETERS = {
    "speed": {"type": "number", "minimum": 1, "maximum": 20, "default": 8, "description": "m/s"},
    "lanes": {"type": "integer", "minimum": 1},
    "cautious": {"type": "boolean", "default": False},
    "planner": {"type": "text", "choices": ["small", "large"], "default": "small"},
    "label": {"type": "text"},
}


def test_parameters_that_a_manifest_declares_are_checked(tmp_path: Path) -> None:
    write(tmp_path, {**GOOD, "parameters": PARAMETERS})
    catalogue = AgentCatalogue(folder=tmp_path)
    described = catalogue.parameters("mine")
    assert described is not None
    assert {(p.name, p.default, p.description) for p in described} == {
        ("speed", 8, "m/s"),
        ("lanes", None, ""),
        ("cautious", False, ""),
        ("planner", "small", ""),
        ("label", None, ""),
    }
    right = {"speed": 20, "lanes": 2, "cautious": True, "planner": "large", "label": ""}
    assert catalogue.parameter_problems("mine", right) == ()
    wrong = {"speed": 0.5, "lanes": 2.5, "cautious": 1, "planner": "huge", "label": 3, "sped": 1}
    problems = {p.pointer: p.message for p in catalogue.parameter_problems("mine", wrong)}
    assert set(problems) == {f"/{name}" for name in wrong}
    assert problems["/speed"] == "agent 'mine': speed is 0.5; allowed: a number from 1 to 20"
    assert problems["/lanes"].endswith("allowed: an integer of at least 1")
    assert problems["/planner"].endswith('allowed: "small", "large"')


def test_a_manifest_that_declares_no_parameters_leaves_them_to_the_ads(tmp_path: Path) -> None:
    write(tmp_path, GOOD)
    catalogue = AgentCatalogue(folder=tmp_path)
    assert catalogue.parameters("mine") is None
    assert catalogue.parameter_problems("mine", {"anything": {"goes": [1]}}) == ()
    write(tmp_path, {**GOOD, "parameters": {}})
    assert len(catalogue.parameter_problems("mine", {"anything": 1})) == 1


@pytest.mark.parametrize("text", ["- a list", "a: [", "", "!!python/object:os.system {}"])
def test_a_file_that_is_no_manifest_is_told_of(tmp_path: Path, text: str) -> None:
    with pytest.raises(AgentError, match=r"agent\.yaml cannot be used"):
        read_manifest(write(tmp_path, text), "mine")


def test_an_operators_agents_are_found_while_the_catalogue_lives(tmp_path: Path) -> None:
    catalogue = AgentCatalogue(folder=tmp_path)
    assert "mine" not in catalogue.names()
    with pytest.raises(UnknownName, match="mine"):
        catalogue.entry("mine")
    write(tmp_path, GOOD)
    entry = catalogue.entry("mine")
    assert "mine" in catalogue.names()
    assert (entry.kind, entry.installed, entry.privileged) == (AgentKind.END_TO_END, True, False)
    assert catalogue.availability()["mine"] == ""


def test_a_version_is_known_where_the_manifest_tells_it(tmp_path: Path) -> None:
    catalogue = AgentCatalogue(folder=tmp_path)
    write(tmp_path, GOOD)
    assert (catalogue.entry("mine").version, catalogue.versions("mine")) == ("", {})
    write(tmp_path, {**GOOD, "version": "1.10"})
    assert catalogue.entry("mine").version == "1.10"
    assert catalogue.versions("mine") == {"mine": "1.10"}


def test_a_broken_manifest_spoils_only_its_own_agent(tmp_path: Path) -> None:
    write(tmp_path, {**GOOD, "kind": "magic"})
    write(tmp_path, {**GOOD, "name": "fine"}, name="fine")
    catalogue = AgentCatalogue(folder=tmp_path)
    broken = catalogue.entry("mine")
    assert not broken.installed
    assert "/kind" in broken.reason
    assert catalogue.entry("fine").installed
    with pytest.raises(AgentError, match="/kind"):
        catalogue.create("mine", {})


def test_a_manifest_does_not_replace_a_built_in_agent(tmp_path: Path) -> None:
    write(tmp_path, {**GOOD, "name": "idm"}, name="idm")
    catalogue = AgentCatalogue(folder=tmp_path)
    assert catalogue.entry("idm").kind is AgentKind.MODULE_BASED


def test_folders_whose_names_no_document_may_name_are_left_out(tmp_path: Path) -> None:
    write(tmp_path, GOOD, name="no name")
    write(tmp_path, GOOD)
    assert list(operator_manifests(tmp_path)) == ["mine"]
    assert operator_manifests(tmp_path / "nowhere") == {}
    assert operator_manifests(None) == {}


def test_the_shipped_manifests_are_good() -> None:
    shipped = shipped_manifests()
    wanted = {"fiss-plus", "fop", "frenetix", "commonroad-rp", "dilu", "smarts-iamp"}
    assert wanted <= set(shipped)
    for name, path in shipped.items():
        manifest = read_manifest(path, name)
        assert manifest.licence
        assert (path.parent / "requirements.txt").is_file()
