"""What travels arrives as it was."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.agents.interface import (
    AccelerationControl,
    AgentContext,
    Control,
    Observation,
    PedalControl,
    PoseControl,
    TrajectoryControl,
)
from drivora_service.agents.log import AgentLog
from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote.adapter_messages import (
    context_view,
    observation_view,
    step_reply,
)
from drivora_service.agents.remote.remote_messages import control_of, setup_request, step_request
from drivora_service.errors import AgentError
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.observations.trace import Light
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from tests.simulation.episodes import CAR, network, place

finite = st.floats(allow_nan=False, allow_infinity=False, width=64)
anything = st.floats()


def context(town: str, *lanes: tuple[str, float]) -> AgentContext:
    points = [place(lane, s, on=town) for lane, s in lanes]
    return AgentContext(
        ego_id="ego",
        model=actor_model(ActorKind.VEHICLE, CAR),
        network=network(town),
        route=plan_route(network(town), [RoutePoint(x=p.x, y=p.y, yaw=p.yaw) for p in points]),
        step_length=0.05,
        friction=0.7,
        seed=2**32 - 1,
        parameters={"speed": 3.5, "names": ["a", None]},
        log=AgentLog(),
    )


def drivable_lanes(town: str) -> list[str]:
    return [lane.id for lane in network(town).lanes if lane.drivable and not lane.is_internal]


def test_a_context_arrives_whole() -> None:
    told = context("tee-town", ("harbour_0_0", 120.0), ("ferry_1_0", 60.0))
    message = pb.SetupRequest.FromString(setup_request(told, "run").SerializeToString())
    view = context_view(message, told.log)
    route = told.route
    assert (view.ego_id, view.seed, view.friction, view.step_length) == (
        "ego", 2**32 - 1, 0.7, 0.05,
    )  # fmt: skip
    assert view.parameters == told.parameters
    for name in view.vehicle.__slots__:
        mine = told.model.name if name == "model" else getattr(told.model, name)
        assert getattr(view.vehicle, name) == mine
    assert np.array_equal(view.route.line, route.line)
    assert np.array_equal(view.route.arc, route.arc)
    assert np.array_equal(view.route.speed_limits, route.speed_limits)
    assert np.array_equal(view.route.lanes, route.point_lanes)
    assert view.route.runs == tuple(run.lanes for run in route.runs)
    assert [signal.s for signal in view.route.signals] == [signal.s for signal in route.signals]
    lanes = told.network.lanes
    for width, lane in zip(view.route.widths, route.point_lanes, strict=True):
        assert width == lanes[lane].width
    assert set(route.point_lanes.tolist()) <= set(view.lanes)
    for number, lane in view.lanes.items():
        source = lanes[number]
        assert source.drivable
        assert np.array_equal(lane.line, source.shape)
        assert lane.in_junction == source.is_internal
        assert (lane.left, lane.right) == (
            source.left if source.left >= 0 else None,
            source.right if source.right >= 0 else None,
        )
        assert set(lane.successors) <= {link.to_lane for link in source.connections}
        assert not (lane.may_change_left and lane.left is None)


def test_signals_name_the_lane_at_whose_end_they_stand() -> None:
    for lane in drivable_lanes("signal-grid")[:12]:
        start = network("signal-grid").lane(lane)
        for link in start.connections:
            behind = network("signal-grid").lanes[link.to_lane]
            onward = behind.connections[0].to_lane if behind.is_internal else behind.index
            told = context(
                "signal-grid", (lane, 1.0), (network("signal-grid").lanes[onward].id, 20.0)
            )
            view = context_view(setup_request(told, ""), told.log)
            for signal in view.route.signals:
                before = np.searchsorted(view.route.arc, signal.s - 1e-6) - 1
                assert view.route.lanes[before] == signal.lane
                end = view.lanes[signal.lane].line[-1]
                x, y = (np.interp(signal.s, view.route.arc, view.route.line[:, k]) for k in (0, 1))
                assert math.hypot(x - end[0], y - end[1]) < 1.0


@given(
    numbers=st.lists(anything, min_size=9, max_size=9),
    count=st.integers(0, 5),
    light=st.sampled_from(Light),
    distance=anything,
)
def test_an_observation_arrives_bit_by_bit(
    numbers: list[float], count: int, light: Light, distance: float
) -> None:
    told = Observation(
        time=numbers[0],
        step=7,
        ego=np.array(numbers),
        speed=numbers[1],
        objects=np.array([numbers] * count).reshape(-1, 9),
        object_sizes=np.array([numbers[:2]] * count).reshape(-1, 2),
        object_kinds=np.arange(count, dtype=np.int64),
        object_ids=np.arange(count, dtype=np.int64) + 3,
        light=light,
        light_protected=True,
        light_distance=distance,
        speed_limit=numbers[2],
    )
    view = observation_view(
        pb.StepRequest.FromString(step_request(told, "run").SerializeToString())
    )
    for name in Observation.__slots__:
        mine, theirs = getattr(told, name), getattr(view, name)
        assert np.array_equal(mine, theirs, equal_nan=True), name
        if isinstance(mine, np.ndarray):
            assert (mine.shape, mine.dtype) == (theirs.shape, theirs.dtype), name


def answered(control: Control) -> Control:
    reply = step_reply(control, AgentLog())
    return control_of(pb.StepReply.FromString(reply.SerializeToString()))


@given(numbers=st.lists(st.floats(-1e6, 1e6), min_size=4, max_size=4))
def test_controls_arrive_as_they_were(numbers: list[float]) -> None:
    a, b, c, d = numbers
    for control in (
        PedalControl(a, b, c),
        AccelerationControl(a, b),
        PoseControl(a, b, c),
        PoseControl(a, b, c, d),
    ):
        assert answered(control) == control
    points = np.array([numbers, numbers])
    trajectory = answered(TrajectoryControl(points))
    assert isinstance(trajectory, TrajectoryControl)
    assert np.array_equal(trajectory.points, points)


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused(odd: float) -> None:
    for control in (
        PedalControl(0.0, odd, 0.0),
        AccelerationControl(odd, 0.0),
        PoseControl(0.0, 0.0, 0.0, odd),
        TrajectoryControl(np.full((2, 4), odd)),
    ):
        with pytest.raises(AgentError, match="not finite") as failure:
            answered(control)
        assert failure.value.cause == "agent_invalid_control"


def test_an_answer_without_a_control_is_refused() -> None:
    with pytest.raises(AgentError, match="no control") as failure:
        control_of(pb.StepReply(text="thinking"))
    assert failure.value.cause == "agent_invalid_control"


def test_a_trajectory_with_numbers_left_over_is_refused() -> None:
    with pytest.raises(AgentError, match="5 numbers"):
        control_of(pb.StepReply(trajectory=pb.Trajectory(points=[0.0] * 5)))
