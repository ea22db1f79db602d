"""The game of an adversary: decisions, rewards, and a scenario that is the same run without it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drivora_service.adversaries.playing import Played, play
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.errors import SearchError, SimulatorError
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.runs.adversary import (
    ACTIONS,
    DECISIONS,
    EXTENSION,
    OBSERVATION_SIZE,
    OBSERVATIONS,
    Action,
    AdversarySource,
    action_values,
    layers_to_text,
)
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import BackgroundTraffic, Scenario
from drivora_service.scenario.validation import validate_data, validate_document
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from tests.adversaries.games import alone, decide, game
from tests.simulation.episodes import Blind, run, start

EXAMPLES = Path(__file__).parents[2] / "openscenario_schemas" / "examples"
NETWORKS = NetworkCatalogue(shipped_networks())
AGENTS = AgentCatalogue()
RANDOM = AdversarySource(policy="", exploration=1.0, seed=3, interval=4.0)


def episode_of(what: Scenario) -> Episode:
    agents = [AGENTS.create(e.agent.name, e.agent.parameters) for e in what.ego_vehicles]
    return Episode(plan_episode(what, NETWORKS.get(what.map_region.town)), agents)


def driven(what: Scenario) -> Trace:
    episode = episode_of(what)
    while not episode.done:
        episode.step()
    return episode.finish()


def check_replay(played: Played) -> None:
    """The recorded scenario alone is the run, as canonical text and as a user's document."""
    hashes = {
        trace_sha256(played.trace),
        trace_sha256(driven(from_canonical(canonical_json(played.scenario)))),
    }
    assert len(hashes) == 1
    valid = validate_document(to_document(played.scenario), NETWORKS, AGENTS.names())
    assert trace_sha256(driven(valid.scenario)) in hashes


@pytest.mark.parametrize("seed", range(3))
def test_what_was_played_is_replayed_without_the_adversary(seed: int) -> None:
    what = alone(background_traffic=BackgroundTraffic(count=4))
    played = play(start(what), replace(RANDOM, seed=seed, interval=2.0))
    assert len(played.scenario.extensions[EXTENSION]) >= 2
    check_replay(played)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(path.name for path in EXAMPLES.glob("*.json")))
def test_what_was_played_on_an_example_is_replayed(name: str) -> None:
    data = (EXAMPLES / name).read_bytes()
    scenario = validate_data(data, NETWORKS, AGENTS.names()).scenario
    if scenario.max_sim_time is None or scenario.max_sim_time > 40.0:
        scenario = replace(scenario, max_sim_time=40.0)
    played = play(episode_of(scenario), replace(RANDOM, seed=1, interval=5.0))
    check_replay(played)


def test_the_same_seed_plays_the_same_game_and_another_one_another() -> None:
    one, same, other = (play(start(alone()), replace(RANDOM, seed=seed)) for seed in (5, 5, 6))
    assert trace_sha256(one.trace) == trace_sha256(same.trace) != trace_sha256(other.trace)
    assert one.tables == same.tables != other.tables


def test_the_tables_have_what_a_policy_is_trained_with() -> None:
    played = play(start(alone()), RANDOM)
    observations = np.array(played.tables[OBSERVATIONS])
    decisions = np.array(played.tables[DECISIONS])
    assert observations.shape == (len(decisions) + 1, OBSERVATION_SIZE)
    assert np.abs(observations).max() <= 1.0
    assert set(decisions[:, 0]) <= set(range(len(ACTIONS)))
    assert decisions[:-1, 2].tolist() == [0.0] * (len(decisions) - 1)
    in_time = played.trace.ego_ends[0] is not TerminalEvent.TIME_LIMIT
    assert decisions[-1, 2] == float(in_time)


