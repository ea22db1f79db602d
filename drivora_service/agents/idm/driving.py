"""The decisions of the intelligent-driver agent, compiled: one call a step.

Frame: the network's plane, metres, radians counter-clockwise from east; arc lengths are those of
the lane run that the agent follows.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from drivora_service.compilation import compiled
from drivora_service.networks.line_tracking import track_line

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MAX_ACCELERATION = 1.8
COMFORTABLE_BRAKING = 2.5
TIME_HEADWAY = 1.3
STANDSTILL_GAP = 2.0
_LOOK_AHEAD = 90.0
SIDE_ROOM = 0.35
TIGHT_ROOM = 0.08
"""Metres that are enough to creep past somebody who stands."""
HARD_BRAKING = 4.5
_GAP_MARGIN = 1.6
"""Seconds between another's passage of a conflict zone and ours."""
_START_ACCELERATION = 1.6
_WALKER_HORIZON = 3.5
DRIVING_JERK = 3.0
BRAKING_JERK = 8.0
PATIENCE = 6.0
_LEAST_PREVIEW = 3.5
_PREVIEW_TIME = 0.6


@compiled
def point_at(line: FloatArray, arc: FloatArray, cursor: int, s: float) -> tuple[float, float]:
    """Gives the point at arc length ``s``; beyond the end, straight on."""
    i = cursor
    n = line.shape[0]
    while i < n - 2 and arc[i + 1] < s:
        i += 1
    while i > 0 and arc[i] > s:
        i -= 1
    t = (s - arc[i]) / max(arc[i + 1] - arc[i], 1e-9)
    return (
        line[i, 0] + t * (line[i + 1, 0] - line[i, 0]),
        line[i, 1] + t * (line[i + 1, 1] - line[i, 1]),
    )


@compiled
def follow(v: float, wanted: float, gap: float, other: float, max_braking: float) -> float:
    """Gives the acceleration of the intelligent driver model (Treiber, Hennecke, Helbing 2000)."""
    closing = v * (v - other) / (2.0 * math.sqrt(MAX_ACCELERATION * COMFORTABLE_BRAKING))
    space = STANDSTILL_GAP + max(0.0, v * TIME_HEADWAY + closing)
    free = (v / max(wanted, 0.1)) ** 4
    a = MAX_ACCELERATION * (1.0 - free - (space / max(gap, 0.1)) ** 2)
    return max(a, -max_braking)


@compiled
def halt(v: float, wanted: float, distance: float, max_braking: float) -> float:
    """Gives the acceleration that stops the front bumper at a line ``distance`` metres ahead."""
    if distance < 0.3:
        return -max_braking if v > 0.2 else -1.0
    needed = v * v / (2.0 * distance)
    approach = follow(v, wanted, distance + STANDSTILL_GAP - 0.8, 0.0, max_braking)
    return max(min(approach, MAX_ACCELERATION), -max(needed * 1.3, 2.0))


