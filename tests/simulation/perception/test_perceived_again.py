"""What is computed again from a recording is what the agents got in the run."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent, AgentContext, Control, Observation
from drivora_service.errors import Conflict
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, Trace
from drivora_service.observations.trace_files.trace_file import read_trace, write_trace
from drivora_service.scenario.model import BackgroundTraffic, Scenario, Weather
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.perception.ego_perception import Sense, Sight
from drivora_service.simulation.perception.perceived_again import Perceived, perceive_again
from drivora_service.simulation.planning import plan_episode
from tests.simulation.episodes import ROAD, car, ego, network, obstacle, place, scenario, walker

FOG = Weather(fog_density=85.0, fog_distance=10.0, sun_altitude_angle=-10.0)


@dataclass
class Witness:
    """Passes everything on to an agent, and keeps what it got: steps, rows and states."""

    agent: Agent
    got: dict[int, tuple[NDArray[np.int64], NDArray[np.float64]]] = field(default_factory=dict)

    def setup_env(self, context: AgentContext) -> None:
        self.agent.setup_env(context)

    def run_step(self, observation: Observation) -> Control:
        self.got[observation.step] = (observation.object_ids.copy(), observation.objects.copy())
        return self.agent.run_step(observation)


def several_egos(weather: Weather) -> Scenario:
    """Two egos, one of them late, among vehicles, a walker, an obstacle and background traffic."""
    return scenario(
        ego(place(ROAD, 5), place(ROAD, 110), initial_speed=6.0),
        ego(place("-north_2_0", 10), place("-north_2_0", 120), name="late", start_time=2.0),
        npc_vehicles=(
            car(place(ROAD, 30, speed=5.0), place(ROAD, 120, speed=5.0), name="ahead"),
            car(
                place("harbour_0_0", 60, speed=8.0), place(ROAD, 120, speed=8.0),
                name="driven", behavior="sumo", start_time=1.0,
            ),
        ),
        npc_walkers=(walker(place(ROAD, 90, right=6.0, speed=1.5), place(ROAD, 90, right=-6.0)),),
        npc_obstacles=(obstacle(place(ROAD, 100, right=4.0), start_time=3.0),),
        background_traffic=BackgroundTraffic(count=8),
        weather=weather,
        seconds=12.0,
        seed=11,
    )  # fmt: skip


def recorded(
    what: Scenario, path: Path, privileged: tuple[bool, ...] = (False, False)
) -> tuple[Trace, list[Witness]]:
    """Runs an episode of `idm` agents, and reads its trace from a file."""
    catalogue = AgentCatalogue()
    witnesses = []
    for one in what.ego_vehicles:
        agent = catalogue.create("idm", one.agent.parameters)
        witnesses.append(Witness(agent))  # type: ignore[arg-type]  # idm is not one of SUMO's
    episode = Episode(
        plan_episode(what, network(what.map_region.town)), witnesses, privileged=privileged
    )
    while not episode.done:
        episode.step()
    write_trace(episode.finish(), path)
    return read_trace(path), witnesses


def check(found: Perceived, witness: Witness) -> None:
    """Compares every step, bit for bit."""
    steps = range(found.first, found.first + len(found.sights))
    assert list(witness.got) == list(steps)
    for k, step in enumerate(steps):
        rows, states = witness.got[step]
        assert np.flatnonzero(found.sights[k] == Sight.PERCEIVED).tolist() == rows.tolist()
        np.testing.assert_array_equal(found.states[k, rows], states)
        others = np.delete(np.arange(len(found.sights[k])), rows)
        assert np.isnan(found.states[k, others]).all()


@pytest.mark.parametrize("weather", [Weather(), FOG], ids=["clear", "fog"])
def test_perception_computed_again_is_what_the_agents_got(weather: Weather, tmp_path: Path) -> None:
    what = several_egos(weather)
    trace, witnesses = recorded(what, tmp_path / "run.parquet")
    sights = set()
    for row, witness in enumerate(witnesses):
        view = EgoView(trace, network(), row)
        found = perceive_again(what, view)
        assert len(found.sights) > 100
        check(found, witness)
        sights |= set(np.unique(found.sights).tolist())
    missed = {Sight.OUT_OF_RANGE} if weather == Weather() else {Sight.DROPPED, Sight.OUT_OF_RANGE}
    assert sights >= {int(sight) for sight in missed | {Sight.PERCEIVED, Sight.ABSENT}}


def test_the_seed_of_the_run_counts_and_another_one_is_another_perception(tmp_path: Path) -> None:
    what = several_egos(FOG)
    trace, (witness, _) = recorded(what, tmp_path / "run.parquet")
    view = EgoView(trace, network(), 0)
    check(perceive_again(replace(what, seed=99), view), witness)
    trace.meta["seed"] = 99
    with pytest.raises(AssertionError):
        check(perceive_again(what, view), witness)


def test_a_privileged_agent_gets_all_as_it_is(tmp_path: Path) -> None:
    what = several_egos(FOG)
    trace, (witness, late) = recorded(what, tmp_path / "run.parquet", privileged=(True, False))
    found = perceive_again(what, EgoView(trace, network(), 0))
    check(found, witness)
    assert np.isinf(found.senses[Sense.RANGE])
    there = trace.present[: len(found.sights)].copy()
    there[:, 0] = False
    np.testing.assert_array_equal(found.sights == Sight.PERCEIVED, there)
    check(perceive_again(what, EgoView(trace, network(), 1)), late)


def test_latency_and_noise_show_where_an_actor_was(tmp_path: Path) -> None:
    what = several_egos(FOG)
    trace, _ = recorded(what, tmp_path / "run.parquet")
    found = perceive_again(what, EgoView(trace, network(), 0))
    lag = int(found.senses[Sense.LAG])
    assert lag > 0
    k = np.flatnonzero(found.sights[lag:, 2] == Sight.PERCEIVED) + lag
    assert len(k) > 20
    errors = found.states[k, 2][:, [Col.X, Col.Y]] - trace.states[k - lag, 2][:, [Col.X, Col.Y]]
    assert errors.std() == pytest.approx(found.senses[Sense.POSITION_NOISE], rel=0.3)
    assert abs(errors.mean()) < 0.2


def test_actors_that_a_program_added_are_named(tmp_path: Path) -> None:
    what = several_egos(Weather())
    trace, _ = recorded(what, tmp_path / "run.parquet")
    with pytest.raises(Conflict, match="actors"):
        perceive_again(replace(what, npc_walkers=()), EgoView(trace, network(), 0))
