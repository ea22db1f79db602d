"""The latest moment to brake, against other code: NumPy and shapely on the trace alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from shapely import Polygon

from drivora_service.observations.trace import Col, Trace
from drivora_service.oracles.avoidability.braking_evasion import careful_braking
from drivora_service.oracles.avoidability.careful_driver import CarefulDriver
from drivora_service.testing.traces import Motion
from tests.oracles.avoidability.collisions import LENGTH, STEP, collision, cut, moving, steady

TIME = np.arange(0.0, 20.0, STEP)


def box(x: float, y: float, yaw: float, length: float, width: float) -> Polygon:
    turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [0.5 * length, 0.5 * width]
    return Polygon(corners @ turn.T + [x, y])


def avoids(trace: Trace, row: int, friction: float, larger: float, fine: int = 10) -> bool:
    """Brakes from ``row`` on in steps a tenth as long, against the one that was hit.

    That one is ``larger`` by so many metres than it is.
    """
    (contact,) = trace.contacts
    ego, other = trace.states[:, 0], trace.states[:, contact.other]
    sizes = [
        (trace.actors[i].length + more, trace.actors[i].width + more)
        for i, more in ((0, 0.0), (contact.other, larger))
    ]
    driven = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(ego[:, :2], axis=0).T))))
    heading = ego[-1, Col.YAW]
    full = min(0.774 * 9.81, friction * 9.81)
    last = other[contact.step]
    speed_then = math.hypot(last[Col.VX], last[Col.VY])
    before = other[contact.step - round(0.3 / STEP)]
    slowing = max((math.hypot(before[Col.VX], before[Col.VY]) - speed_then) / 0.3, 0.0)
    way = math.atan2(last[Col.VY], last[Col.VX]) if speed_then > 0.1 else last[Col.YAW]
    if abs((way - heading + math.pi) % (2 * math.pi) - math.pi) < math.radians(30.0):
        way = heading

    def ego_at(arc: float) -> Polygon:
        over = max(arc - driven[-1], 0.0)
        x, y = (float(np.interp(arc, driven, ego[:, k])) for k in (0, 1))
        yaw = float(np.interp(arc, driven, np.unwrap(ego[:, Col.YAW])))
        return box(x + over * math.cos(heading), y + over * math.sin(heading), yaw, *sizes[0])

    def other_at(step: int) -> Polygon:
        if step <= contact.step:
            x, y, yaw = other[step, :3].tolist()
            return box(x, y, yaw, *sizes[1])
        time = (step - contact.step) * STEP
        if slowing > 0.0:
            time = min(time, speed_then / slowing)
        far = speed_then * time - 0.5 * slowing * time**2
        yaw = heading if way == heading else last[Col.YAW]
        return box(last[0] + far * math.cos(way), last[1] + far * math.sin(way), yaw, *sizes[1])

    pace = np.hypot(ego[:, Col.VX], ego[:, Col.VY])
    recorded = np.zeros(contact.step + round(10.0 / STEP))
    recorded[: contact.step] = -np.diff(pace)[: contact.step] / STEP
    arc, speed, stood = driven[row], float(np.hypot(*ego[row, [Col.VX, Col.VY]])), 0.0
    for step in range(row, contact.step + round(10.0 / STEP)):
        begins = (step + 1 - row) * STEP <= 1.15 + 1e-9
        if begins and step < contact.step:
            arc, speed = driven[step + 1], float(np.hypot(*ego[step + 1, [Col.VX, Col.VY]]))
        else:
            for part in range(fine):
                since = (step - row + (part + 0.5) / fine) * STEP - 1.15
                braking = min(max(since, 0.0) * 0.774 * 9.81 / 0.6, full)
                # A driver who brakes already does not let go in order to brake.
                braking = max(braking, recorded[step])
                slower = max(speed - braking * STEP / fine, 0.0)
                arc, speed = arc + 0.5 * (speed + slower) * STEP / fine, slower
        if ego_at(arc).intersection(other_at(step + 1)).area > 1e-9:
            return False
        stood += STEP if speed <= 0.0 else 0.0
        if step >= contact.step and stood >= 2.0:
            return not comes_on(trace, ego_at(arc), way - heading, speed_then, slowing, larger)
    return True


def comes_on(
    trace: Trace, standing: Polygon, turn: float, speed: float, slowing: float, larger: float
) -> bool:
    """Whether an oncoming vehicle, which goes straight on, sweeps over the place of an ego."""
    if speed <= 0.1 or math.cos(turn) > math.cos(math.radians(115.0)):
        return False
    (contact,) = trace.contacts
    actor = trace.actors[contact.other]
    x, y, yaw = trace.states[-1, contact.other, :3].tolist()
    far = 300.0 if slowing <= 0.0 else min(300.0, speed**2 / (2.0 * slowing))
    begin, end = (
        box(
            x + s * math.cos(yaw),
            y + s * math.sin(yaw),
            yaw,
            actor.length + larger,
            actor.width + larger,
        )
        for s in (0.0, far)
    )
    return bool(begin.union(end).convex_hull.intersection(standing).area > 1e-9)


@pytest.mark.parametrize("friction", [0.45, 1.0])
@settings(max_examples=6, deadline=None)
@given(
    speed=st.floats(4.0, 15.0),
    against=st.floats(2.0, 15.0),
    stood=st.floats(0.0, 6.0),
    slowing=st.sampled_from((0.0, 0.0, 1.0, 4.0)),
)
def test_vehicles_that_come_head_on(
    friction: float, speed: float, against: float, stood: float, slowing: float
) -> None:
    """The ego brakes gently to a stop, and stands when a vehicle in its lane reaches it."""
    braking = 1.5
    along = np.minimum(TIME, speed / braking)
    ego = moving(speed * along - 0.5 * braking * along**2, 0.0, yaw=0.0)
    place = 0.5 * speed**2 / braking + LENGTH
    arrival = speed / braking + stood
    late = np.clip(TIME - arrival + 1.0, 0.0, against / slowing if slowing else np.inf)
    far = place + against * (arrival - TIME) + 0.5 * slowing * late**2
    compare(ego, moving(far, 0.0, yaw=math.pi), friction)


@pytest.mark.parametrize("friction", [0.45, 1.0])
@settings(max_examples=15, deadline=None)
@given(
    speed=st.floats(6.0, 28.0),
    share=st.floats(0.0, 0.8),
    gap=st.floats(5.0, 60.0),
    beside=st.sampled_from((0.0, 3.5, -3.5)),
    slowing=st.floats(0.0, 5.0),
)
def test_vehicles_ahead_and_cutting_in(
    friction: float, speed: float, share: float, gap: float, beside: float, slowing: float
) -> None:
    """The vehicle begins to come over after 4 s at 1.8 m/s, and brakes from then on."""
    other = share * speed
    after = np.clip(TIME - 4.0, 0.0, None)
    braking = np.minimum(after, other / slowing if slowing > 0.0 else np.inf)
    along = LENGTH + gap + 4.0 * (speed - other) + other * (TIME - after + braking)
    across = beside - math.copysign(1.0, beside) * np.minimum(1.8 * after, abs(beside))
    ahead = moving(along - 0.5 * slowing * braking**2, across, yaw=0.0)
    compare(steady(0.0, 0.0, speed), ahead, friction)


@pytest.mark.parametrize("friction", [0.45, 1.0])
@settings(max_examples=15, deadline=None)
@given(
    speed=st.floats(6.0, 20.0),
    crossing=st.floats(2.0, 12.0),
    angle=st.floats(0.8, 2.4),
    late=st.floats(-0.8, 0.8),
)
def test_vehicles_that_cross(
    friction: float, speed: float, crossing: float, angle: float, late: float
) -> None:
    """Both would be in the same place after 7 s, but for some tenths of a second."""
    meeting = 7.0 * speed
    back = (7.0 + late) * crossing
    other = steady(meeting - back * math.cos(angle), -back * math.sin(angle), crossing, yaw=angle)
    compare(steady(0.0, 0.0, speed), other, friction)


def compare(ego: Motion, other: Motion, friction: float) -> None:
    """Both replays find the same last row, within one, of another that is 1 cm larger or smaller.

    An ego that brakes at walking pace stops in nearly the same place from several rows, so that the
    last of them is a matter of millimetres.
    """
    try:
        trace = collision(ego, other)
    except AssertionError:
        reject()
    latest = careful_braking(cut(trace), CarefulDriver(), friction * 9.81, math.inf)
    (contact,) = trace.contacts
    rows = range(contact.step - 1, -1, -1)
    least, most = (
        next((row for row in rows if avoids(trace, row, friction, larger)), -1)
        for larger in (0.01, -0.01)
    )
    assert least - 1 <= latest <= most + 1
