"""Another path than the reference path: overlap, and whether the reference path was free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from shapely import LineString, Point
from shapely.affinity import rotate, translate
from shapely.geometry import box

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.observations.reference_path import recorded_path
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, Role, TerminalEvent, Trace
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.non_optimal_decision import NonOptimalDecision
from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.scenario.model import (
    AgentChoice,
    EgoVehicle,
    MapRegion,
    NpcBehavior,
    NpcVehicle,
    ReferencePose,
    Scenario,
)
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from drivora_service.testing.networks import EAST, straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.simulation.episodes import CAR, network, place

Floats = NDArray[np.float64]

STEPS = 400
X = 0.5 * np.arange(STEPS)
"""200 m in 20 s."""
REFERENCE = np.array([(0.0, 0.0, 0.0, 0.0, 10.0, 0.0), (20.0, 200.0, 0.0, 0.0, 10.0, 0.0)])
"""The same, in the middle of the lane."""


def detour(begin: float, end: float, aside: float = 3.2) -> Floats:
    """Metres beside the lane's middle at each step: on the next lane between two places."""
    out = np.clip((X - begin) / 20.0, 0.0, 1.0) - np.clip((X - end) / 20.0, 0.0, 1.0)
    beside: Floats = aside * 0.5 * (1.0 - np.cos(np.pi * out))
    return beside


def ego_on(y: Any, **fields: Any) -> SyntheticEgo:
    defaults: dict[str, Any] = {
        "lane": EAST,
        "route": np.array([(0.0, 0.0), (400.0, 0.0)]),
        "end": TerminalEvent.ARRIVED,
    }
    return SyntheticEgo(motion=Motion.along(X, y), **{**defaults, **fields})


def judged(ego: SyntheticEgo, *others: SyntheticActor, reference: Floats = REFERENCE) -> Verdict:
    trace = replace(make_trace([ego], others), references=(reference,))
    (verdict,) = NonOptimalDecision().judge(RunView(trace, straight_road()))
    return verdict


def test_the_same_path_passes_and_so_does_one_beside_it_in_the_lane() -> None:
    for y in (0.0, 0.7, detour(50, 150, 1.0)):
        verdict = judged(ego_on(y))
        assert verdict.outcome is Outcome.PASSED
        assert verdict.evidence["overlap"] == 1.0


def test_a_long_detour_violates_where_it_begins() -> None:
    y = detour(40, 130)
    verdict = judged(ego_on(y))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.severity is Severity.MINOR
    assert accountability(verdict) is Accountability.AVOIDABLE
    # Of 100 pieces 45 are shared: half of each ramp of 20 m, and all beyond.
    assert verdict.evidence["overlap"] == pytest.approx(55 / 145, abs=0.02)
    assert verdict.evidence["path_difference"] == pytest.approx(3.2)
    assert verdict.step is not None
    assert verdict.step == int(np.argmax(y > 1.6))
    assert list(verdict.location or ()) == pytest.approx([X[verdict.step], y[verdict.step]])


def test_a_short_detour_passes() -> None:
    verdict = judged(ego_on(detour(60, 90)))
    assert verdict.outcome is Outcome.PASSED
    assert 0.6 < verdict.evidence["overlap"] < 0.8


def test_waiting_on_the_path_is_a_difference_of_time_only() -> None:
    x = np.concatenate((X[:100], np.full(200, X[99]), X[100:]))
    ego = SyntheticEgo(
        motion=Motion.along(x, np.zeros(len(x))),
        route=np.array([(0.0, 0.0), (400.0, 0.0)]),
        end=TerminalEvent.ARRIVED,
    )
    verdict = judged(ego)
    assert verdict.outcome is Outcome.PASSED
    assert verdict.evidence["added_time"] == pytest.approx(10.0, abs=0.1)


@pytest.mark.parametrize(
    ("when", "outcome"),
    [
        # The ego on its reference path is at 100 m between 9.6 and 10.5 s.
        (10.0, Outcome.NOT_MEASURABLE),
        (12.0, Outcome.VIOLATED),
    ],
)
def test_a_path_that_was_not_free_is_no_better(when: float, outcome: Outcome) -> None:
    times = 0.05 * np.arange(STEPS)
    crossing = SyntheticActor(
        motion=Motion.along(np.full(STEPS, 100.0), 8.0 * (times - when)),
        id="crossing",
        role=Role.NPC_WALKER,
        length=0.6,
        width=0.6,
    )
    verdict = judged(ego_on(detour(40, 130)), crossing)
    assert verdict.outcome is outcome
    if outcome is Outcome.NOT_MEASURABLE:
        assert verdict.evidence["blocked_by"] == "crossing"
        assert verdict.evidence["blocked_at"] == pytest.approx(10.0, abs=0.6)


