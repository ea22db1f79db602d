"""The rules for vehicles on a road that face or cross each other."""

from __future__ import annotations

from drivora_service.oracles.responsibility.finding import Finding, undetermined
from drivora_service.oracles.responsibility.impact import Face
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.scene import AGAINST, ALONG, ASTRAY, Scene

_RETURNED = 2.5
"""Seconds for which it counts that a vehicle was in the wrong lane: long enough for the one that it
met to react (1.15 s) and to steer aside."""


def opposite_directions(scene: Scene) -> Finding | None:
    """Of vehicles that face each other, the one in the lane of the other is responsible."""
    if scene.angle < AGAINST:
        return None
    astray = {party: scene.astray(party) > ASTRAY for party in (scene.ego, scene.other)}
    if all(astray.values()):
        return undetermined("opposite_directions", "both were in the lane of the other direction")
    for party, is_astray in astray.items():
        if not is_astray:
            continue
        other = scene.opposite(party)
        if _came_back(other, party):
            return undetermined(
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
                    reason=f"{scene.name(party)} stood long enough to keep clear of it",
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
        return undetermined("across", "both went across the lane")
    (party,) = crossing
    other = scene.opposite(party)
    # RSS, rule 3: right of way is given, not taken. So the one that had it is responsible if its
    # front hit what it could have braked for; not if it was run into.
    entered = _entry_step(scene, party, other)
    if scene.face(other) is Face.FRONT and scene.could_brake(other, entered):
        return Finding(
            rule="across",
            fault=scene.fault_of(other),
            reason=f"{scene.name(party)} went across the lane early enough to keep clear of it",
        )
    return Finding(
        rule="across",
        fault=scene.fault_of(party),
        reason=f"{scene.name(party)} went across the lane of {scene.name(other)}",
        since=entered,
    )


def _entry_step(scene: Scene, party: Party, other: Party) -> int:
    """Returns the row of the trace at which a party came into the way of the other."""
    k = party.entry(scene.way(other), other.yaw)
    return scene.step if k is None else party.step(k)
