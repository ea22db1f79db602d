"""Agents by name, built in and from installed packages."""

from __future__ import annotations

import importlib
import textwrap
from importlib.metadata import version
from pathlib import Path

import pytest

from drivora_service.agents.built_in_agents import BUILT_IN, FETCHED
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.entry import AgentKind
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.manifest_files import shipped_manifests
from drivora_service.agents.plugin import AgentPlugin, FetchedAgentPlugin
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError, UnknownName
from drivora_service.parameters import describe_parameters

PLUGIN = """
from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.interface import AccelerationControl
from drivora_service.agents.plugin import AgentPlugin


class Parked:
    def setup_env(self, context):
        self.context = context

    def run_step(self, observation):
        return AccelerationControl(-1.0, 0.0)


def create(parameters):
    return Parked()


plugin = AgentPlugin(
    entry=AgentEntry(
        name="parked", kind=AgentKind.BASELINE, description="stands", source="here", licence="MIT"
    ),
    create=create,
)
not_a_plugin = Parked
"""


@pytest.fixture
def installed_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A distribution that brings agents, as an installer would have left it."""
    (tmp_path / "parked_agents.py").write_text(textwrap.dedent(PLUGIN))
    info = tmp_path / "parked_agents-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: parked-agents\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[drivora_service.agents]\n"
        "parked = parked_agents:plugin\n"
        "broken = parked_agents:not_a_plugin\n"
        "gone = parked_agents_that_are_gone:plugin\n"
        "idm = parked_agents:plugin\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()


def test_the_built_in_agents_have_entries() -> None:
    catalogue = AgentCatalogue()
    names = {"idm", "idm-mobil", "pdm-closed"}
    names |= {"sumo-krauss", "sumo-idm", "sumo-eidm", "sumo-acc", "sumo-cacc"}
    assert names <= set(catalogue.names())
    assert list(catalogue.names()) == sorted(catalogue.names())
    for entry in catalogue.entries():
        assert entry.description
        assert entry.licence
    assert catalogue.entry("idm").kind is AgentKind.MODULE_BASED
    assert catalogue.entry("sumo-idm").privileged
    assert not catalogue.entry("idm").privileged


@pytest.mark.usefixtures("installed_package")
def test_only_code_of_packages_in_this_process_may_read_sumo() -> None:
    catalogue = AgentCatalogue()
    assert catalogue.may_read_sumo("parked")
    # Built in, even under the same name; SUMO's own driver; with a process of its own.
    for name in ("idm", "sumo-idm", "fop"):
        assert not catalogue.may_read_sumo(name)


def test_an_unknown_agent_is_named_with_those_that_are_known() -> None:
    for look_up in (AgentCatalogue().entry, lambda name: AgentCatalogue().create(name, {})):
        with pytest.raises(UnknownName, match=r"'autopilot'.*idm"):
            look_up("autopilot")


def test_each_call_makes_a_new_agent() -> None:
    catalogue = AgentCatalogue()
    one, two = catalogue.create("idm", {}), catalogue.create("idm", {"speed_factor": 0.8})
    assert isinstance(one, IdmAgent)
    assert one is not two
    assert isinstance(catalogue.create("sumo-krauss", {}), SumoDriver)


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("idm", {"speed": 1.0}),
        ("idm", {"speed_factor": "fast"}),
        ("idm", {"speed_factor": 3.0}),
        ("idm", {"speed_factor": float("nan")}),
        ("idm", {"speed_factor": True}),
        ("sumo-krauss", {"sigma": 0.0}),
        ("sumo-acc", {"lane_change_model": "DK2008"}),
    ],
)
def test_parameters_that_an_agent_does_not_take_are_refused(
    name: str, parameters: dict[str, object]
) -> None:
    with pytest.raises(AgentError) as failure:
        AgentCatalogue().create(name, parameters)
    assert failure.value.cause == "agent_parameters"
    assert f"'{name}'" in str(failure.value)


@pytest.mark.parametrize(
    ("name", "parameters", "model"),
    [
        ("idm", {}, ""),
        ("sumo-krauss", {}, "LC2013"),
        ("sumo-idm", {"lane_change_model": "SL2015"}, "SL2015"),
    ],
)
def test_only_sumos_drivers_need_a_lane_change_model(
    name: str, parameters: dict[str, object], model: str
) -> None:
    assert AgentCatalogue().availability().lane_change_model(name, parameters) == model


@pytest.mark.parametrize("plugin", [*BUILT_IN, *FETCHED], ids=lambda plugin: plugin.name)
def test_an_agent_that_drivora_brings_declares_its_parameters(
    plugin: AgentPlugin | FetchedAgentPlugin,
) -> None:
    assert plugin.parameters is not None
    described = describe_parameters(plugin.parameters)
    assert all(parameter.description for parameter in described)
    assert AgentCatalogue().parameters(plugin.name) == described
    usual = {parameter.name: parameter.default for parameter in described}
    assert AgentCatalogue().parameter_problems(plugin.name, usual) == ()
    (problem,) = AgentCatalogue().parameter_problems(plugin.name, {**usual, "colour": 1})
    assert problem.pointer == "/colour"
    assert plugin.name in problem.message


@pytest.mark.parametrize("name", shipped_manifests())
def test_the_adss_in_environments_of_their_own_declare_their_parameters(name: str) -> None:
    taken = {"dilu": ["examples"]}
    parameters = AgentCatalogue().parameters(name)
    assert parameters is not None
    assert [parameter.name for parameter in parameters] == taken.get(name, [])
    (problem,) = AgentCatalogue().parameter_problems(name, {"horizon": 3})
    assert ("it takes none" in problem.message) == (not parameters)


@pytest.mark.usefixtures("installed_package")
def test_an_agent_that_declares_nothing_takes_anything() -> None:
    catalogue = AgentCatalogue()
    assert catalogue.parameters("parked") is None
    assert catalogue.parameter_problems("parked", {"colour": "red"}) == ()
    # One that cannot be loaded says so in its entry.
    assert catalogue.parameter_problems("gone", {"colour": "red"}) == ()


@pytest.mark.usefixtures("installed_package")
def test_an_installed_package_brings_an_agent() -> None:
    catalogue = AgentCatalogue()
    assert "parked" in catalogue.names()
    assert catalogue.entry("parked").source == "here"
    agent = catalogue.create("parked", {})
    assert type(agent).__name__ == "Parked"


@pytest.mark.usefixtures("installed_package")
def test_a_package_does_not_replace_a_built_in_agent() -> None:
    assert isinstance(AgentCatalogue().create("idm", {}), IdmAgent)


@pytest.mark.usefixtures("installed_package")
def test_versions_are_those_of_the_packages() -> None:
    catalogue = AgentCatalogue()
    assert catalogue.entry("parked").version == "1.0"
    assert catalogue.versions("parked") == {"parked-agents": "1.0"}
    ours = {catalogue.entry(name).version for name in ("idm", "puffer-drive", "frenetix")}
    assert ours == {version("drivora")}
    for name in ("idm", "puffer-drive", "frenetix"):
        assert catalogue.versions(name) == {}


@pytest.mark.usefixtures("installed_package")
@pytest.mark.parametrize("name", ["broken", "gone"])
def test_a_broken_plug_in_is_reported_and_affects_no_other(name: str) -> None:
    catalogue = AgentCatalogue()
    entries = {entry.name: entry for entry in catalogue.entries()}
    assert not entries[name].installed
    assert entries[name].reason
    assert entries["parked"].installed
    with pytest.raises(AgentError) as failure:
        catalogue.create(name, {})
    assert failure.value.cause == "agent_plugin"
