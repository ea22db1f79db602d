"""The examples that users copy from the how-tos, on three road networks.

That they can be installed and run is shown by `test_commands.py`; here, that an agent drives, an
oracle and a law judge, and a method searches, on roads that the page does not name.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
import math
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import yaml

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.search.engine import Engine
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.laws.law_judging import LawOracle
from drivora_service.oracles.laws.law_reading import read_laws
from drivora_service.oracles.laws.sources import LawSource
from drivora_service.oracles.verdict import Oracle, Outcome
from drivora_service.scenario.documents import ScenarioDocument, document_text
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, NpcWalker, Scenario, Waypoint
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_data
from drivora_service.search.catalogue import BUILT_IN, TesterCatalogue
from drivora_service.simulation.planning import plan_episode
from drivora_service.worker.setup import WorkerSetup
from tests.agents.driving import assert_stops_at_red, car_ahead, red_light_ahead
from tests.simulation.episodes import CAR, WALKER, Blind, network, run, travelled

_ROOT = Path(__file__).resolve().parents[2]
_HOW_TO = _ROOT / "docs" / "how-to"
NETWORKS = ("roundabout", "tee-town", "old-town")
KNOWN_FLAWS = {"discomfort"}
"""Oracles that the example agents may violate on an empty road: they brake at once."""


def file_of(page: str, name: str) -> str:
    """Returns the text of a file that a page shows."""
    text = (_HOW_TO / page).read_text()
    block = re.search(rf"<!-- file: {re.escape(name)} -->\n```\w+\n(.*?)^```$", text, re.S | re.M)
    assert block, f"{page} shows {name}"
    return block[1]


@pytest.fixture
def example(tmp_path: Path) -> Iterator[Callable[[str, str], ModuleType]]:
    """Imports a module as a page shows it."""
    imported = []

    def load(page: str, name: str) -> ModuleType:
        path = tmp_path / Path(name).name
        path.write_text(file_of(page, name))
        spec = importlib.util.spec_from_file_location(path.stem, path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[path.stem] = module
        imported.append(path.stem)
        spec.loader.exec_module(module)
        return module

    yield load
    for name in set(imported):
        del sys.modules[name]


def careful(example: Callable[[str, str], ModuleType]) -> Agent:
    plugin = example("add-an-agent.md", "careful/careful_driver.py").PLUGIN
    agent: Agent = plugin.create({})
    return agent


def seeds(town: str, count: int = 4) -> Iterator[ScenarioDocument]:
    """The routes that ``drivora seeds generate --seed 3`` generates."""
    return generate_seeds(
        network(town), count=count, min_length=50, max_length=200, seed=3, agent="idm"
    )


def scenario_of(document: ScenarioDocument) -> Scenario:
    networks = NetworkCatalogue(shipped_networks())
    return validate_data(document_text(document).encode(), networks, None).scenario


def assert_drives(trace: Trace) -> None:
    """Asserts that the ego arrived, moved by itself, and did nothing wrong but the known flaws."""
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert travelled(trace, "ego_0") > 40.0
    broken = {
        verdict.oracle: verdict.message
        for verdict in judge_all(trace, network(trace.network), default_oracles())
        if verdict.outcome is Outcome.VIOLATED and verdict.oracle not in KNOWN_FLAWS
    }
    assert broken == {}


@pytest.mark.parametrize("town", NETWORKS)
def test_the_agent_drives_the_seeds_of_the_next_page(
    town: str, example: Callable[[str, str], ModuleType]
) -> None:
    driver = careful(example)
    for document in seeds(town):
        assert_drives(run(scenario_of(document), driver))


@pytest.mark.parametrize("town", NETWORKS)
def test_the_agent_in_a_process_of_its_own_drives_them_too(town: str, tmp_path: Path) -> None:
    shutil.copytree(_ROOT / "deploy" / "external-agent", tmp_path / "external-agent")
    (document,) = seeds(town, 1)
    with contextlib.closing(AgentCatalogue(folder=tmp_path)) as catalogue:
        driver = catalogue.create("external-agent", {})
        assert not isinstance(driver, SumoDriver)
        assert_drives(run(scenario_of(document), driver))


def test_the_agent_stops_for_red_lights_and_cars(
    example: Callable[[str, str], ModuleType],
) -> None:
    assert_stops_at_red(run(red_light_ahead(), careful(example)))
    for speed in (0.0, 3.0):
        trace = run(car_ahead(speed), careful(example))
        assert not trace.contacts
        assert speed > 0.0 or trace.ego_ends != (TerminalEvent.ARRIVED,)


def on_route(scenario: Scenario, s: float, left: float = 0.0) -> Waypoint:
    """Returns the place ``s`` metres along the ego's route, ``left`` metres beside its middle."""
    route = plan_episode(scenario, network(scenario.map_region.town)).egos[0].route
    (x, y), (ahead_x, ahead_y) = (
        [np.interp(arc, route.arc, line) for line in route.line.T] for arc in (s, s + 1.0)
    )
    yaw = math.atan2(ahead_y - y, ahead_x - x)
    return Waypoint(x=float(x - left * math.sin(yaw)), y=float(y + left * math.cos(yaw)))


