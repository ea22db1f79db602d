"""The rules for vehicles inside a junction: signals, right of way, leaving the own way."""

from __future__ import annotations

import math

from shapely import Point

from drivora_service.geometry.angles import wrap_angle
from drivora_service.observations.trace import Col
from drivora_service.oracles.responsibility.finding import Finding, undetermined
from drivora_service.oracles.responsibility.following_rules import one_behind_the_other
from drivora_service.oracles.responsibility.impact import Face
from drivora_service.oracles.responsibility.junctions import (
    Passage,
    junction_of,
    passage,
    signal_is_red,
)
from drivora_service.oracles.responsibility.lane_areas import intrusion
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.scene import ALONG, ASTRAY, Scene

_FIRST = 1.0
"""Seconds by which a party must arrive earlier to be first at an all-way stop: less than the time
to react (1.15 s), in which neither could answer to the other."""

_GROSS = 0.3
"""Share of the limit from which on a vehicle is so fast that another cannot judge its approach."""

_BEFORE = 3.0
"""Seconds before the contact at which a turn through a junction has not begun."""

_STRAIGHT = 0.25
"""Radians between two directions up to which they are the same."""

_TURNS = 0.5
"""Radians between the begin and the end of a way through a junction from which on it turns."""


def in_junction(scene: Scene) -> Finding | None:
    """Applies the rules for junctions; None outside of them.

    In this order: following is judged as on roads. Then, whatever its right, a party must not drive
    into what stands (RSS: right of way is given, not taken). A party without a way through the
    junction has no right to it. Signals precede signs (Vienna Convention, article 5), and both
    concern only ways that cross. Where they do not cross, a party must have left its own.
    """
    junction = junction_of(scene)
    if junction is None:
        return None
    ways = {party: passage(scene, party, junction) for party in (scene.ego, scene.other)}
    if scene.angle < ALONG and {scene.impact.face, scene.impact.other_face} == {
        Face.FRONT,
        Face.REAR,
    }:
        found = one_behind_the_other(scene)
        if found is not None:
            return found
    return (
        _blocked(scene)
        or _no_way(scene, ways)
        or _signals(scene, ways)
        or _right_of_way(scene, ways)
        or _left_its_way(scene, ways)
    )


def _blocked(scene: Scene) -> Finding | None:
    """A party that has stood long enough to brake for in the junction has priority."""
    for party in (scene.ego, scene.other):
        other = scene.opposite(party)
        if not scene.stands(party) or scene.stands(other):
            continue
        # Touched at its edge only, it stood there for as long as is known.
        k = party.entry(scene.way(other), other.yaw)
        entered = party.step(0 if k is None else k)
        if scene.could_brake(other, entered):
            return Finding(
                rule="standing",
                fault=scene.fault_of(other),
                reason=f"{scene.name(party)} stood in the junction long enough to keep clear of it",
            )
    return None


def _no_way(scene: Scene, ways: dict[Party, Passage]) -> Finding | None:
    """A vehicle that follows none of the ways through the junction is responsible."""
    lost = [party for party, way in ways.items() if way.movement is None]
    if not lost:
        return None
    if len(lost) == 2:
        return undetermined("own_way", "neither followed a way through the junction")
    turner = scene.opposite(lost[0])
    if _turns_across(scene, turner, ways[turner], lost[0]):
        return Finding(
            rule="turning",
            fault=scene.fault_of(turner),
            reason=f"{scene.name(turner)} turned across the way of {scene.name(lost[0])}, which "
            "was passing it",
            since=ways[turner].entered,
        )
    return Finding(
        rule="own_way",
        fault=scene.fault_of(lost[0]),
        reason=f"{scene.name(lost[0])} followed no way through the junction",
        since=ways[lost[0]].entered,
    )


def _turns_across(scene: Scene, turner: Party, way: Passage, passing: Party) -> bool:
    """Returns whether a party turns before another that keeps to the road beside it.

    Before it turns, a driver makes sure that no other is about to pass (Vienna Convention,
    article 14.1).
    """
    if way.movement is None:
        return False
    first, last = (scene.network.lanes[way.movement.lanes[end]] for end in (0, -1))
    turn = last.position_at(float(last.arc[-1]))[2] - first.position_at(0.0)[2]
    rows = round(_BEFORE / turner.step_length)
    begun = [
        float(party.states[max(party.count - rows, 0), Col.YAW]) for party in (turner, passing)
    ]
    same_way = abs(wrap_angle(begun[0] - begun[1])) < _STRAIGHT
    # In the lane of the other direction it keeps to the road as well.
    keeps = abs(math.sin(float(passing.turned(passing.yaw)[-1]))) < math.sin(_STRAIGHT)
    return same_way and keeps and abs(wrap_angle(turn)) > _TURNS