def test_an_actor_on_another_level_does_not_block() -> None:
    standing = Motion.steady(100.0, 0.0, steps=STEPS)
    standing.states[:, Col.Z] = 6.0
    verdict = judged(ego_on(detour(40, 130)), SyntheticActor(motion=standing))
    assert verdict.outcome is Outcome.VIOLATED
    raised = REFERENCE + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 6.0])
    verdict = judged(ego_on(detour(40, 130)), SyntheticActor(motion=standing), reference=raised)
    assert verdict.outcome is Outcome.NOT_MEASURABLE


def test_an_ego_that_did_not_arrive_is_not_measurable() -> None:
    verdict = judged(ego_on(detour(40, 130), end=TerminalEvent.COLLISION))
    assert verdict.outcome is Outcome.NOT_MEASURABLE


def test_a_path_of_another_task_is_not_compared() -> None:
    for shift in (-20.0, 20.0):
        shifted = REFERENCE.copy()
        shifted[:, 1] += shift
        verdict = judged(ego_on(detour(40, 130)), reference=shifted)
        assert verdict.outcome is Outcome.NOT_MEASURABLE
        assert "another task" in verdict.message


def test_a_run_without_reference_paths_has_no_verdict() -> None:
    trace = make_trace([ego_on(0.0)])
    told = {verdict.oracle for verdict in judge_all(trace, straight_road(), default_oracles())}
    assert "non_optimal_decision" not in told
    assert len(told) == len(default_oracles()) - 1


def test_of_several_egos_only_those_with_a_path_are_judged() -> None:
    egos = [ego_on(0.0, id="with"), ego_on(30.0, id="without")]
    trace = replace(make_trace(egos), references=(REFERENCE, np.zeros((0, 6))))
    verdicts = judge_all(trace, straight_road(), [NonOptimalDecision()])
    assert [verdict.outcome for verdict in verdicts] == [Outcome.PASSED, Outcome.NOT_APPLICABLE]


# The same on recorded runs, by other code: shapely, and every row for itself.


def recorded(
    agent: str, *others: NpcVehicle, reference: Floats | None = None, **parameters: Any
) -> Trace:
    """Records 420 m of the motorway's middle lane."""
    poses = (
        ()
        if reference is None
        else tuple(
            ReferencePose(time=t, x=x, y=y, yaw=yaw, speed=speed, z=z)
            for t, x, y, yaw, speed, z in reference.tolist()
        )
    )
    ego = EgoVehicle(
        id="ego",
        model=CAR,
        route=(place("eb_2_1", 10, on="highway"), place("eb_2_1", 430, on="highway")),
        agent=AgentChoice(name=agent),
        initial_speed=25.0,
        reference_path=poses,
    )
    scenario = Scenario(
        ego_vehicles=(ego,), npc_vehicles=others, map_region=MapRegion(town="highway"), seed=1
    )
    plan = plan_episode(scenario, network("highway"))
    driver = AgentCatalogue().create(agent, parameters)
    episode = Episode(plan, [driver])
    while not episode.done:
        episode.step()
    return episode.finish()


def leader(number: int, lane: str, s: float, *speeds: float) -> NpcVehicle:
    """A vehicle that replays 400 m of a lane, faster or slower from part to part."""
    places = np.linspace(s, min(s + 400.0, 435.0), len(speeds) + 1)
    first, *route = (place(lane, float(along), on="highway") for along in places)
    waypoints = [replace(first, speed=speeds[0])]
    waypoints += [replace(point, speed=v) for point, v in zip(route, speeds, strict=True)]
    return NpcVehicle(
        id=f"npc_{number}", model=CAR, route=tuple(waypoints), behavior=NpcBehavior.REPLAY
    )


def leaving(s: float, speed: float) -> NpcVehicle:
    """A slow vehicle ahead that leaves the ego's lane to the right before it is reached."""
    places = [("eb_2_1", s), ("eb_2_1", s + 20), ("eb_2_0", s + 45), ("eb_2_0", 435.0)]
    route = tuple(place(lane, along, on="highway", speed=speed) for lane, along in places)
    return NpcVehicle(id="leaving", model=CAR, route=route, behavior=NpcBehavior.REPLAY)


@lru_cache
def empty_road_path(agent: str) -> Floats:
    """Returns the path of an agent on the empty road."""
    return recorded_path(RunView(recorded(agent), network("highway")).egos[0])


def drives() -> tuple[Trace, ...]:
    """Runs of an ego that overtakes or not, compared with its run on the empty road."""
    path = empty_road_path("sumo-krauss")
    random = np.random.default_rng(5)
    runs = [recorded("sumo-krauss", reference=path)]
    runs += [recorded("sumo-krauss", leaving(s, v), reference=path) for s, v in LEAVING]
    for _ in range(10):
        cars = [
            leader(k, f"eb_2_{random.integers(3)}", random.uniform(40, 200), *speeds)
            for k, speeds in enumerate(random.uniform(8.0, 32.0, (2, 3)))
        ]
        runs.append(recorded("sumo-krauss", *cars, reference=path))
    return tuple(runs)