@compiled
def gap_on_line(
    line: FloatArray,
    arc: FloatArray,
    cursor: int,
    s: float,
    reach: float,
    half_length: float,
    half_width: float,
    side_room: float,
    v: float,
    objects: FloatArray,
    sizes: FloatArray,
    kinds: IntArray,
    count: int,
) -> tuple[float, float, int]:
    """Finds what ends the free corridor ahead: gap in metres, its speed along it, its index.

    The corridor is ``side_room`` metres wider on each side than the vehicle.
    """
    best, best_speed, best_j = np.inf, 0.0, -1
    for j in range(count):
        x, y = objects[j, 0], objects[j, 1]
        radius = 0.5 * math.hypot(sizes[j, 0], sizes[j, 1])
        px, py = line[cursor, 0], line[cursor, 1]
        if math.hypot(x - px, y - py) > reach + radius + half_length:
            continue
        near, near_i = np.inf, -1
        cos, sin = math.cos(objects[j, 2]), math.sin(objects[j, 2])
        ahead_hit, ahead_speed = np.inf, 0.0
        for i in range(cursor, line.shape[0] - 1):
            at = arc[i] - s
            if at > reach + radius:
                break
            dx, dy = x - line[i, 0], y - line[i, 1]
            d2 = dx * dx + dy * dy
            if d2 < near:
                near, near_i = d2, i
            if d2 > (radius + half_width + 2.5) ** 2:
                continue
            ux, uy = line[i + 1, 0] - line[i, 0], line[i + 1, 1] - line[i, 1]
            span = math.sqrt(ux * ux + uy * uy)
            if span < 1e-9:
                continue
            ux, uy = ux / span, uy / span
            along, side = dx * ux + dy * uy, -dx * uy + dy * ux
            c, d = abs(cos * ux + sin * uy), abs(sin * ux - cos * uy)
            extent = 0.5 * (sizes[j, 0] * c + sizes[j, 1] * d)
            across = 0.5 * (sizes[j, 0] * d + sizes[j, 1] * c)
            if abs(along) > 1.0 or abs(side) > half_width + across + side_room:
                continue
            gap = at + along - half_length - extent
            if at + along < -half_length:
                continue
            if gap < ahead_hit:
                ahead_hit = gap
                ahead_speed = objects[j, 3] * ux + objects[j, 4] * uy
        if near_i >= 0 and ahead_hit == np.inf:
            # Not in the corridor yet: a walker who comes towards it, or a vehicle that cuts in.
            i = near_i
            ux, uy = line[i + 1, 0] - line[i, 0], line[i + 1, 1] - line[i, 1]
            span = math.sqrt(ux * ux + uy * uy)
            if span > 1e-9:
                ux, uy = ux / span, uy / span
                dx, dy = x - line[i, 0], y - line[i, 1]
                side = -dx * uy + dy * ux
                towards = -(-objects[j, 3] * uy + objects[j, 4] * ux) * math.copysign(1.0, side)
                d = abs(sin * ux - cos * uy)
                c = abs(cos * ux + sin * uy)
                across = 0.5 * (sizes[j, 0] * d + sizes[j, 1] * c) + half_width + side_room
                at = arc[i] - s - half_length - radius
                horizon = _WALKER_HORIZON if kinds[j] == 1 else 1.2
                if towards > 0.3 and at > -half_length:
                    t_in = (abs(side) - across) / towards
                    t_out = (abs(side) + across) / towards
                    t_here = max(at, 0.0) / max(v, 1.0)
                    if t_in < horizon and t_in < t_here + 1.5 and t_out > t_here - 1.0:
                        ahead_hit = at
                        ahead_speed = objects[j, 3] * ux + objects[j, 4] * uy
        if ahead_hit < best:
            best, best_speed, best_j = ahead_hit, ahead_speed, j
    return best, best_speed, best_j


