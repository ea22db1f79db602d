"""Candidates of a scenario space are checked as scenarios are, the seed's own routes once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.checks.placed_actors import place_actors
from drivora_service.scenario.checks.route_checks import check_route
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import NpcBehavior
from drivora_service.scenario.validation import scenario_problems
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_candidates import (
    ScenarioCandidates,
    make_cached_route_check,
)
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.simulation.followers.free_motion import plan_motions
from tests.search.space.seeds import NETWORKS, drawn, space_around

AGENTS = frozenset({"idm"})
TWO = SpaceOptions(vehicles=2, walkers=1)


def space_of_own_actors() -> ScenarioSpace:
    """A space around a seed that has five vehicles, a walker and an obstacle itself."""
    full = space_around("signal-grid", SpaceOptions(vehicles=5, walkers=1, obstacles=1))
    return ScenarioSpace(full.scenario(drawn(full, 1)), full.network, TWO)


def space_of_invalid_scenarios() -> ScenarioSpace:
    """A space around a seed of which one vehicle stands in another."""
    space = space_of_own_actors()
    first = space.seed.npc_vehicles[0]
    seed = replace(space.seed, npc_vehicles=(*space.seed.npc_vehicles, replace(first, id="twin")))
    return ScenarioSpace(seed, space.network, TWO)


SPACES: dict[str, Callable[[], ScenarioSpace]] = {
    "one ego": lambda: space_around("tee-town", SpaceOptions(vehicles=3, obstacles=1)),
    "egos": lambda: space_around("old-town", SpaceOptions(egos=4, vehicles=3, optional=True)),
    "own actors": space_of_own_actors,
    "invalid": space_of_invalid_scenarios,
}


@pytest.mark.parametrize("name", sorted(SPACES))
def test_what_is_remembered_changes_no_candidate(name: str) -> None:
    space = SPACES[name]()
    candidates = ScenarioCandidates(
        space=space, networks=NETWORKS, agents=AGENTS, motions=plan_motions
    )
    random = np.random.default_rng(5)
    for values in space.genes.sample(random, 6):
        # Like a child of an evolutionary tester: most actors are those of its parent.
        child = np.where(random.random(len(values)) < 0.1, space.genes.sample(random), values)
        for proposed in (values, child, values):
            candidate = candidates.prepare(proposed)
            scenario = space.scenario(space.repair(proposed))
            problems = scenario_problems(scenario, NETWORKS, AGENTS)
            assert candidate.problem == "; ".join(f"{p.pointer}: {p.message}" for p in problems)
            assert candidate.document == ("" if problems else canonical_json(scenario))
            assert bool(problems) is (name == "invalid")


def test_the_routes_of_the_seeds_own_actors_are_checked_once() -> None:
    space = space_of_own_actors()
    check = make_cached_route_check(space.seed)
    own, _ = place_actors(space.seed, FrameTransform())
    for number in range(3):
        actors, _ = place_actors(space.scenario(drawn(space, number)), FrameTransform())
        assert set(own) < set(actors)
        for actor in actors:
            answer = check(actor, space.network)
            assert answer == check_route(actor, space.network)
            assert (answer is check(actor, space.network)) is (actor in own)


def test_the_same_route_is_told_of_each_actor_by_its_own_place() -> None:
    space = space_of_own_actors()
    first, *others = space.seed.npc_vehicles
    short = replace(first, behavior=NpcBehavior.SUMO, route=first.route[:1])
    routes = make_cached_route_check(replace(space.seed, npc_vehicles=(short, *others)))
    for vehicles in ((short, *others), (*others, short)):
        scenario = replace(space.seed, npc_vehicles=vehicles)
        (problem,) = scenario_problems(scenario, NETWORKS, AGENTS, routes)
        assert problem.code == "too_short"
        assert problem.pointer == f"/npc_vehicles/{vehicles.index(short)}/route"
