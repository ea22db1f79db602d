"""The rules for vehicles on a road: opposite directions, crossing, following, side by side."""

from __future__ import annotations

from drivora_service.oracles.responsibility.finding import Fault, Finding
from drivora_service.oracles.responsibility.impact import Face
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.required_braking import REACTION, could_brake
from drivora_service.oracles.responsibility.scene import AGAINST, ALONG, ASTRAY, Scene

_RETURNED = 2.5
"""Seconds for which it counts that a vehicle was in the wrong lane: long enough for the one that it
met to react (1.15 s) and to steer aside."""

_AT_ONCE = 1.0
"""Difference in seconds up to which two came into a lane at the same time: less than the time to
react (1.15 s), in which neither could answer to the other."""

_LINE = 0.1
"""Metres around a line between lanes within which a touch is on the line."""


def opposite_directions(scene: Scene) -> Finding | None:
    """Of vehicles that face each other, the one in the lane of the other is responsible."""
    if scene.angle < AGAINST:
        return None
    astray = {party: scene.astray(party) > ASTRAY for party in (scene.ego, scene.other)}
    if all(astray.values()):
        return _unknown("opposite_directions", "both were in the lane of the other direction")
    for party, is_astray in astray.items():
        if not is_astray:
            continue
        other = scene.opposite(party)
        if _came_back(other, party):
            return _unknown(
                "opposite_directions",
                f"{scene.name(party)} was in the lane of the other direction, which "
                f"{scene.name(other)} had left until a moment before",
            )
        # An ego has to brake for what stands, in whichever lane. The reverse does not hold: an ego
        # that has stopped in the lane of the other direction is responsible for being there.
        if scene.stands(party) and party is scene.other:
            since = scene.step - round(party.stood / party.step_length)
            if scene.could_brake(other, since):
                return Finding(
                    rule="standing",
                    fault=scene.fault_of(other),
                    reason=f"{scene.name(party)} stood, and there was time to brake",
                )
        verb = "stood" if scene.stands(party) else "drove"
        return Finding(
            rule="opposite_directions",
            fault=scene.fault_of(party),
            reason=f"{scene.name(party)} {verb} in the lane of the other direction",
        )
    return None


def _came_back(party: Party, other: Party) -> bool:
    """Returns whether a vehicle was in the wrong lane shortly before, and the other evaded it."""
    rows = round(_RETURNED / party.step_length)
    wrong = [k for k in range(max(0, party.count - rows), party.count) if _is_wrong(party, k)]
    if not wrong:
        return False
    # Evaded only if it was in a lane of its own direction until then, which it left since.
    step = party.step(wrong[0])
    k = min(max(step - other.first, 0), other.count - 1)
    return other.with_lane[k] or any(other.with_lane[k:])


def _is_wrong(party: Party, k: int) -> bool:
    return int(party.lanes[k]) >= 0 and not party.with_lane[k]


def across(scene: Scene) -> Finding | None:
    """A vehicle that goes across the lane of the other is responsible."""
    lanes = scene.road_lanes()
    if not lanes:
        return None
    crossing = [
        party
        for party in (scene.ego, scene.other)
        if all(
            ALONG < scene.areas.turn(lane, scene.impact.place, party.yaw) < AGAINST
            for lane in lanes
        )
    ]
    if not crossing or any(scene.stands(party) for party in crossing):
        return None
    if len(crossing) == 2:
        return _unknown("across", "both went across the lane")
    (party,) = crossing
    other = scene.opposite(party)
    # RSS, rule 3: right of way is given, not taken. So the one that had it is responsible if its
    # front hit what it could have braked for; not if it was run into.
    entered = _entry_step(scene, party, other)
    if scene.face(other) is Face.FRONT and scene.could_brake(other, entered):
        return Finding(
            rule="across",
            fault=scene.fault_of(other),
            reason=f"{scene.name(party)} went across the lane, and there was time to brake",
        )
    return Finding(
        rule="across",
        fault=scene.fault_of(party),
        reason=f"{scene.name(party)} went across the lane of {scene.name(other)}",
    )


