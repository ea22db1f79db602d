"""The friction of the road at a place: the road's own, and less on slippery patches.

The lowest coefficient at a place counts; the road's own is that of the weather at the time. Patches
are rows of an array, so that the kernels of the simulation and the oracles ask the same function. A
vehicle stands on two axles, each half a wheelbase from the centre of its box, that carry half of
its weight each: its grip is the mean of the frictions under them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import Any

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.errors import UnknownName
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import LEVEL_GAP, Actor, Col
from drivora_service.scenario.models.actor_models import ActorKind, actor_model

_WHEELBASE_SHARE = 0.6


class PatchCol(IntEnum):
    """Columns of patches."""

    X = 0
    """Centre, metres."""
    Y = 1
    COS = 2
    """Of the direction of its length."""
    SIN = 3
    HALF_LENGTH = 4
    """Metres."""
    HALF_WIDTH = 5
    Z = 6
    """Height, metres."""
    FRICTION = 7


NO_PATCHES: FloatArray = np.zeros((0, len(PatchCol)))


@compiled
def friction_at(x: float, y: float, z: float, friction: float, patches: FloatArray) -> float:
    """Returns the friction coefficient at a place, metres.

    Args:
        x, y, z: The place, metres.
        friction: Coefficient of the road without patches.
        patches: (P, 8), columns ``PatchCol``.
    """
    for p in range(patches.shape[0]):
        patch = patches[p]
        if patch[PatchCol.FRICTION] >= friction or abs(z - patch[PatchCol.Z]) > LEVEL_GAP:
            continue
        dx, dy = x - patch[PatchCol.X], y - patch[PatchCol.Y]
        along = dx * patch[PatchCol.COS] + dy * patch[PatchCol.SIN]
        across = dy * patch[PatchCol.COS] - dx * patch[PatchCol.SIN]
        if abs(along) <= patch[PatchCol.HALF_LENGTH] and abs(across) <= patch[PatchCol.HALF_WIDTH]:
            friction = patch[PatchCol.FRICTION]
    return friction


@compiled
def axle_frictions(
    x: float,
    y: float,
    z: float,
    cos: float,
    sin: float,
    wheelbase: float,
    friction: float,
    patches: FloatArray,
) -> tuple[float, float]:
    """Returns the friction coefficients under a vehicle's front and rear axle.

    Args:
        x, y, z: Centre of its box, metres.
        cos, sin: Of its heading.
        wheelbase: Metres.
        friction: Coefficient of the road without patches.
        patches: (P, 8), columns ``PatchCol``.
    """
    ahead, aside = 0.5 * wheelbase * cos, 0.5 * wheelbase * sin
    return (
        friction_at(x + ahead, y + aside, z, friction, patches),
        friction_at(x - ahead, y - aside, z, friction, patches),
    )


@compiled
def vehicle_friction(
    x: float, y: float, z: float, yaw: float, wheelbase: float, friction: float, patches: FloatArray
) -> float:
    """Returns the friction coefficient of a vehicle: the mean of its axles'.

    The arguments are those of ``axle_frictions``, with the heading in radians.
    """
    if patches.shape[0] == 0:
        return friction
    cos, sin = math.cos(yaw), math.sin(yaw)
    front, rear = axle_frictions(x, y, z, cos, sin, wheelbase, friction, patches)
    return 0.5 * (front + rear)


@compiled
def _lower(
    poses: FloatArray,
    heights: FloatArray,
    wheelbase: float,
    patches: FloatArray,
    frictions: FloatArray,
) -> None:
    """Lowers the frictions of the road, one for each pose, to those of the patches there."""
    for k in range(poses.shape[0]):
        x, y, yaw = poses[k, Col.X], poses[k, Col.Y], poses[k, Col.YAW]
        frictions[k] = vehicle_friction(x, y, heights[k], yaw, wheelbase, frictions[k], patches)


def frictions_along(
    poses: FloatArray,
    heights: FloatArray,
    wheelbase: float,
    friction: float | FloatArray,
    patches: FloatArray,
) -> FloatArray:
    """Returns the friction coefficient that a vehicle has in each pose, (n,).

    Args:
        poses: (n, 3), columns ``Col`` up to ``YAW``.
        heights: (n,) metres.
        wheelbase: Metres; 0: of its centre alone.
        friction: Coefficient of the road without patches, or (n,) of them, one for each pose.
        patches: (P, 8), columns ``PatchCol``.
    """
    found: FloatArray = np.array(np.broadcast_to(friction, len(poses)), dtype=np.float64)
    if len(patches):
        poses, heights = np.ascontiguousarray(poses), np.ascontiguousarray(heights)
        _lower(poses, heights, wheelbase, patches, found)
    return found


def wheelbase_of(actor: Actor) -> float:
    """Returns the wheelbase of a vehicle, metres; of an unknown model, a share of its length."""
    try:
        return actor_model(ActorKind.VEHICLE, actor.model).wheelbase
    except UnknownName:
        return _WHEELBASE_SHARE * actor.length


def patch_array(patches: Sequence[Mapping[str, Any]]) -> FloatArray:
    """Returns recorded patches as (P, 8), columns ``PatchCol``."""
    if not patches:
        return NO_PATCHES
    laid = np.zeros((len(patches), len(PatchCol)))
    for row, patch in zip(laid, patches, strict=True):
        yaw = float(patch["yaw"])
        row[PatchCol.X], row[PatchCol.Y], row[PatchCol.Z] = patch["x"], patch["y"], patch["z"]
        row[PatchCol.COS], row[PatchCol.SIN] = math.cos(yaw), math.sin(yaw)
        row[PatchCol.HALF_LENGTH] = 0.5 * float(patch["length"])
        row[PatchCol.HALF_WIDTH] = 0.5 * float(patch["width"])
        row[PatchCol.FRICTION] = patch["friction"]
    return laid