@pytest.mark.parametrize("town", NETWORKS)
def test_the_oracle_judges_the_gap_to_walkers(
    town: str, example: Callable[[str, str], ModuleType]
) -> None:
    oracle = example("write-an-oracle.md", "gap/walker_gap.py").WalkerGap()
    (document,) = seeds(town, 1)
    driver = careful(example)
    assert judged_by(oracle, run(scenario_of(document), driver)) is Outcome.NOT_APPLICABLE
    for left, outcome in ((3.0, Outcome.PASSED), (1.9, Outcome.VIOLATED)):
        scenario = scenario_of(document)
        walker = NpcWalker(id="stands", model=WALKER, route=(on_route(scenario, 30.0, left),))
        trace = run(replace(scenario, npc_walkers=(walker,)), driver)
        assert judged_by(oracle, trace) is outcome, left


@pytest.mark.parametrize("town", NETWORKS)
def test_the_law_judges_the_distance_to_the_vehicle_ahead(town: str) -> None:
    text = file_of("write-a-traffic-law.md", "laws/following.yaml")
    (law,) = read_laws(LawSource(file="following.yaml", data=text.encode()))
    (document,) = seeds(town, 1)
    assert judged_by(LawOracle(law=law), run(scenario_of(document), Blind(8.0))) is Outcome.PASSED
    for ahead, outcome in ((12.0, Outcome.VIOLATED), (25.0, Outcome.PASSED)):
        scenario = scenario_of(document)
        (ego,) = scenario.ego_vehicles
        moving = replace(ego, initial_speed=8.0)
        length = plan_episode(scenario, network(town)).egos[0].route.length
        places = (on_route(scenario, s) for s in np.arange(ahead, length - 3.0, 5.0))
        car = NpcVehicle(
            id="ahead",
            model=CAR,
            route=tuple(replace(place, speed=8.0) for place in places),
            behavior=NpcBehavior.REPLAY,
        )
        trace = run(replace(scenario, ego_vehicles=(moving,), npc_vehicles=(car,)), Blind(8.0))
        assert judged_by(LawOracle(law=law), trace) is outcome, ahead


def judged_by(oracle: Oracle, trace: Trace) -> Outcome:
    (verdict,) = oracle.judge(RunView(trace, network(trace.network)))
    return verdict.outcome


@pytest.mark.slow
@pytest.mark.parametrize("town", NETWORKS)
def test_the_method_varies_the_candidate_with_the_least_gap(
    town: str, example: Callable[[str, str], ModuleType], tmp_path: Path
) -> None:
    climber = example("write-a-tester.md", "climber/hill_climber.py").CLIMBER
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    catalogues.testers = TesterCatalogue((*BUILT_IN, climber))
    (document,) = seeds(town, 1)
    campaign = yaml.safe_load(file_of("write-a-tester.md", "climb.yaml"))
    campaign["scenario"] = json.loads(document_text(document))
    valid = read_campaign(campaign, catalogues)
    journal = MemoryJournal()
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with LocalExecutor(slots=2, setup=setup, folder=tmp_path) as executor:
        search = prepare_search(valid, catalogues, run_prefix=town)
        Engine(search, LocalEvaluator(executor), journal).run()
    evaluations = tuple(journal.evaluations())
    assert len(evaluations) == 12
    least: dict[int, float] = {}
    for one in evaluations:
        generation = one.proposal.generation
        before = {n: gap for n, gap in least.items() if n < 4 * generation}
        nearest = (min(before, key=before.__getitem__),) if before else ()
        assert one.proposal.parents == nearest, "each generation varies the nearest candidate"
        gap = one.report.scores["min_gap"]
        if gap is not None:
            least[one.number] = gap
    assert len(least) == 12
