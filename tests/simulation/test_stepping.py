"""Driving an episode from outside, step by step."""

from __future__ import annotations

from time import perf_counter_ns

import numpy as np
import pytest

from drivora_service.agents.interface import (
    AccelerationControl,
    Observation,
    PedalControl,
    PoseControl,
)
from drivora_service.errors import AgentError, NoRoute, SimulatorError
from drivora_service.observations.trace import Role, TerminalEvent
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.look import ActorState
from tests.simulation.episodes import (
    ROAD,
    Blind,
    Scripted,
    car,
    contacts,
    ego,
    obstacle,
    place,
    presence,
    scenario,
    speeds,
    standing,
    start,
    travelled,
    walker,
)


def two_egos(seconds: float = 10.0) -> Episode:
    return start(
        scenario(
            ego(place(ROAD, 20), place(ROAD, 120), name="one"),
            ego(place("-north_2_0", 10), place("-north_2_0", 130), name="two"),
            seconds=seconds,
        ),
        standing(),
        standing(),
    )


def state(episode: Episode, actor: str) -> ActorState | None:
    return next((a for a in episode.look().actors if a.id == actor), None)


def test_a_new_episode_shows_its_first_frame() -> None:
    episode = start(
        scenario(
            ego(place(ROAD, 20), place(ROAD, 120), initial_speed=4.0),
            npc_vehicles=(car(place(ROAD, 80)), car(place(ROAD, 90), name="late", start_time=2.0)),
            npc_obstacles=(obstacle(place(ROAD, 100)),),
            npc_walkers=(walker(place(ROAD, 110, right=4.0)),),
        ),
        standing(),
    )
    look = episode.look()
    assert (look.time, look.step, look.done) == (0.0, 0, False)
    assert [a.id for a in look.actors] == ["ego", "npc", "walker", "box"]
    assert [a.role for a in look.actors] == [
        Role.EGO, Role.NPC_VEHICLE, Role.NPC_WALKER, Role.NPC_OBSTACLE,
    ]  # fmt: skip
    first, spot = look.actors[0], place(ROAD, 20)
    assert (first.x, first.y, first.yaw) == (spot.x, spot.y, spot.yaw)
    assert first.speed == 4.0


def test_controls_from_outside_come_before_the_agents() -> None:
    episode = two_egos()
    for _ in range(40):
        episode.step(controls={"one": AccelerationControl(2.0, 0.0)})
    one, two = state(episode, "one"), state(episode, "two")
    assert one is not None
    assert two is not None
    assert one.speed > 3.0
    assert two.speed == 0.0
    assert episode.time == pytest.approx(2.0)
    for _ in range(40):
        episode.step()
    assert state(episode, "one").speed == 0.0  # type: ignore[union-attr]  # it is still there
    values = episode.finish().ego_values
    assert np.all(values[:40, 0, 0] == 2.0)
    assert np.all(values[40:80, 0, 0] == -8.0)


def test_every_kind_of_control_moves_the_ego() -> None:
    spot = place(ROAD, 20)
    for control in (
        PedalControl(0.8, 0.0, 0.0),
        PoseControl(place(ROAD, 40).x, place(ROAD, 40).y, spot.yaw or 0.0),
    ):
        episode = two_egos()
        for _ in range(20):
            episode.step({"one": control})
        assert state(episode, "one").speed > 1.0  # type: ignore[union-attr]  # it is still there


def test_controls_for_other_actors_are_refused() -> None:
    with pytest.raises(SimulatorError, match=r"'three'.*one, two"):
        two_egos().step(controls={"three": AccelerationControl(2.0, 0.0)})


def test_a_control_that_is_none_is_refused() -> None:
    with pytest.raises(AgentError, match="str"):
        two_egos().step(controls={"one": "go"})  # type: ignore[dict-item]  # what users do


def test_no_step_after_the_end() -> None:
    episode = two_egos(seconds=0.1)
    assert episode.step() is False
    assert episode.step() is True
    assert episode.look().done
    with pytest.raises(SimulatorError, match="ended"):
        episode.step()
    assert episode.finish().step_count == 3


