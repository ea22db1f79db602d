"""Halts of the ego: lights, right of way, junctions that are not clear; compiled.

Frame: the network's plane, metres, radians counter-clockwise from east; arc lengths are those of
the lane run that the agent follows.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray

HARD_BRAKING = 4.5
PATIENCE = 6.0
_GAP_MARGIN = 1.6
"""Seconds between the ego's passage of a conflict zone and another's."""
_START_ACCELERATION = 1.6


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
    """Returns whether the ego must wait for an actor on the foe's way before a conflict zone.

    Args:
        to_zone: Metres from the ego's front bumper to its beginning.
        to_end: Metres from the ego's rear bumper to its end.
        v: Speed of the ego, m/s.
        wanted: Desired speed through the zone, m/s.
        yields: Whether actors that approach on that way have priority; else only those in the zone.
        waited: Seconds for which the ego has stood, after which it does not wait for standing
            actors.
        line: (n, 3) x, y and arc length along the foe's way, metres.
        foe_enter: Arc length on it at which the zone begins.
        foe_leave: Arc length at which it ends.
        objects: (n, 9) perceived actors.
        sizes: (n, 2) metres.
        kinds: (n,).
        count: Number of actors.
    """
    a = _START_ACCELERATION
    # Times to reach and to clear the zone, accelerating to the desired speed.
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
            # Each waits for the other; an actor that is really in the way ends the corridor ahead.
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
            # It stands before the zone: it could start during the ego's passage only if very near.
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
    """Finds the distance to the next halt: lights, the end of the lane, the right of way.

    Args:
        v: The ego's speed, m/s.
        s: Arc length of its centre, metres.
        wanted: Its desired speed, m/s.
        gap, other, index: The actor ahead, as returned by ``gap_on_line``.
        waited, light_distance, light, protected, objects, sizes, kinds, half_length, wall, zones,
            first, foes: As for ``decide``.

    Returns:
        Metres; inf without a halt.
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
            # Already in it: only the corridor ahead counts now.
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
                # Too short to wait there: the tail would stand on the stop line.
                held = max(gate - front - 0.5, 0.0)
            stop = min(stop, held)
        elif gate - front > -0.5 and index >= 0 and other < 1.5:
            # Do not stop in the junction behind an actor that stands beyond it.
            rear_of_other = front + gap
            if leaves_junction - 2.0 < rear_of_other < leaves_junction + 2.0 * half_length + 1.5:
                stop = min(stop, max(gate - front - 0.5, 0.0))
    return stop
