"""The rules for vehicles side by side, on neighbouring lanes or in one."""

from __future__ import annotations

import math

from drivora_service.geometry import elementary
from drivora_service.observations.trace import Col
from drivora_service.oracles.responsibility.finding import Finding, undetermined
from drivora_service.oracles.responsibility.impact import Face
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.scene import Scene

_AT_ONCE = 1.0
"""Difference in seconds up to which two came into a lane at the same time: less than the time to
react (1.15 s), in which neither could answer to the other."""

_WANDER = 0.375
"""Metres sideways from which on a vehicle leaves its place in the lane (UNECE R157, annex 3)."""

_MANOEUVRE = 4.0
"""Seconds before a contact in which moving sideways is part of what led to it."""

_LINE = 0.1
"""Metres around a line between lanes within which a touch is on the line."""


def side_by_side(scene: Scene) -> Finding:
    """The party that came into the lane of the other is responsible."""
    # On the line between two lanes, each party in one of them: neither came over to the other.
    near = [
        lane
        for lane in scene.areas.drivable_at(scene.impact.place, _LINE)
        if not scene.network.lanes[lane].is_internal
    ]
    if len(near) > 1 and not all(
        scene.areas.areas[lane].intersects(party.boxes[-1].centroid.buffer(0.01))
        for lane in near
        for party in (scene.ego, scene.other)
    ):
        own = {int(party.lanes[-1]) for party in (scene.ego, scene.other)}
        if len(own) == 2 and own <= set(near):
            return undetermined("side_by_side", "they touched on the line between their lanes")
    lanes = scene.road_lanes()
    if not lanes:
        return undetermined("none", "no rule applies")
    area = scene.areas.union(scene.lane_chain())
    heading = scene.areas.heading(lanes[0], scene.impact.place)
    # Rows of the trace at which each came in; -1, before all others, if it always was inside.
    entries = {}
    for party in (scene.ego, scene.other):
        k = party.entry(area, heading)
        entries[party] = scene.step if k is None else party.step(k)
        if k == 0 and party.from_beginning:
            entries[party] = -1
    first, later = sorted(entries, key=lambda party: entries[party])
    apart = (entries[later] - max(entries[first], 0)) * scene.trace.step_length
    if entries[first] == entries[later] or (entries[first] >= 0 and apart <= _AT_ONCE):
        if entries[first] >= 0:
            return undetermined("side_by_side", "both came into the lane at the same time")
        return _beside_in_one_lane(scene)
    if scene.face(first) is Face.FRONT and scene.could_brake(first, entries[later]):
        return Finding(
            rule="following",
            fault=scene.fault_of(first),
            reason=f"{scene.name(later)} came into the lane early enough to keep clear of it",
        )
    return Finding(
        rule="side_by_side",
        fault=scene.fault_of(later),
        reason=f"{scene.name(later)} came into the lane of {scene.name(first)}",
        since=max(entries[later], 0),
    )


def _beside_in_one_lane(scene: Scene) -> Finding:
    """Of two that were in one lane all along, the one that left its place in it is responsible.

    If none did, the one that passes the other (Vienna Convention, article 11.4: it leaves enough
    room).
    """
    parties = (scene.ego, scene.other)
    moved = [party for party in parties if came_over(scene, party)]
    if len(moved) == 1:
        return Finding(
            rule="side_by_side",
            fault=scene.fault_of(moved[0]),
            reason=f"{scene.name(moved[0])} came over to {scene.name(scene.opposite(moved[0]))} "
            "in the lane",
            since=max(scene.step - round(_MANOEUVRE / scene.trace.step_length), 0),
        )
    passing = [party for party in parties if _was_behind(scene, party)]
    if not moved and len(passing) == 1:
        return Finding(
            rule="side_by_side",
            fault=scene.fault_of(passing[0]),
            reason=f"{scene.name(passing[0])} passed too close",
        )
    return undetermined("side_by_side", "both were in the lane from the beginning")


def came_over(scene: Scene, party: Party) -> bool:
    """Returns whether a party left its place in the lane towards the other just before."""
    other = scene.opposite(party)
    dx, dy = (party.states[-1] - other.states[-1])[[Col.X, Col.Y]]
    moved = party.sideways(_MANOEUVRE, other.yaw)
    # Metres to the left of the other's line before it moved.
    began = dy * math.cos(other.yaw) - dx * math.sin(other.yaw) - moved
    return abs(moved) > _WANDER and began * moved < 0.0


def _was_behind(scene: Scene, party: Party) -> bool:
    """Returns whether a party was behind the other as a whole, and has come up beside it."""
    other = scene.opposite(party)
    rows = min(party.count, other.count)
    apart = (other.states[-rows:] - party.states[-rows:])[:, [Col.X, Col.Y]]
    yaw = other.states[-rows:, Col.YAW]
    along = apart[:, 0] * elementary.cos(yaw) + apart[:, 1] * elementary.sin(yaw)
    return bool((along > 0.5 * (party.actor.length + other.actor.length)).any())
