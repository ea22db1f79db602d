"""The impact of a collision: the parts that touched, and the motion of both."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from shapely import Polygon, box
from shapely.affinity import affine_transform

from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.boxes import overlap_depth
from drivora_service.observations.artefacts import has_jumped
from drivora_service.observations.trace import Actor, Col, Trace

_HALVINGS = 20
"""Halvings of a step to find the first touch: a millionth of its way is left, micrometres."""


class Face(StrEnum):
    """The part of the ego that was touched."""

    FRONT = "front"
    REAR = "rear"
    SIDE = "side"


@dataclass(frozen=True, slots=True, kw_only=True)
class Impact:
    """The impact of two boxes.

    Attributes:
        ego_speed: m/s over ground on the way into the contact.
        ego_forward: m/s along the ego's heading, negative backwards.
        other_speed: m/s over ground of the other.
        relative_speed: m/s between the two.
        face: The part of the ego that was touched first.
        other_face: The part of the other that was touched first.
        place: (x, y) of the touch, metres.
        appeared: The other was placed where the ego was, and did not move there.
        jumped: The other was moved further in one step than its speeds explain, as by a lane change
            of SUMO's LC2013.
    """

    ego_speed: float
    ego_forward: float
    other_speed: float
    relative_speed: float
    face: Face
    other_face: Face
    place: tuple[float, float]
    appeared: bool
    jumped: bool


def find_impact(trace: Trace, ego: Actor, other: Actor, step: int) -> Impact:
    """Reconstructs a contact from the row before it and its own.

    Between the two rows both move evenly; the moment at which the boxes first touch shows which
    part of the ego was hit, which their overlap at the end of a fast step would not.
    """
    after = trace.states[step, [ego.row, other.row]]
    begun = step > 0 and bool(trace.present[step - 1, [ego.row, other.row]].all())
    before = trace.states[step - 1, [ego.row, other.row]] if begun else after
    # From displacements where there are two rows: it is they that brought the boxes together. A
    # recorded speed may disagree, as that of an actor that SUMO moves sideways.
    velocities = after[:, [Col.VX, Col.VY]]
    if begun:
        velocities = (after - before)[:, [Col.X, Col.Y]] / trace.step_length
    pose = _first_touch(before, after, ego, other)
    own = pose[0]
    cos, sin = math.cos(own[Col.YAW]), math.sin(own[Col.YAW])
    relative = velocities[1] - velocities[0]
    x, y = _touch_point(pose, ego, other)
    return Impact(
        ego_speed=float(np.hypot(*velocities[0])),
        ego_forward=float(velocities[0, 0] * cos + velocities[0, 1] * sin),
        other_speed=float(np.hypot(*velocities[1])),
        relative_speed=float(np.hypot(*relative)),
        face=_face(pose, ego, other),
        other_face=_face(pose[::-1], other, ego),
        place=(
            float(own[Col.X] + x * cos - y * sin),
            float(own[Col.Y] + x * sin + y * cos),
        ),
        appeared=step > 0 and not begun,
        jumped=begun and has_jumped(before[1], after[1], trace.step_length),
    )


def _first_touch(before: FloatArray, after: FloatArray, ego: Actor, other: Actor) -> FloatArray:
    """Returns (2, 3) poses of ego and other just after they first overlapped, columns ``Col``."""
    turns = [wrap_angle(float(turn)) for turn in after[:, Col.YAW] - before[:, Col.YAW]]

    begin, end = before[:, : Col.YAW + 1], after[:, : Col.YAW + 1]

    def poses(share: float) -> FloatArray:
        mixed = begin + share * (end - begin)
        mixed[:, Col.YAW] = before[:, Col.YAW] + share * np.array(turns)
        return mixed

    # Bisection, as the boxes overlap in the later row. Of the last interval the end is returned, at
    # which they overlap: the middle of that overlap is the point of touch.
    apart, overlapping = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (apart + overlapping)
        first, second = poses(middle)
        depth = overlap_depth(
            second[Col.X] - first[Col.X],
            second[Col.Y] - first[Col.Y],
            first[Col.YAW],
            ego.length,
            ego.width,
            second[Col.YAW],
            other.length,
            other.width,
        )
        if depth > 0.0:
            overlapping = middle
        else:
            apart = middle
    return poses(overlapping)


def _face(pose: FloatArray, ego: Actor, other: Actor) -> Face:
    """Returns the part of the ego that was touched, from (2, 3) poses as the two touch."""
    # Just after the touch the overlap is a sliver along the edge that was touched: its middle is
    # nearer to this edge than to the others.
    x, y = _touch_point(pose, ego, other)
    distances = {
        Face.FRONT: 0.5 * ego.length - x,
        Face.REAR: 0.5 * ego.length + x,
        Face.SIDE: 0.5 * ego.width - abs(y),
    }
    return min(distances, key=lambda face: distances[face])


def _touch_point(pose: FloatArray, ego: Actor, other: Actor) -> tuple[float, float]:
    """Returns the middle of the overlap in the ego's frame, x forwards, y to the left, metres."""
    own = box(-0.5 * ego.length, -0.5 * ego.width, 0.5 * ego.length, 0.5 * ego.width)
    dx, dy = (pose[1] - pose[0])[[Col.X, Col.Y]]
    cos, sin = math.cos(pose[0, Col.YAW]), math.sin(pose[0, Col.YAW])
    turn = pose[1, Col.YAW] - pose[0, Col.YAW]
    c, s = math.cos(turn), math.sin(turn)
    # Turned and moved into the ego's frame: the two rows of the rotation, then the translation.
    theirs: Polygon = affine_transform(
        box(-0.5 * other.length, -0.5 * other.width, 0.5 * other.length, 0.5 * other.width),
        [c, -s, s, c, dx * cos + dy * sin, dy * cos - dx * sin],
    )
    common = own.intersection(theirs)
    # Rounding may leave none; the other's centre is on the right side of the ego at least.
    middle = common.centroid if not common.is_empty else theirs.centroid
    return float(middle.x), float(middle.y)