@compiled
def must_wait(
    to_zone: float,
    to_end: float,
    v: float,
    wanted: float,
    yields: bool,
    waited: float,
    line: FloatArray,
    foe_enter: float,
    foe_leave: float,
    objects: FloatArray,
    sizes: FloatArray,
    kinds: IntArray,
    count: int,
) -> bool:
    """Says whether somebody on the foe's way makes us wait before a conflict zone.

    Args:
        to_zone: Metres from our front bumper to its beginning.
        to_end: Metres from our rear bumper to its end.
        v: Our speed, m/s.
        wanted: The speed we would drive through it at, m/s.
        yields: Whether those who approach on that way go first; else only those in the zone do.
        waited: Seconds that we have stood: after some, others who stand as well are not waited for.
        line: (n, 3) x, y and arc length along the foe's way, metres.
        foe_enter: Arc length on it where the zone begins.
        foe_leave: Where it ends.
        objects: (n, 9) perceived actors.
        sizes: (n, 2) metres.
        kinds: (n,).
        count: How many of them there are.
    """
    a = _START_ACCELERATION
    # Times to reach and to clear the zone, speeding up to what we would drive.
    t_reach = _travel_time(max(to_zone, 0.0), v, wanted, a)
    t_clear = _travel_time(max(to_end, 0.0), v, wanted, a)
    for j in range(count):
        if kinds[j] != 0:
            continue
        x, y = objects[j, 0], objects[j, 1]
        best, best_i, best_t = 9.0, -1, 0.0
        for i in range(line.shape[0] - 1):
            dx, dy = x - line[i, 0], y - line[i, 1]
            d2 = dx * dx + dy * dy
            if d2 < best:
                best, best_i = d2, i
        if best_i < 0:
            continue
        ux, uy = line[best_i + 1, 0] - line[best_i, 0], line[best_i + 1, 1] - line[best_i, 1]
        span = math.sqrt(ux * ux + uy * uy)
        if span < 1e-9:
            continue
        ux, uy = ux / span, uy / span
        best_t = (x - line[best_i, 0]) * ux + (y - line[best_i, 1]) * uy
        side = abs(-(x - line[best_i, 0]) * uy + (y - line[best_i, 1]) * ux)
        heading = math.cos(objects[j, 2]) * ux + math.sin(objects[j, 2]) * uy
        if side > 1.9 or heading < 0.5:
            continue
        at = line[best_i, 2] + best_t
        half = 0.5 * sizes[j, 0]
        if at - half > foe_leave + 0.5:
            continue
        speed = max(objects[j, 3] * ux + objects[j, 4] * uy, 0.0)
        if speed < 0.3 and waited > PATIENCE:
            # Each waits for the other: whoever really stands in our way ends the corridor ahead.
            continue
        front_gap = foe_enter - (at + half)
        rear_gap = foe_leave + 0.5 - (at - half)
        if front_gap <= 0.5:
            # In the zone, or about to enter it.
            t_out = rear_gap / max(speed, 0.8)
            if t_out > t_reach - 0.6:
                return True
            continue
        if not yields:
            continue
        if speed < 0.4:
            # It stands before the zone: it may start when we are in it only if it is very near.
            if front_gap < 3.0 and t_clear > 2.5:
                return True
            continue
        t_in = front_gap / max(speed, 0.5)
        t_out = rear_gap / max(speed, 0.5)
        if t_in < t_clear + _GAP_MARGIN and t_out > t_reach - 0.8:
            return True
    return False


@compiled
def _travel_time(distance: float, v: float, wanted: float, a: float) -> float:
    if distance <= 0.0:
        return 0.0
    top = max(wanted, v, 1.0)
    ramp = max((top * top - v * v) / (2.0 * a), 0.0)
    if distance <= ramp:
        return (math.sqrt(v * v + 2.0 * a * distance) - v) / a
    return (top - v) / a + (distance - ramp) / top


@compiled
def lane_is_free(
    line: FloatArray,
    arc: FloatArray,
    cursor: int,
    s: float,
    v: float,
    half_length: float,
    objects: FloatArray,
    sizes: FloatArray,
    count: int,
) -> bool:
    """Says whether a neighbouring lane has room beside us: nobody near, nobody closing in."""
    for j in range(count):
        x, y = objects[j, 0], objects[j, 1]
        if math.hypot(x - line[cursor, 0], y - line[cursor, 1]) > 80.0:
            continue
        best, best_i = 4.0, -1
        for i in range(max(cursor - 70, 0), min(cursor + 70, line.shape[0] - 1)):
            d2 = (x - line[i, 0]) ** 2 + (y - line[i, 1]) ** 2
            if d2 < best:
                best, best_i = d2, i
        if best_i < 0:
            continue
        ux, uy = line[best_i + 1, 0] - line[best_i, 0], line[best_i + 1, 1] - line[best_i, 1]
        span = max(math.sqrt(ux * ux + uy * uy), 1e-9)
        speed = (objects[j, 3] * ux + objects[j, 4] * uy) / span
        distance = arc[best_i] - s
        room = abs(distance) - half_length - 0.5 * sizes[j, 0]
        if distance >= 0.0:
            if room < 3.0 + 0.3 * v + max(v - speed, 0.0) * 2.0:
                return False
        elif room < 5.0 + 0.3 * speed + max(speed - v, 0.0) * 3.5:
            return False
    return True