LEAVING = ((120.0, 12.0), (160.0, 10.0), (160.0, 14.0), (200.0, 10.0))
"""Places and speeds of the vehicle ahead, metres and m/s."""


def brute_force(trace: Trace) -> tuple[float, bool]:
    """Returns the overlap, and whether the reference path was free, computed by shapely."""
    end = trace.ego_end_steps[0] + 1
    path = trace.references[0]
    own, reference = LineString(trace.states[:end, 0, :2]), LineString(path[:, 1:3])

    def middles(line: LineString) -> Sequence[Point]:
        return [line.interpolate(1.0 + 2.0 * k) for k in range(round(line.length / 2.0))]

    shared = sum(reference_piece.distance(own) <= 1.6 for reference_piece in middles(reference))
    alone = sum(piece.distance(reference) > 1.6 for piece in middles(own))
    overlap = shared / (len(middles(reference)) + alone)

    def outline(x: float, y: float, yaw: float, length: float, width: float) -> Any:
        shape = box(-0.5 * length, -0.5 * width, 0.5 * length, 0.5 * width)
        return translate(rotate(shape, yaw, origin=(0, 0), use_radians=True), x, y)

    size = (trace.actors[0].length, trace.actors[0].width)
    for row in range(end):
        time = trace.times[row]
        if time > path[-1, 0]:
            break
        after = max(int(np.searchsorted(path[:, 0], time)), 1)
        before = path[after - 1]
        share = (time - before[0]) / (path[after, 0] - before[0])
        pose = before + share * (path[after] - before)
        mine = outline(pose[1], pose[2], pose[3], *size)
        for actor in trace.actors[1:]:
            if not trace.present[row, actor.row]:
                continue
            x, y, yaw = trace.states[row, actor.row, :3]
            if mine.intersection(outline(x, y, yaw, actor.length, actor.width)).area > 1e-9:
                return overlap, False
    return overlap, True


@pytest.mark.slow(seconds=60)
def test_recorded_runs_are_judged_as_by_brute_force() -> None:
    outcomes = set()
    for trace in drives():
        (verdict,) = NonOptimalDecision().judge(RunView(trace, network("highway")))
        if trace.ego_ends[0] is not TerminalEvent.ARRIVED:
            assert verdict.outcome is Outcome.NOT_MEASURABLE
            continue
        overlap, is_free = brute_force(trace)
        assert verdict.evidence["overlap"] == pytest.approx(overlap, abs=0.011)
        if abs(overlap - 0.6) < 0.02:
            continue
        if overlap > 0.6:
            expected = Outcome.PASSED
        else:
            expected = Outcome.VIOLATED if is_free else Outcome.NOT_MEASURABLE
        assert verdict.outcome is expected
        outcomes.add(expected)
    # The oracle applies wherever there is a reference path, so it has three outcomes.
    applicable = {Outcome.PASSED, Outcome.VIOLATED, Outcome.NOT_MEASURABLE}
    assert outcomes == applicable, "runs of each outcome were compared"


@pytest.mark.slow
def test_an_ego_compared_with_itself_shares_all_of_its_path() -> None:
    again = recorded("sumo-krauss", reference=empty_road_path("sumo-krauss"))
    (verdict,) = NonOptimalDecision().judge(RunView(again, network("highway")))
    assert verdict.outcome is Outcome.PASSED
    assert verdict.evidence["overlap"] == 1.0
    assert verdict.evidence["path_difference"] < 0.05


@pytest.mark.slow
def test_only_the_driver_that_changes_lanes_leaves_a_path_that_is_really_free() -> None:
    """A vehicle ahead is slow, and leaves the lane before it is reached."""
    ahead = leaving(*LEAVING[0])
    told = {}
    for agent in ("sumo-krauss", "idm"):
        path = empty_road_path(agent)
        run = recorded(agent, ahead, reference=path)
        (told[agent],) = NonOptimalDecision().judge(RunView(run, network("highway")))
        trajectory = path[:, :3].tolist()
        again = recorded("scripted", ahead, reference=path, trajectory=trajectory)
        (confirmed,) = NonOptimalDecision().judge(RunView(again, network("highway")))
        assert confirmed.outcome is Outcome.PASSED, "driven along it, the path leads to the goal"
        assert not again.contacts
    assert told["sumo-krauss"].outcome is Outcome.VIOLATED
    # It brakes, and so is later, but on the same path.
    assert told["idm"].outcome is Outcome.PASSED
    assert told["idm"].evidence["added_time"] > 0.5
