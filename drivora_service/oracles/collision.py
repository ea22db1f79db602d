"""The ego's box overlaps another's; who is responsible."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from shapely import Polygon, box
from shapely.affinity import affine_transform

from drivora_service.geometry import wrap_angle
from drivora_service.observations.boxes import overlap_depth
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Actor, Col, Contact, EgoCol, FloatArray, Trace
from drivora_service.oracles.avoidability.assess import assess
from drivora_service.oracles.verdict import Verdict, not_started, passed, violated


class Face(StrEnum):
    """The part of the ego that was touched."""

    FRONT = "front"
    REAR = "rear"
    SIDE = "side"


@dataclass(frozen=True, slots=True, kw_only=True)
class Impact:
    """How two boxes came together.

    Attributes:
        ego_speed: m/s over ground on the way into the contact.
        ego_forward: m/s along the ego's heading, negative backwards.
        other_speed: m/s over ground of the other.
        relative_speed: m/s between the two.
        face: The part of the ego that was touched first.
        appeared: The other was put where the ego was, and did not move there.
    """

    ego_speed: float
    ego_forward: float
    other_speed: float
    relative_speed: float
    face: Face
    appeared: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision:
    """Violated where the ego's box overlaps another; the same actor counts once.

    Responsibility follows nuPlan's classes: the ego is at fault if it hit something that stood, if
    its front hit, or if it was touched at its side while it straddled lanes or was off the road. It
    is not at fault if it stood, or if it was hit from behind, unless it was going backwards.

    Attributes:
        standing_speed: m/s up to which an actor stands (nuPlan).
        off_road: Metres outside the drivable area from which on the ego is off the road.
    """

    standing_speed: float = 0.05
    off_road: float = 0.3

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "collision"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Gives a verdict for every actor that an ego collided with."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        verdicts = []
        met: set[int] = set()
        for contact in ego.trace.contacts:
            other = _other(contact, ego.row)
            k = contact.step - ego.first
            if other is None or other in met or not 0 <= k < ego.count:
                continue
            met.add(other)
            verdicts.append(self._verdict(ego, k, ego.trace.actors[other]))
        return verdicts or [passed(self.name, ego, "Touched nobody.")]

    def _verdict(self, ego: EgoView, k: int, other: Actor) -> Verdict:
        impact = find_impact(ego.trace, ego.actor, other, ego.first + k)
        replayed = assess(ego, k, other.row)
        at_fault, reason = self._responsible(ego, k, impact)
        return violated(
            self.name,
            ego,
            k,
            f"Collided with {other.id} at {impact.relative_speed:.1f} m/s: {reason}.",
            at_fault=at_fault,
            avoidable=replayed.avoidable,
            physically_avoidable=replayed.physically_avoidable,
            avoidability=dict(replayed.evidence),
            counterpart=other.id,
            counterpart_role=str(other.role),
            reason=reason,
            face=str(impact.face),
            ego_speed=impact.ego_speed,
            other_speed=impact.other_speed,
            relative_speed=impact.relative_speed,
        )

    def _responsible(self, ego: EgoView, k: int, impact: Impact) -> tuple[bool, str]:
        if impact.ego_speed <= self.standing_speed:
            return False, "the ego stood"
        if impact.appeared:
            return False, "the other appeared where the ego was"
        if impact.other_speed <= self.standing_speed:
            return True, "the other stood"
        if impact.face is Face.FRONT:
            return True, "the ego hit with its front"
        if impact.face is Face.REAR:
            if impact.ego_forward < -self.standing_speed:
                return True, "the ego went backwards"
            return False, "the ego was hit from behind"
        if ego.lanes[k] < 0 or ego.outside[k] > self.off_road:
            return True, "the ego was touched at its side while off the road"
        if _straddles(ego, k):
            return True, "the ego was touched at its side while it straddled lanes"
        return False, "the ego was touched at its side while it kept its lane"


def _other(contact: Contact, row: int) -> int | None:
    if contact.ego == row:
        return contact.other
    return contact.ego if contact.other == row else None


def _straddles(ego: EgoView, k: int) -> bool:
    """Says whether the ego reaches over the edge of its lane.

    Lanes inside a junction overlap and bend: reaching over their edges means nothing there.
    """
    if ego.in_junction[k]:
        return False
    lateral = abs(float(ego.value(EgoCol.LANE_LATERAL)[k]))
    return bool(lateral + ego.lateral_reach[k] > ego.lane_half_widths[k])


def find_impact(trace: Trace, ego: Actor, other: Actor, step: int) -> Impact:
    """Reconstructs a contact from the row before it and its own.

    Between the two rows both move evenly; the moment at which the boxes first touch shows which
    part of the ego was hit, which their overlap at the end of a fast step would not.
    """
    after = trace.states[step, [ego.row, other.row]]
    begun = step > 0 and bool(trace.present[step - 1, [ego.row, other.row]].all())
    before = trace.states[step - 1, [ego.row, other.row]] if begun else after
    velocities = after[:, [Col.VX, Col.VY]]
    if begun:
        velocities = (after - before)[:, [Col.X, Col.Y]] / trace.step_length
    pose = _first_touch(before, after, ego, other)
    cos, sin = math.cos(pose[0, 2]), math.sin(pose[0, 2])
    relative = velocities[1] - velocities[0]
    return Impact(
        ego_speed=float(np.hypot(*velocities[0])),
        ego_forward=float(velocities[0] @ (cos, sin)),
        other_speed=float(np.hypot(*velocities[1])),
        relative_speed=float(np.hypot(*relative)),
        face=_face(pose, ego, other),
        appeared=step > 0 and not begun,
    )


def _first_touch(before: FloatArray, after: FloatArray, ego: Actor, other: Actor) -> FloatArray:
    """Gives (2, 3) poses of ego and other just after they first overlapped."""
    turns = [wrap_angle(float(turn)) for turn in after[:, Col.YAW] - before[:, Col.YAW]]

    def poses(share: float) -> FloatArray:
        mixed = before[:, :3] + share * (after[:, :3] - before[:, :3])
        mixed[:, 2] = before[:, Col.YAW] + share * np.array(turns)
        return mixed

    apart, overlapping = 0.0, 1.0
    for _ in range(20):
        middle = 0.5 * (apart + overlapping)
        first, second = poses(middle)
        depth = overlap_depth(
            second[0] - first[0],
            second[1] - first[1],
            first[2],
            ego.length,
            ego.width,
            second[2],
            other.length,
            other.width,
        )
        if depth > 0.0:
            overlapping = middle
        else:
            apart = middle
    return poses(overlapping)


def _face(pose: FloatArray, ego: Actor, other: Actor) -> Face:
    """Tells which part of the ego was touched, from (2, 3) poses of ego and other as they touch."""
    x, y = _touch_point(pose, ego, other)
    distances = {
        Face.FRONT: 0.5 * ego.length - x,
        Face.REAR: 0.5 * ego.length + x,
        Face.SIDE: 0.5 * ego.width - abs(y),
    }
    return min(distances, key=lambda face: distances[face])


def _touch_point(pose: FloatArray, ego: Actor, other: Actor) -> tuple[float, float]:
    """Gives the middle of the overlap in the ego's frame, x forwards and y to the left, metres."""
    own = box(-0.5 * ego.length, -0.5 * ego.width, 0.5 * ego.length, 0.5 * ego.width)
    dx, dy = pose[1, :2] - pose[0, :2]
    cos, sin = math.cos(pose[0, 2]), math.sin(pose[0, 2])
    turn = pose[1, 2] - pose[0, 2]
    c, s = math.cos(turn), math.sin(turn)
    theirs: Polygon = affine_transform(
        box(-0.5 * other.length, -0.5 * other.width, 0.5 * other.length, 0.5 * other.width),
        [c, -s, s, c, dx * cos + dy * sin, dy * cos - dx * sin],
    )
    common = own.intersection(theirs)
    middle = common.centroid if not common.is_empty else theirs.centroid
    return float(middle.x), float(middle.y)
