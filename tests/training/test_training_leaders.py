"""Cars that training puts on an expert's way."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from drivora_service.simulation.plans.episode_plan import EpisodePlan
from drivora_service.training.training_courses import plans
from drivora_service.training.training_leaders import with_leaders
from tests.simulation.episodes import contacts, ego, network, place, scenario, speeds

PLAN = plan_episode(
    scenario(ego(place("harbour_0_0", 10), place("harbour_1_0", 110)), seconds=60.0), network()
)


@pytest.fixture(scope="module")
def with_cars() -> list[EpisodePlan]:
    random = np.random.default_rng(4)
    return [with_leaders(PLAN, random) for _ in range(30)]


def test_cars_drive_slowly_ahead_or_stand(with_cars: list[EpisodePlan]) -> None:
    found = {npc.id for plan in with_cars for npc in plan.scenario.npc_vehicles}
    assert found == {"leader", "standing"}
    start = PLAN.egos[0].ego.route[0]
    for plan in with_cars:
        for npc in plan.scenario.npc_vehicles:
            first = npc.route[0]
            assert np.hypot(first.x - start.x, first.y - start.y) > 12.0
            if npc.id == "leader":
                assert len(npc.route) >= 2
                assert all(0.0 < (waypoint.speed or 0.0) <= 6.0 for waypoint in npc.route)
            else:
                assert len(npc.route) == 1


def test_the_expert_follows_and_stops_behind_them(with_cars: list[EpisodePlan]) -> None:
    both = [plan for plan in with_cars if len(plan.scenario.npc_vehicles) == 2]
    episode = Episode(both[0], [IdmAgent()])
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert not contacts(trace)
    assert speeds(trace, "ego").max() > 5.0
    assert speeds(trace, "ego")[-1] < 0.1


def test_the_same_draws_give_the_same_cars() -> None:
    one, two = (
        [with_leaders(PLAN, random).scenario for _ in range(3)]
        for random in (np.random.default_rng(1), np.random.default_rng(1))
    )
    assert one == two


def test_a_way_that_is_too_short_stays_as_it_is() -> None:
    what = scenario(ego(place("harbour_0_0", 10), place("harbour_0_0", 30)), seconds=20.0)
    plan = plan_episode(what, network())
    assert with_leaders(plan, np.random.default_rng(1)) is plan


def test_most_runs_of_the_courses_have_them() -> None:
    networks = NetworkCatalogue(shipped_networks())
    found = list(plans(networks, runs=3, seed=5, crowding=0, leaders=True))
    assert sum(bool(plan.scenario.npc_vehicles) for plan in found) >= 0.6 * len(found)
