"""The contract of oracles, as a suite of tests for authors of oracles.

Derive a test class from ``OracleContract`` in a test module and name the oracle::

    class TestMyOracle(OracleContract):
        def make_oracle(self) -> Oracle:
            return MyOracle()
"""

from __future__ import annotations

import json
import math
import pickle
import re
from abc import ABC, abstractmethod
from dataclasses import replace
from typing import ClassVar

import numpy as np

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Light, Role, TerminalEvent, Trace
from drivora_service.oracles.verdict import WITHOUT_FINDING, Oracle, Outcome, Verdict
from drivora_service.testing.networks import EAST, straight_road
from drivora_service.testing.traces import (
    Motion,
    SyntheticActor,
    SyntheticEgo,
    make_trace,
    with_contact,
)


class OracleContract(ABC):
    """The tests; each uses a new oracle.

    Attributes:
        objectives: Names of the objectives of its plug-in.
    """

    objectives: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def make_oracle(self) -> Oracle:
        """Returns the oracle under test."""

    def test_its_name_is_in_snake_case(self) -> None:
        assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", self.make_oracle().name)

    def test_every_ego_gets_a_verdict(self) -> None:
        for trace in example_runs():
            egos = {actor.id for actor in trace.actors[: trace.ego_count]}
            assert {verdict.ego for verdict in self._judge(trace)} == egos

    def test_an_ego_that_broke_nothing_gets_exactly_one_verdict(self) -> None:
        for trace in example_runs():
            verdicts = self._judge(trace)
            for ego in {verdict.ego for verdict in verdicts}:
                own = [verdict.outcome for verdict in verdicts if verdict.ego == ego]
                assert own.count(Outcome.VIOLATED) == len(own) or len(own) == 1

    def test_a_verdict_without_a_finding_attributes_no_fault(self) -> None:
        for trace in example_runs():
            for verdict in self._judge(trace):
                if verdict.outcome in WITHOUT_FINDING:
                    assert verdict.at_fault is None
                    assert verdict.avoidable is None
                    assert not verdict.undetermined

    def test_verdicts_carry_the_name_of_the_oracle_and_a_message(self) -> None:
        for trace in example_runs():
            for verdict in self._judge(trace):
                assert verdict.oracle == self.make_oracle().name
                assert verdict.message

    def test_a_violation_says_when_and_where(self) -> None:
        for trace in example_runs():
            for verdict in self._judge(trace):
                if verdict.outcome is not Outcome.VIOLATED:
                    assert verdict.step is None
                    continue
                assert verdict.step is not None
                assert verdict.time == trace.times[verdict.step]
                row = next(a.row for a in trace.actors if a.id == verdict.ego)
                assert verdict.location == tuple(trace.states[verdict.step, row, :2])

    def test_nothing_is_judged_outside_an_egos_part(self) -> None:
        for trace in example_runs():
            for verdict in self._judge(trace):
                row = next(a.row for a in trace.actors if a.id == verdict.ego)
                if verdict.step is not None and verdict.time is not None:
                    assert verdict.step <= trace.ego_end_steps[row]
                    assert verdict.time >= trace.ego_start_times[row] - 1e-9

    def test_what_happens_after_an_egos_end_changes_nothing(self) -> None:
        quiet = _cut_short()
        wild = replace(quiet, states=quiet.states.copy(), ego_values=quiet.ego_values.copy())
        after = quiet.ego_end_steps[0] + 1
        wild.states[after:, 0, 0] += 1000.0
        wild.states[after:, 0, 2] += 2.0
        wild.ego_values[after:, 0] = 77.0
        wild = with_contact(wild, step=after + 1, ego=0, other=1)
        assert self._judge(wild) == self._judge(quiet)

    def test_an_ego_that_never_started_is_not_measurable(self) -> None:
        (verdict,) = self._judge(_never_started())
        assert verdict.outcome is Outcome.NOT_MEASURABLE

    def test_evidence_is_json(self) -> None:
        for trace in example_runs():
            for verdict in self._judge(trace):
                json.dumps(dict(verdict.evidence), allow_nan=False)

    def test_its_objectives_are_evidence_and_0_is_the_least_of_a_passed_run(self) -> None:
        for trace in example_runs():
            for verdict in self._judge(trace):
                for name in self.objectives:
                    if verdict.outcome not in (Outcome.PASSED, Outcome.VIOLATED):
                        continue
                    assert name in verdict.evidence, f"{verdict.outcome} without {name}"
                    value = verdict.evidence[name]
                    if value is not None:
                        assert math.isfinite(value)
                        assert value <= 0.0 if verdict.outcome is Outcome.VIOLATED else value >= 0.0

    def test_judging_twice_says_the_same(self) -> None:
        for trace in example_runs():
            assert self._judge(trace) == self._judge(trace)

    def test_judging_leaves_the_trace_alone(self) -> None:
        for trace in example_runs():
            before = pickle.dumps(trace)
            self._judge(trace)
            assert pickle.dumps(trace) == before

    def test_it_can_be_sent_to_another_process(self) -> None:
        oracle = self.make_oracle()
        assert pickle.loads(pickle.dumps(oracle)) == oracle

    def _judge(self, trace: Trace) -> tuple[Verdict, ...]:
        return self.make_oracle().judge(RunView(trace, straight_road()))


