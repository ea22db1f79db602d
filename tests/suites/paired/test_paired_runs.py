from __future__ import annotations

import copy
import json
from dataclasses import replace

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import AgentChoice, Scenario
from drivora_service.scenario.validation import validate_data
from drivora_service.suites.paired.paired_runs import read_driven_scenario


def scenario() -> Scenario:
    networks = NetworkCatalogue(shipped_networks())
    return validate_data(json.dumps(copy.deepcopy(SCENARIO)).encode(), networks, None).scenario


def test_agents_seeds_and_extensions_do_not_make_another_scenario() -> None:
    first = scenario()
    known = read_driven_scenario(canonical_json(first))
    assert (known.seed, known.town) == (1, "tee-town")
    (ego,) = first.ego_vehicles
    other = AgentChoice(name="sumo-krauss", parameters={"sigma": 0.5})
    changed = replace(
        first,
        ego_vehicles=(replace(ego, agent=other),),
        seed=7,
        extensions={"of": {"another": "tool"}},
    )
    again = read_driven_scenario(canonical_json(changed))
    assert (again.content, again.seed) == (known.content, 7)


def test_everything_else_makes_another_scenario() -> None:
    first = scenario()
    known = read_driven_scenario(canonical_json(first)).content
    (ego,) = first.ego_vehicles
    for changed in (
        replace(first, ego_vehicles=(replace(ego, initial_speed=1.0),)),
        replace(first, weather=replace(first.weather, wetness=50.0)),
        replace(first, max_sim_time=20.0),
    ):
        assert read_driven_scenario(canonical_json(changed)).content != known