@pytest.mark.parametrize("behavior", ["replay", "reactive", "sumo"])
def test_a_vehicle_joins_during_the_run(behavior: str) -> None:
    episode = two_egos(seconds=6.0)
    for _ in range(20):
        episode.step()
    episode.add_vehicle(
        car(place(ROAD, 60, speed=8.0), place(ROAD, 120, speed=8.0), behavior=behavior)
    )
    episode.add_vehicle(
        car(
            place(ROAD, 40, speed=4.0), place(ROAD, 120, speed=4.0), name="later",
            behavior=behavior, start_time=2.0,
        )
    )  # fmt: skip
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert trace.states.shape[1] == len(trace.actors) == 4
    assert not presence(trace, "npc")[:21].any()
    assert presence(trace, "npc")[21]
    assert not presence(trace, "later")[:40].any()
    assert presence(trace, "later")[41]
    assert travelled(trace, "npc") > 20.0


def test_a_walker_joins_in_front_of_an_ego_and_is_hit() -> None:
    episode = start(scenario(ego(place(ROAD, 20), place(ROAD, 120))), Blind())
    for _ in range(20):
        episode.step()
    episode.add_walker(walker(place(ROAD, 70), place(ROAD, 70, right=1.0)))
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert not presence(trace, "walker")[:21].any()
    assert contacts(trace) == [("ego", "walker")]
    assert trace.ego_ends == (TerminalEvent.COLLISION,)


def test_an_agent_perceives_who_joins() -> None:
    what = scenario(ego(place(ROAD, 20), place(ROAD, 120)), seconds=30.0)
    episode = start(what)
    for _ in range(20):
        episode.step()
    episode.add_vehicle(car(place(ROAD, 80)))
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert not trace.contacts
    assert speeds(trace, "ego")[-1] < 0.1


def test_an_id_is_given_once() -> None:
    episode = two_egos()
    for name in ("one", "two"):
        with pytest.raises(SimulatorError, match=f"'{name}'"):
            episode.add_vehicle(car(place(ROAD, 80), name=name))
        with pytest.raises(SimulatorError, match=f"'{name}'"):
            episode.add_walker(walker(place(ROAD, 80), name=name))
    episode.add_walker(walker(place(ROAD, 80, right=4.0)))
    with pytest.raises(SimulatorError, match="'walker'"):
        episode.add_vehicle(car(place(ROAD, 80), name="walker", behavior="sumo"))


def test_no_actor_joins_after_the_end() -> None:
    episode = two_egos(seconds=0.05)
    episode.step()
    with pytest.raises(SimulatorError, match="ended"):
        episode.add_vehicle(car(place(ROAD, 80)))
    with pytest.raises(SimulatorError, match="ended"):
        episode.add_walker(walker(place(ROAD, 80)))


def test_a_vehicle_without_a_way_is_refused_and_leaves_no_row() -> None:
    episode = two_egos()
    field = place(ROAD, 80, right=60.0)
    with pytest.raises(NoRoute):
        episode.add_vehicle(car(field, place(ROAD, 100), behavior="sumo"))
    episode.step()
    assert len(episode.finish().actors) == 2


def test_the_trace_grows_beyond_its_first_room() -> None:
    what = scenario(
        ego(place(ROAD, 20), place(ROAD, 120)),
        npc_vehicles=(car(place(ROAD, 80)),), step_length=0.01, seconds=12.0,
    )  # fmt: skip
    episode = start(what, standing())
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert trace.step_count == 1201
    assert presence(trace, "npc").all()
    assert np.isfinite(trace.states[:, 0]).all()


def test_the_time_that_agents_take_is_told_by_ego() -> None:
    pause_ns = 1_000_000

    def think(observation: Observation) -> AccelerationControl:
        begun = perf_counter_ns()
        while perf_counter_ns() - begun < pause_ns:
            pass
        return AccelerationControl(-8.0, 0.0)

    episode = start(
        scenario(
            ego(place(ROAD, 20), place(ROAD, 120), name="slow"),
            ego(place("-north_2_0", 10), place("-north_2_0", 130), name="late", start_time=5.0),
            ego(place(ROAD, 60), place(ROAD, 120), name="driven", agent="sumo-idm"),
            seconds=10.0,
        ),
        Scripted(think),
        Scripted(think),
    )
    begun = perf_counter_ns()
    for _ in range(20):
        episode.step()
    took = 1e-9 * (perf_counter_ns() - begun)
    seconds = episode.agent_seconds()
    assert set(seconds) == {"slow", "late"}
    assert 20 * 1e-9 * pause_ns <= seconds["slow"] <= took
    assert seconds["late"] == 0.0
    # Who is driven from outside is not asked.
    episode.step({"slow": AccelerationControl(0.0, 0.0)})
    assert episode.agent_seconds() == seconds