def _signals(scene: Scene, ways: dict[Party, Passage]) -> Finding | None:
    """Of parties that cross at signals, the one that came in on red is responsible.

    None if both signals were green as they came in: then the right of way decides, as for
    permissive turns.
    """
    ego, other = ways[scene.ego], ways[scene.other]
    if ego.link is None or other.link is None or not _conflict(ego, other):
        return None
    red = [party for party, way in ways.items() if way.red]
    if len(red) == 2:
        return undetermined("signals", "both came into the junction on red")
    if red:
        return Finding(
            rule="signals",
            fault=scene.fault_of(red[0]),
            reason=f"{scene.name(red[0])} came into the junction on red",
        )
    # On green, but not at the same time: the party whose green was earlier may clear the junction.
    for party, way in ways.items():
        later = ways[scene.opposite(party)]
        if way.entered < later.entered and signal_is_red(scene, _link(later), way.entered):
            return Finding(
                rule="signals",
                fault=scene.fault_of(scene.opposite(party)),
                reason=f"{scene.name(party)} was still leaving the junction, which it had entered "
                "on green",
            )
    return None


def _link(way: Passage) -> tuple[str, int]:
    return way.link or ("", -1)


def _conflict(one: Passage, two: Passage) -> bool:
    """Returns whether two ways cross or merge; the network may name it in one of them only."""
    if one.movement is None or two.movement is None:
        return False
    return bool(
        set(one.movement.foes) & set(two.movement.lanes)
        or set(two.movement.foes) & set(one.movement.lanes)
    )


def _right_of_way(scene: Scene, ways: dict[Party, Passage]) -> Finding | None:
    """Of parties that cross, the one that gives way by the network's table is responsible."""
    ego, other = ways[scene.ego], ways[scene.other]
    if ego.movement is None or other.movement is None or not _conflict(ego, other):
        return None
    ego_yields = bool(set(ego.movement.yields_to) & set(other.movement.lanes))
    other_yields = bool(set(other.movement.yields_to) & set(ego.movement.lanes))
    if ego_yields != other_yields:
        party = scene.ego if ego_yields else scene.other
        first = scene.opposite(party)
        if scene.too_fast_to_brake(first, ways[party].entered, _GROSS):
            return undetermined(
                "right_of_way",
                f"{scene.name(party)} had to give way, but {scene.name(first)} drove far too fast",
            )
        return Finding(
            rule="right_of_way",
            fault=scene.fault_of(party),
            reason=f"{scene.name(party)} had to give way",
            since=ways[party].entered,
        )
    # The table does not decide between them, as at an all-way stop, where each gives way: the first
    # to come goes first.
    apart = (ego.entered - other.entered) * scene.trace.step_length
    if abs(apart) < _FIRST:
        return undetermined("right_of_way", "both came at the same time, and each had to give way")
    later = scene.ego if apart > 0.0 else scene.other
    return Finding(
        rule="right_of_way",
        fault=scene.fault_of(later),
        reason=f"{scene.name(later)} came into the junction later",
    )


def _left_its_way(scene: Scene, ways: dict[Party, Passage]) -> Finding:
    """For ways that do not cross, the party that left its own is responsible."""
    # By whether each reaches beyond its lanes; if none does or both do, by whether they touched
    # outside of them.
    beyond = {party: _beyond(party, way) > ASTRAY for party, way in ways.items()}
    left = [party for party, is_beyond in beyond.items() if is_beyond]
    if len(left) != 1:
        left = [
            party
            for party, way in ways.items()
            if way.area is not None and not way.area.intersects(Point(scene.impact.place))
        ]
    if len(left) != 1:
        return undetermined(
            "own_way", "the ways do not cross, and which party left its own is unknown"
        )
    return Finding(
        rule="own_way",
        fault=scene.fault_of(left[0]),
        reason=f"{scene.name(left[0])} left its way through the junction",
        since=ways[left[0]].entered,
    )


def _beyond(party: Party, way: Passage) -> float:
    if way.area is None:
        return float("inf")
    box = party.boxes[-1]
    return intrusion(
        box, party.yaw, party.actor.length, party.actor.width, box.difference(way.area), party.yaw
    )
