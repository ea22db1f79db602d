"""Samples of the expert are recorded, and none of the perturbing driver."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.agents.ad_mlp.view import AdMlpView
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import (
    AccelerationControl,
    AgentContext,
    Control,
    Observation,
    PedalControl,
)
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.simulation.planning import plan_episode
from drivora_service.training.demonstrations import (
    Jerks,
    Learner,
    PerturbingDriver,
    Recorder,
    Samples,
    join,
    record,
)
from drivora_service.training.training_courses import COURSES, plans
from tests.simulation.episodes import Scripted, accelerating, ego, network, place, scenario

START, END = place("harbour_0_0", 20), place("harbour_0_0", 150)


def recorded(
    expert: Scripted | IdmAgent, perturbing: PerturbingDriver | None, initial_speed: float = 0.0
) -> Samples:
    what = scenario(ego(START, END, initial_speed=initial_speed), seconds=9.0)
    return record(plan_episode(what, network()), Recorder(expert, AdMlpView(), perturbing, 3))


class Braking(Jerks):
    """Stands on the brake for two seconds."""

    def begin(self, random: np.random.Generator) -> float:
        return 2.0

    def drive(self, observation: Observation, expert: AccelerationControl) -> Control:
        return AccelerationControl(-8.0, 0.0)


def test_waypoints_are_where_the_expert_went() -> None:
    samples = recorded(accelerating(0.0), None, initial_speed=8.0)
    assert len(samples.seen) > 30
    assert samples.known[:-10].all()
    assert samples.waypoints[:-10, :, 0] == pytest.approx(
        np.tile([4.0, 8.0, 12.0, 16.0], (len(samples.seen) - 10, 1)), abs=0.2
    )
    assert np.abs(samples.waypoints[:-10, :, 1]).max() < 0.05
    assert not samples.waypoints[~samples.known].any()


def test_nothing_is_learned_of_who_drives_in_between() -> None:
    alone, shared = recorded(IdmAgent(), None), recorded(IdmAgent(), Braking())
    assert len(shared.seen) < 0.8 * len(alone.seen)
    # It brakes by 8 m/s², the expert never: who is braked so is not learned from.
    speed = 15.0 * shared.seen[:, 0]
    assert (shared.waypoints[shared.known[:, 0], 0, 0] > 0.5 * speed - 0.7).all()


def test_the_learner_drives_in_between_and_its_own_log_is_not_the_runs() -> None:
    class Still(Scripted):
        def setup_env(self, context: AgentContext) -> None:
            super().setup_env(context)
            context.log.declare("mood")
            self.log = context.log

        def run_step(self, observation: Observation) -> Control:
            self.log.row[0] = 1.0
            return AccelerationControl(-8.0, 0.0)

    class Briefly(Learner):
        def begin(self, random: np.random.Generator) -> float:
            assert 4.0 <= super().begin(random) <= 20.0
            return 3.0

    learner = Briefly(Still(lambda _: AccelerationControl(0.0, 0.0)))
    alone, shared = recorded(IdmAgent(), None), recorded(IdmAgent(), learner)
    assert len(shared.seen) < 0.8 * len(alone.seen)
    # Where the learner has stopped, the expert shows how to go on.
    moves = shared.waypoints[shared.known[:, 1] & (shared.seen[:, 0] < 0.05), 1, 0]
    assert (moves > 0.3).any()


def test_nothing_is_learned_of_what_led_to_a_collision() -> None:
    recorder = Recorder(accelerating(1.0), AdMlpView(), None, 1)
    record(plan_episode(scenario(ego(START, END), seconds=9.0), network()), recorder)
    whole, cut = recorder.samples(collided=False), recorder.samples(collided=True)
    assert 12 <= len(whole.seen) - len(cut.seen) <= 16
    assert np.array_equal(whole.seen[: len(cut.seen)], cut.seen)


def test_samples_of_runs_are_put_together() -> None:
    samples = recorded(accelerating(0.0), None, initial_speed=8.0)
    both = join([samples, samples])
    assert np.array_equal(both.seen, np.tile(samples.seen, (2, 1)))
    assert len(both.waypoints) == len(both.known) == 2 * len(samples.seen)


def test_an_expert_who_answers_otherwise_is_refused() -> None:
    with pytest.raises(Exception, match="PedalControl"):
        recorded(Scripted(lambda _: PedalControl(0.0, 1.0, 0.0)), None)


def test_courses_give_runs_with_and_without_traffic() -> None:
    networks = NetworkCatalogue(shipped_networks())
    busy = next(plans(networks, runs=1, seed=5, crowding=4))
    empty = next(plans(networks, runs=1, seed=5, crowding=0))
    assert busy.network.name == empty.network.name == COURSES[0].network
    traffic = busy.scenario.background_traffic
    assert traffic is not None
    assert traffic.count == 4 * COURSES[0].background
    assert empty.scenario.background_traffic is None