def _entry_step(scene: Scene, party: Party, other: Party) -> int:
    """Returns the row of the trace at which a party came into the way of the other."""
    k = party.entry(scene.way(other), other.yaw)
    return scene.step if k is None else party.step(k)


def one_behind_the_other(scene: Scene) -> Finding | None:
    """The party behind is responsible, unless the party ahead cut in too close before it."""
    behind = _behind(scene)
    if behind is None:
        return None
    ahead = scene.opposite(behind)
    k = ahead.entry(scene.way(behind), behind.yaw)
    if k is None:
        # Its box hardly reaches into the way: it stands there at the edge, or comes in right now.
        k = 0 if ahead.stood > 0.0 else ahead.count - 1
    is_here = "stood" if scene.stands(ahead) else "was ahead"
    # An actor that was present when the record began had been seen before: braking needs no time
    # to react then, which would only be granted for what could not be foreseen.
    is_known = k == 0 and ahead.from_beginning
    if could_brake(behind, ahead, ahead.step(k), 0.0 if is_known else REACTION):
        return Finding(
            rule="standing" if scene.stands(ahead) else "following",
            fault=scene.fault_of(behind),
            reason=f"{scene.name(ahead)} {is_here}, and there was time to brake",
        )
    # Too near from the first row on: by whose doing is not recorded, so no ego is blamed for it;
    # neither is an ego that had only been ahead.
    if is_known and behind is scene.ego:
        return _unknown("too_near", "the record begins too late to tell: they were too near then")
    if is_known:
        return Finding(
            rule="following",
            fault=scene.fault_of(behind),
            reason=f"{scene.name(ahead)} was ahead from the beginning",
        )
    entry = ahead.step(k)
    came = "appeared" if k == 0 and ahead.appeared else "came into the lane"
    seconds = (scene.step - entry) * scene.trace.step_length
    return Finding(
        rule="cut_in",
        fault=scene.fault_of(ahead),
        reason=f"{scene.name(ahead)} {came} {seconds:.1f} s before, too late to brake for",
    )


def _behind(scene: Scene) -> Party | None:
    """Returns the party behind, None if neither is.

    One that moves is behind what stands, in any direction, unless it was touched at its rear. Of
    two that move in about the same direction it is the one that touched with its front, unless it
    touched the side of a party that came over from another lane: those drove side by side.
    """
    ego, other = scene.ego, scene.other
    if scene.stands(other) and not scene.stands(ego):
        return ego if scene.face(ego) is not Face.REAR else None
    if scene.stands(ego) and not scene.stands(other):
        return other if scene.face(other) is not Face.REAR else None
    if scene.angle > ALONG:
        return None
    if scene.face(ego) is Face.FRONT and scene.face(other) is not Face.FRONT:
        return ego if scene.face(other) is Face.REAR or not _has_moved_over(scene, other) else None
    if scene.face(other) is Face.FRONT and scene.face(ego) is not Face.FRONT:
        return other if scene.face(ego) is Face.REAR or not _has_moved_over(scene, ego) else None
    return None


def _has_moved_over(scene: Scene, party: Party) -> bool:
    """Returns whether a party whose side was touched came from another lane."""
    return party.entry(scene.way(scene.opposite(party)), scene.opposite(party).yaw) != 0


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
            return _unknown("side_by_side", "they touched on the line between their lanes")
    lanes = scene.road_lanes()
    if not lanes:
        return _unknown("none", "no rule applies")
    area = scene.areas.union(lanes)
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
        both = (
            "both came into the lane at the same time"
            if entries[first] >= 0
            else ("both were in the lane from the beginning")
        )
        return _unknown("side_by_side", both)
    if scene.face(first) is Face.FRONT and scene.could_brake(first, entries[later]):
        return Finding(
            rule="following",
            fault=scene.fault_of(first),
            reason=f"{scene.name(later)} came into the lane, and there was time to brake",
        )
    return Finding(
        rule="side_by_side",
        fault=scene.fault_of(later),
        reason=f"{scene.name(later)} came into the lane of {scene.name(first)}",
    )


def _unknown(rule: str, reason: str) -> Finding:
    return Finding(rule=rule, fault=Fault.UNKNOWN, reason=reason)