@compiled
def find_halt(
    v: float,
    s: float,
    wanted: float,
    waited: float,
    light_distance: float,
    light: int,
    protected: bool,
    objects: FloatArray,
    sizes: FloatArray,
    kinds: IntArray,
    half_length: float,
    wall: float,
    zones: FloatArray,
    first: IntArray,
    foes: FloatArray,
    gap: float,
    other: float,
    index: int,
) -> float:
    """Finds how far the front bumper may go: lights, the end of the lane, the right of way.

    Args:
        v: The ego's speed, m/s.
        s: Arc length of its centre, metres.
        wanted: The speed that it would drive, m/s.
        gap, other, index: What is ahead, as ``gap_on_line`` gives it.
        waited, light_distance, light, protected, objects, sizes, kinds, half_length, wall, zones,
            first, foes: As ``decide`` takes them.

    Returns:
        Metres; inf where nothing asks for a halt.
    """
    count = objects.shape[0]
    front = s + half_length
    stop = np.inf
    if light == 3 or light == 2:
        needed = v * v / (2.0 * max(light_distance, 0.1))
        if light_distance > -0.5 and (light == 3 or needed < 3.0) and needed < HARD_BRAKING + 3.0:
            stop = max(light_distance - 0.5, 0.0)
    if wall < np.inf:
        stop = min(stop, max(wall - front, 0.0))
    for z in range(zones.shape[0]):
        zone = zones[z]
        enter, leave, gate, leaves_junction = zone[0], zone[1], zone[2], zone[3]
        to_zone = enter - front
        if leave < s - half_length:
            continue
        if to_zone > 12.0 + 2.5 * v + v * v / 4.0:
            break
        if to_zone < -1.0:
            # Already in it: the corridor ahead is all that counts now.
            continue
        held = max(to_zone - 1.2, 0.0)
        if v * v / (2.0 * max(held, 0.05)) > HARD_BRAKING and v > 1.0:
            continue
        yields = zone[4] > 0.0
        if zone[5] > 0.0 and gate - front > -1.0 and protected:
            yields = False
        if must_wait(
            to_zone,
            leave - (s - half_length),
            v,
            min(wanted, 9.0) if wanted > 3.0 else 3.0,
            yields,
            waited,
            foes[first[z] : first[z + 1]],
            zone[6],
            zone[7],
            objects,
            sizes,
            kinds,
            count,
        ):
            if front - gate < 0.5 and enter - 1.2 - 2.0 * half_length < gate:
                # Too short a place to wait in: the tail would still stand on the stop line.
                held = max(gate - front - 0.5, 0.0)
            stop = min(stop, held)
        elif gate - front > -0.5 and index >= 0 and other < 1.5:
            # Do not stop in the junction behind somebody who stands beyond it.
            rear_of_other = front + gap
            if leaves_junction - 2.0 < rear_of_other < leaves_junction + 2.0 * half_length + 1.5:
                stop = min(stop, max(gate - front - 0.5, 0.0))
    return stop


@compiled
def preview(v: float, wheelbase: float) -> float:
    """Gives how far before the rear axle the point lies that is steered at, metres."""
    return max(_LEAST_PREVIEW, 0.5 * wheelbase + _PREVIEW_TIME * v)