def test_a_policy_decides_by_the_greatest_value_of_its_network() -> None:
    random = np.random.default_rng(1)
    layers = [
        (random.normal(size=(after, before)), random.normal(size=after))
        for before, after in ((OBSERVATION_SIZE, 20), (20, len(ACTIONS)))
    ]
    source = replace(RANDOM, policy=layers_to_text(layers), exploration=0.0)
    played = play(start(alone()), source)
    decided = [int(row[0]) for row in played.tables[DECISIONS]]
    for observation, action in zip(played.tables[OBSERVATIONS], decided, strict=False):
        hidden = np.maximum(layers[0][0] @ np.array(observation) + layers[0][1], 0.0)
        assert int(np.argmax(layers[1][0] @ hidden + layers[1][1])) == action
    by_lot = play(start(alone()), replace(source, exploration=1.0))
    assert [int(row[0]) for row in by_lot.tables[DECISIONS]] == [
        int(row[0]) for row in play(start(alone()), RANDOM).tables[DECISIONS]
    ]


def test_policies_travel_as_text() -> None:
    random = np.random.default_rng(2)
    layers = [
        (random.normal(size=(after, before)).astype(np.float32), np.zeros(after, dtype=np.float32))
        for before, after in ((OBSERVATION_SIZE, 200), (200, 200), (200, len(ACTIONS)))
    ]
    text = layers_to_text(layers)  # type: ignore[arg-type]  # of single precision
    source = replace(RANDOM, policy=text)
    from drivora_service.runs.adversary import layers_from_text

    read = layers_from_text(source.policy)
    for (weights, bias), (known, zeros) in zip(read, layers, strict=True):
        assert np.array_equal(weights, known)
        assert np.array_equal(bias, zeros)
    seen = random.normal(size=OBSERVATION_SIZE)
    values = action_values(read, seen)
    hidden = np.maximum(layers[1][0] @ np.maximum(layers[0][0] @ seen, 0.0), 0.0)
    assert np.allclose(values, layers[2][0] @ hidden)
    for bad in ("?", "AAAA", layers_to_text(layers[:1])):  # type: ignore[arg-type]  # too few on purpose
        with pytest.raises(SearchError, match="policy"):
            layers_from_text(bad)


def test_a_collision_is_rewarded_with_one_and_ends_the_game() -> None:
    playing = game(alone(), Blind())
    outcome = decide(playing, Action.VEHICLE_STANDS)
    while not outcome.ended:
        assert outcome.reward == -1.0 or 0.2 <= outcome.reward <= 1.0
        outcome = decide(playing, Action.NOTHING)
    assert (outcome.reward, outcome.out_of_time) == (1.0, False)
    assert playing.is_over
    assert playing.finish().ego_ends == (TerminalEvent.COLLISION,)
    with pytest.raises(SimulatorError, match="ended"):
        decide(playing, Action.NOTHING)


def test_nothing_around_is_rewarded_with_minus_one_until_the_ego_arrives() -> None:
    playing = game(alone(), Blind(), interval=5.0)
    rewards = []
    while not playing.is_over:
        outcome = decide(playing, Action.NOTHING)
        rewards.append(outcome.reward)
    assert rewards == [-1.0] * 3
    assert outcome.ended
    assert not outcome.out_of_time
    assert EXTENSION not in playing.scenario.extensions
    assert outcome.observation[0] == pytest.approx(1.0, abs=0.05)


def test_the_end_of_time_is_no_end_of_the_ego() -> None:
    playing = game(alone(seconds=3.0), Blind(), interval=2.0)
    first, last = (decide(playing, Action.NOTHING) for _ in range(2))
    assert (first.ended, first.out_of_time) == (False, False)
    assert (last.ended, last.out_of_time) == (False, True)
    assert playing.finish().times[-1] == pytest.approx(3.0)


def test_a_scenario_that_was_played_before_keeps_what_was_done() -> None:
    first = game(alone())
    decide(first, Action.FOG)
    decide(first, Action.RUNNER_LEFT)
    second = game(first.scenario)
    assert run(first.scenario).actors[-1].id == "adversary:1"
    decide(second, Action.NIGHT)
    # Its name is taken, so this one has no effect.
    assert not decide(second, Action.WALKER_LEFT).intervention.has_effect
    told = second.scenario.extensions[EXTENSION]
    assert [one["action"] for one in told] == ["fog", "runner-left", "night"]
    assert told[1] == {"time": 4.0, "action": "runner-left", "actors": ["adversary:1"]}
    assert told[2] == {"time": 0.0, "action": "night", "weather": {"sun_altitude_angle": -10.0}}
