"""Halts of the ego: lights, right of way, junctions that are not clear; compiled.

Frame: the network's plane, metres, radians counter-clockwise from east; arc lengths are those of
the lane run that the agent follows.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivora_service.agents.idm.conflicts import Conflicts, LineCol, ZoneCol
from drivora_service.agents.idm.corridor import Actors, Ahead
from drivora_service.agents.interface import ObjectKind, Observation
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col, Light, SizeCol

HARD_BRAKING = 4.5
PATIENCE = 6.0
_GAP_MARGIN = 1.6
"""Seconds between the ego's passage of a conflict zone and another's."""
_START_ACCELERATION = 1.6


class Signal(NamedTuple):
    """The next signal, as in ``Observation``.

    Attributes:
        distance: Metres from the front bumper to its stop line; inf if there is none.
        state: ``Light``.
        protected: Whether a green light gives the right of way.
    """

    distance: float
    state: int
    protected: bool


def next_signal(observation: Observation) -> Signal:
    """Returns the next signal of an observation."""
    return Signal(observation.light_distance, int(observation.light), observation.light_protected)


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
    actors: Actors,
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
        line: (n, 3) the foe's way, columns ``LineCol``.
        foe_enter: Arc length on it at which the zone begins.
        foe_leave: Arc length at which it ends.
        actors: The perceived actors.
    """
    objects, sizes, kinds = actors.objects, actors.sizes, actors.kinds
    a = _START_ACCELERATION
    # Times to reach and to clear the zone, accelerating to the desired speed.
    t_reach = _travel_time(max(to_zone, 0.0), v, wanted, a)
    t_clear = _travel_time(max(to_end, 0.0), v, wanted, a)
    for j in range(objects.shape[0]):
        if kinds[j] != ObjectKind.VEHICLE:
            continue
        x, y = objects[j, Col.X], objects[j, Col.Y]
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
        heading = math.cos(objects[j, Col.YAW]) * ux + math.sin(objects[j, Col.YAW]) * uy
        if side > 1.9 or heading < 0.5:
            continue
        at = line[best_i, LineCol.ARC] + best_t
        half = 0.5 * sizes[j, SizeCol.LENGTH]
        if at - half > foe_leave + 0.5:
            continue
        speed = max(objects[j, Col.VX] * ux + objects[j, Col.VY] * uy, 0.0)
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
    signal: Signal,
    actors: Actors,
    half_length: float,
    wall: float,
    conflicts: Conflicts,
    ahead: Ahead,
) -> float:
    """Finds the distance to the next halt: lights, the end of the lane, the right of way.

    Args:
        v: The ego's speed, m/s.
        s: Arc length of its centre, metres.
        wanted: Its desired speed, m/s.
        waited: Seconds that the ego has stood; decreases while it moves.
        signal: The next signal.
        actors: The perceived actors.
        half_length: Of the ego, metres.
        wall: Arc length before which the lane must have been left; inf if there is none.
        conflicts: Of the lane run.
        ahead: The actor ahead.

    Returns:
        Metres; inf without a halt.
    """
    zones, first, foes = conflicts.zones, conflicts.first, conflicts.foes
    front = s + half_length
    stop = np.inf
    is_red = signal.state == Light.RED
    if is_red or signal.state == Light.YELLOW:
        # A yellow light is passed if comfortable braking would not stop the ego before the line; a
        # red one if not even hard braking would.
        needed = v * v / (2.0 * max(signal.distance, 0.1))
        if signal.distance > -0.5 and (is_red or needed < 3.0) and needed < HARD_BRAKING + 3.0:
            stop = max(signal.distance - 0.5, 0.0)
    if wall < np.inf:
        stop = min(stop, max(wall - front, 0.0))
    for z in range(zones.shape[0]):
        zone = zones[z]
        enter, leave = zone[ZoneCol.ENTER], zone[ZoneCol.LEAVE]
        gate, leaves_junction = zone[ZoneCol.GATE], zone[ZoneCol.EXIT]
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
        yields = zone[ZoneCol.YIELDS] > 0.0
        if zone[ZoneCol.SIGNALISED] > 0.0 and gate - front > -1.0 and signal.protected:
            yields = False
        if must_wait(
            to_zone,
            leave - (s - half_length),
            v,
            min(wanted, 9.0) if wanted > 3.0 else 3.0,
            yields,
            waited,
            foes[first[z] : first[z + 1]],
            zone[ZoneCol.FOE_ENTER],
            zone[ZoneCol.FOE_LEAVE],
            actors,
        ):
            if front - gate < 0.5 and enter - 1.2 - 2.0 * half_length < gate:
                # Too short to wait there: the tail would stand on the stop line.
                held = max(gate - front - 0.5, 0.0)
            stop = min(stop, held)
        elif gate - front > -0.5 and ahead.row >= 0 and ahead.speed < 1.5:
            # Do not stop in the junction behind an actor that stands beyond it.
            rear_of_other = front + ahead.gap
            if leaves_junction - 2.0 < rear_of_other < leaves_junction + 2.0 * half_length + 1.5:
                stop = min(stop, max(gate - front - 0.5, 0.0))
    return stop


@compiled
def find_halts(
    v: float,
    s: float,
    wanted: FloatArray,
    waited: float,
    signal: Signal,
    actors: Actors,
    half_length: float,
    wall: float,
    conflicts: Conflicts,
    ahead: Ahead,
    halts: FloatArray,
) -> None:
    """Finds the distances to the next halt at several desired speeds.

    Args:
        wanted: (n,) desired speeds, m/s.
        halts: (n,) filled, metres; inf without a halt.
        v, s, waited, signal, actors, half_length, wall, conflicts, ahead: As for ``find_halt``.
    """
    for k in range(wanted.shape[0]):
        halts[k] = find_halt(
            v, s, wanted[k], waited, signal, actors, half_length, wall, conflicts, ahead
        )