@compiled
def steer_at(tx: float, ty: float, x: float, y: float, yaw: float, wheelbase: float) -> float:
    """Gives the front-wheel angle that leads to a point, by pure pursuit (Coulter 1992).

    It leads the rear axle: led by its centre, a car cuts its corners.

    Args:
        tx, ty: The point, metres.
        x, y, yaw: The car's centre and heading.
        wheelbase: Metres.
    """
    rear_x, rear_y = x - 0.5 * wheelbase * math.cos(yaw), y - 0.5 * wheelbase * math.sin(yaw)
    dx, dy = tx - rear_x, ty - rear_y
    angle = math.atan2(dy, dx) - yaw
    curvature = 2.0 * math.sin(angle) / max(math.hypot(dx, dy), 1.0)
    return math.atan(wheelbase * curvature)


@compiled
def decide(
    v: float,
    cursor: int,
    waited: float,
    light_distance: float,
    light: int,
    protected: bool,
    ego: FloatArray,
    objects: FloatArray,
    sizes: FloatArray,
    kinds: IntArray,
    car: FloatArray,
    wall: float,
    way: FloatArray,
    zones: FloatArray,
    first: IntArray,
    foes: FloatArray,
    out: FloatArray,
) -> int:
    """Decides on acceleration and steering.

    Args:
        v: The ego's speed.
        cursor: Segment of ``way`` found a step ago.
        waited: Seconds that the ego has stood; runs down again while it moves.
        light_distance, light, protected: The next signal, as in ``Observation``.
        ego: (9,) the ego's state.
        objects, sizes, kinds: Perceived actors.
        car: (5,) half length, half width and wheelbase of the ego in metres, its hardest braking in
            m/s², positive, and seconds a step.
        wall: Arc length before which the lane must have been left; inf where there is none.
        way: (n, 4) x, y and arc length of the centre line of the lane run, and the speed to drive
            at each point, m/s.
        zones, first, foes: ``Conflicts`` of the run.
        out: (8,) of the step before; filled: acceleration, steer, gap to what is ahead, its speed,
            index of it, metres to where we must halt, lateral offset, wanted speed.

    Returns:
        The segment found now.
    """
    x, y, yaw = ego[0], ego[1], ego[2]
    half_length, half_width, wheelbase = car[0], car[1], car[2]
    max_braking, dt = car[3], car[4]
    line, arc, profile = way[:, :2], way[:, 2], way[:, 3]
    count = objects.shape[0]
    cursor, s, lateral = track_line(line, arc, cursor, 5, 30, x, y)
    wanted = profile[cursor]
    gap, other, index = gap_on_line(
        line,
        arc,
        cursor,
        s,
        min(_LOOK_AHEAD, 25.0 + 4.0 * v),
        half_length,
        half_width,
        SIDE_ROOM if waited < PATIENCE else TIGHT_ROOM,
        v,
        objects,
        sizes,
        kinds,
        count,
    )
    acceleration = follow(v, wanted, gap, other, max_braking)
    stop = find_halt(
        v,
        s,
        wanted,
        waited,
        light_distance,
        light,
        protected,
        objects,
        sizes,
        kinds,
        half_length,
        wall,
        zones,
        first,
        foes,
        gap,
        other,
        index,
    )
    if stop < np.inf:
        acceleration = min(acceleration, halt(v, wanted, stop, max_braking))
    acceleration = min(acceleration, MAX_ACCELERATION)
    if acceleration > -HARD_BRAKING:
        # As a calm foot moves the pedals; in need, the brake is stamped on.
        calm = max(acceleration, out[0] - BRAKING_JERK * dt)
        acceleration = min(calm, out[0] + DRIVING_JERK * dt)
    out[0] = acceleration
    tx, ty = point_at(line, arc, cursor, s - 0.5 * wheelbase + preview(v, wheelbase))
    out[1] = steer_at(tx, ty, x, y, yaw, wheelbase)
    out[2] = gap
    out[3] = other
    out[4] = float(index)
    out[5] = stop
    out[6] = lateral
    out[7] = wanted
    return cursor
