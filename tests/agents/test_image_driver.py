"""The example of an ADS that takes images: it arrives, and drives the same in both processes."""

from __future__ import annotations

import runpy
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent
from drivora_service.agents.raster.raster_settings import Channel
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.testing.agent_contract import AgentContract
from tests.agents.driving import assert_stops_at_red, car_ahead, red_light_ahead
from tests.simulation.episodes import closest, network, run

EXAMPLE = Path(__file__).resolve().parents[2] / "deploy" / "image-agent"
NETWORKS = NetworkCatalogue(shipped_networks())


def driver_code() -> dict[str, Any]:
    return runpy.run_path(str(EXAMPLE / "image_driver.py"))


@pytest.fixture(scope="module")
def code() -> dict[str, Any]:
    return driver_code()


def seeds(town: str, count: int) -> Iterator[Scenario]:
    options: dict[str, Any] = {"min_length": 100.0, "max_length": 300.0, "seed": 7}
    for document in generate_seeds(network(town), count=count, agent="idm", **options):
        yield validate_document(document, NETWORKS, None).scenario


def assert_drives_well(trace: Trace) -> None:
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    verdicts = judge_all(trace, network(trace.network), default_oracles())
    assert not [f"{v.oracle}: {v.message}" for v in verdicts if v.outcome is Outcome.VIOLATED]


@pytest.mark.slow(seconds=20)
@pytest.mark.parametrize("town", ["tee-town", "signal-grid", "roundabout"])
def test_it_arrives_without_a_violation(code: dict[str, Any], town: str) -> None:
    for what in seeds(town, 2):
        assert_drives_well(run(what, code["ImageDriver"]()))


def test_it_stops_at_red_and_behind_a_standing_car(code: dict[str, Any]) -> None:
    assert_stops_at_red(run(red_light_ahead(), code["ImageDriver"]()))
    trace = run(car_ahead(0.0), code["ImageDriver"]())
    assert trace.ego_ends != (TerminalEvent.ARRIVED,)
    assert 5.0 < closest(trace, "ego", "npc") < 12.0


def test_it_uses_nothing_but_the_image_and_its_own_speed(code: dict[str, Any]) -> None:
    """Takes the rest of the observation from it."""
    only = code["ImageDriver"]()

    class Blindfolded:
        def setup_env(self, context: Any) -> None:
            self.raster = context.raster(code["SETTINGS"])
            only.setup_env(type("Context", (), {"raster": self.show, "log": context.log}))

        def show(self, settings: object) -> Any:
            assert settings == code["SETTINGS"]
            return type("Raster", (), {"draw": lambda _, seen, out: self.image})()

        def run_step(self, observation: Any) -> Any:
            self.image = self.raster.draw(observation)
            return only.run_step(type("Speed", (), {"speed": observation.speed}))

    what = car_ahead(2.0)
    assert trace_sha256(run(what, Blindfolded())) == trace_sha256(run(what, code["ImageDriver"]()))


@pytest.mark.slow
def test_it_drives_the_same_in_a_process_of_its_own(
    code: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(EXAMPLE, tmp_path / EXAMPLE.name)
    what = red_light_ahead()
    # Not in the test's own folder, whose path may be too long for a socket.
    with tempfile.TemporaryDirectory() as temporary:
        monkeypatch.setattr(tempfile, "tempdir", temporary)
        catalogue = AgentCatalogue(folder=tmp_path)
        try:
            catalogue.begin_run()
            agent = catalogue.create(EXAMPLE.name, {})
            assert not isinstance(agent, SumoDriver)
            there = run(what, agent)
        finally:
            catalogue.close()
    assert there.ego_ends == (TerminalEvent.ARRIVED,)
    assert trace_sha256(there) == trace_sha256(run(what, code["ImageDriver"]()))


class TestImageDriver(AgentContract):
    """The plug-in keeps the contract of agents."""

    def make_agent(self) -> Agent:
        made: Agent = plugin().create({})
        return made


def plugin() -> Any:
    sys.path.insert(0, str(EXAMPLE))
    try:
        return runpy.run_path(str(EXAMPLE / "image_plugin.py"))["PLUGIN"]
    finally:
        sys.path.remove(str(EXAMPLE))


def test_the_pages_show_the_code_of_the_example_and_all_channels() -> None:
    docs = EXAMPLE.parents[1] / "docs"
    page = (docs / "how-to" / "give-an-ads-an-image.md").read_text()
    source = (EXAMPLE / "image_driver.py").read_text()
    shown = [part.split("```")[0] for part in page.split("```python\n")[1:]]
    assert shown
    for lines in "\n".join(shown).splitlines():
        assert lines in source.splitlines() or lines == "…", lines
    reference = (docs / "reference" / "raster.md").read_text()
    assert [channel.name for channel in Channel if f"`{channel.name}`" not in reference] == []