def example_runs() -> tuple[Trace, ...]:
    """Returns runs on ``straight_road`` that oracles must be able to judge."""
    return (
        _orderly(),
        _wild(),
        _past_a_walker(),
        _cut_short(),
        _jumped_into(),
        _single_row(),
        _off_everything(),
        _never_started(),
    )


def _orderly() -> Trace:
    ego = SyntheticEgo(
        motion=Motion.steady(0.0, 0.0, steps=200, speed=8.0),
        lane=EAST,
        lane_lateral=0.0,
        lane_heading=0.0,
        speed_limit=10.0,
        end=TerminalEvent.ARRIVED,
    )
    ahead = SyntheticActor(motion=Motion.steady(30.0, 0.0, steps=200, speed=8.0))
    return make_trace([ego], [ahead])


def _wild() -> Trace:
    """Two egos that violate most oracles: one backwards over a red light, one into an obstacle."""
    steps = 1500
    backwards = SyntheticEgo(
        id="backwards",
        motion=Motion.steady(100.0, 0.0, steps=steps, speed=-3.0),
        lane=EAST,
        lane_lateral=0.0,
        lane_heading=0.0,
        speed_limit=1.0,
        light=Light.RED,
        light_distance=np.where(np.arange(steps) < 50, 10.0 - 0.4 * np.arange(steps), np.nan),
        route_lateral=40.0,
        route_s=0.0,
    )
    standing = SyntheticEgo(
        id="standing",
        motion=Motion.steady(-100.0, 0.0, steps=steps),
        lane=EAST,
        lane_lateral=0.0,
        lane_heading=0.0,
        speed_limit=10.0,
        route=np.array([(-100.0, 0.0), (100.0, 0.0)]),
        route_s=0.0,
        end=TerminalEvent.STUCK,
    )
    trace = make_trace([backwards, standing])
    return with_contact(trace, step=1300, ego=0, other=1)


def _past_a_walker() -> Trace:
    """An ego that passes closely by a crossing walker and an obstacle at the kerb."""
    ego = SyntheticEgo(
        motion=Motion.steady(0.0, 0.0, steps=200, speed=8.0),
        lane=EAST,
        lane_lateral=0.0,
        lane_heading=0.0,
        speed_limit=10.0,
    )
    walker = SyntheticActor(
        motion=Motion.steady(40.0, -5.5, steps=200, speed=1.0, yaw=0.5 * np.pi),
        id="walker",
        role=Role.NPC_WALKER,
        length=0.6,
        width=0.6,
        present=np.arange(200) >= 20,
    )
    obstacle = SyntheticActor(
        motion=Motion.steady(60.0, -2.5, steps=200),
        id="obstacle",
        role=Role.NPC_OBSTACLE,
        length=1.0,
        width=1.0,
    )
    return make_trace([ego], [walker, obstacle])


def _cut_short() -> Trace:
    ego = SyntheticEgo(
        motion=Motion.steady(0.0, 0.0, steps=200, speed=8.0),
        lane=EAST,
        lane_lateral=0.0,
        lane_heading=0.0,
        speed_limit=10.0,
        end=TerminalEvent.COLLISION,
        end_step=99,
    )
    other = SyntheticActor(motion=Motion.steady(44.0, 0.0, steps=200))
    trace = make_trace([ego], [other])
    return with_contact(trace, step=99, ego=0, other=1)


def _jumped_into() -> Trace:
    """An ego into which a vehicle of the next lane is moved in one step, as SUMO may do."""
    ego = SyntheticEgo(
        motion=Motion.steady(0.0, 0.0, steps=200, speed=8.0),
        lane=EAST,
        lane_lateral=0.0,
        lane_heading=0.0,
        speed_limit=10.0,
        end=TerminalEvent.COLLISION,
        end_step=99,
    )
    jumping = Motion.steady(1.0, 3.5, steps=200, speed=8.0)
    jumping.states[99:, 1] -= 3.5
    trace = make_trace([ego], [SyntheticActor(motion=jumping)])
    return with_contact(trace, step=99, ego=0, other=1)


def _single_row() -> Trace:
    road = np.array([(0.0, 0.0), (50.0, 0.0)])
    return make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=1), route=road)])


def _off_everything() -> Trace:
    """An ego off all roads, of which only the position is known."""
    return make_trace([SyntheticEgo(motion=Motion.steady(0.0, -50.0, steps=60, speed=2.0))])


def _never_started() -> Trace:
    road = np.array([(0.0, 0.0), (50.0, 0.0)])
    waiting = Motion.steady(0.0, 0.0, steps=50)
    return make_trace([SyntheticEgo(motion=waiting, route=road, start_time=60.0)])
