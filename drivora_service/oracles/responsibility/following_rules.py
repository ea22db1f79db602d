"""The rules for a vehicle behind another: following, cutting in, braking after that."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.observations.trace import Col
from drivora_service.oracles.responsibility.beside_rules import came_over
from drivora_service.oracles.responsibility.finding import Finding, undetermined
from drivora_service.oracles.responsibility.impact import Face
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.required_braking import REACTION, could_brake
from drivora_service.oracles.responsibility.scene import ALONG, TOO_NEAR, Scene
from drivora_service.oracles.responsibility.taken_priority import took_right_of_way

_AT_LIBERTY = 4.0
"""Seconds after coming into a lane from which on a vehicle may brake as any other ahead: the one
behind has had time to fall back to a safe distance."""

_HARD = 3.0
"""m/s² from which on a vehicle that has just come in brakes hard, for the one behind it."""

_GENTLE = 2.0
"""m/s² of a braking that hinders no driver (the comfortable range of nuPlan ends at 4.05)."""

_MEASURED = 0.5
"""Seconds over which braking is measured."""

_LEADER = 30.0
"""Metres ahead within which another actor is a reason to brake."""

_TURNED = 0.3
"""Radians from its lane's direction from which on a vehicle turns across it."""


def one_behind_the_other(scene: Scene) -> Finding | None:
    """The party behind is responsible, unless the party ahead cut in too close before it."""
    behind = _behind(scene)
    if behind is None:
        return None
    ahead = scene.opposite(behind)
    k = ahead.entry(scene.way(behind), behind.yaw)
    if k is None:
        # Its box hardly reaches into the way: what counts is since when it has been there.
        k = ahead.reach(scene.way(behind), behind.yaw)
    is_here = "had stood" if scene.stands(ahead) else "had been ahead"
    # An actor that was present when the record began had been seen before: braking needs no time
    # to react then, which would only be granted for what could not be foreseen.
    is_known = k == 0 and ahead.from_beginning
    if not is_known and took_right_of_way(scene, ahead, behind):
        return Finding(
            rule="right_of_way",
            fault=scene.fault_of(ahead),
            reason=f"{scene.name(ahead)} had to give way, and came into the lane "
            f"{_seconds_since(scene, ahead.step(k)):.1f} s before",
            since=ahead.step(k),
        )
    if could_brake(behind, ahead, ahead.step(k), 0.0 if is_known else REACTION):
        if not is_known and _braked_at_once(scene, ahead, k):
            return _cut_in_and_braked(scene, behind, ahead, k)
        return Finding(
            rule="standing" if scene.stands(ahead) else "following",
            fault=scene.fault_of(behind),
            reason=f"{scene.name(ahead)} {is_here} long enough to keep clear of it",
        )
    # Too near from the first row on: by whose doing is not recorded, so no ego is blamed for it;
    # neither is an ego that had only been ahead.
    if is_known and behind is scene.ego:
        return undetermined("too_near", TOO_NEAR)
    if is_known:
        return Finding(
            rule="following",
            fault=scene.fault_of(behind),
            reason=f"{scene.name(ahead)} was ahead from the beginning",
        )
    entry = ahead.step(k)
    came = "appeared" if k == 0 and ahead.appeared else "came into the lane"
    return Finding(
        rule="cut_in",
        fault=scene.fault_of(ahead),
        reason=f"{scene.name(ahead)} {came} {_seconds_since(scene, entry):.1f} s before, too late "
        "to brake for",
        since=entry,
    )


def _seconds_since(scene: Scene, step: int) -> float:
    return (scene.step - step) * scene.trace.step_length


def _braked_at_once(scene: Scene, ahead: Party, k: int) -> bool:
    """Returns whether a party came in at row ``k`` shortly before and braked for no actor ahead."""
    if (ahead.count - 1 - k) * ahead.step_length > _AT_LIBERTY:
        return False
    speed = np.hypot(ahead.states[k:, Col.VX], ahead.states[k:, Col.VY])
    over = max(round(_MEASURED / ahead.step_length), 1)
    slowed = (speed[:-over] - speed[over:]) / (over * ahead.step_length)
    if not len(slowed) or float(slowed.max()) < _HARD:
        return False
    return not _has_leader(scene, ahead, k + int(np.argmax(slowed)))


def _has_leader(scene: Scene, party: Party, k: int) -> bool:
    """Returns whether an actor other than the two was ahead of a party in one of its rows."""
    trace, state = scene.trace, party.states[k]
    cos, sin = math.cos(state[Col.YAW]), math.sin(state[Col.YAW])
    for actor in trace.actors:
        if actor in (scene.ego.actor, scene.other.actor):
            continue
        if not trace.present[party.step(k), actor.row]:
            continue
        dx, dy = (trace.states[party.step(k), actor.row] - state)[[Col.X, Col.Y]]
        ahead, across = dx * cos + dy * sin, abs(dy * cos - dx * sin)
        if 0.0 < ahead < _LEADER and across < 0.5 * (party.actor.width + actor.width):
            return True
    return False


def _cut_in_and_braked(scene: Scene, behind: Party, ahead: Party, k: int) -> Finding:
    """Judges a party that came into a lane and braked there before the other could fall back.

    It must not brake so without need (Vienna Convention, article 17.1). Where gentle braking would
    have been enough for the party behind, both did their part.
    """
    if could_brake(behind, ahead, ahead.step(k), deceleration=_GENTLE):
        return undetermined(
            "cut_in",
            f"{scene.name(ahead)} came into the lane and braked, but gentle braking would have "
            "kept the distance",
        )
    return Finding(
        rule="cut_in",
        fault=scene.fault_of(ahead),
        reason=f"{scene.name(ahead)} came into the lane "
        f"{_seconds_since(scene, ahead.step(k)):.1f} s before, and braked",
        since=ahead.step(k),
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
    """Returns whether a party whose side was touched came from another lane, or turned across."""
    other = scene.opposite(party)
    turns = abs(float(party.turned(other.yaw)[-1])) > _TURNED and came_over(scene, party)
    return turns or party.entry(scene.way(other), other.yaw) != 0
