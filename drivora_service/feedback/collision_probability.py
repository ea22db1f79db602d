"""The probability of a collision of DeepCollision, from safety distances.

Lu et al., *Learning Configurations of Operating Environment of Autonomous Vehicles to Maximize
their Collisions* (IEEE Transactions on Software Engineering, 2022), with the figures of its public
code.

With the speed v of the ego, u of another actor, the angle a between their headings, and
decelerations b of 6 m/s² (1.5 m/s² for pedestrians):

- on one lane the safety distance is ``|v²/b - u²/b| / 2 + 5 m``; for a pedestrian ahead without the
  absolute value;
- else it is ``v² sin(a) / b + 5 m``.

An actor at a distance d between the centres has the probability ``1 - d / safety distance``, or 0.
``p`` is the greatest on the ego's lane and ``q`` the greatest off it; together they are
``max(p, q) + (1 - max(p, q)) min(p, q)``.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.observations.trace import LEVEL_GAP, Actor, Col, Role

MARGIN = 5.0
"""Metres that a safety distance has at least."""
BRAKING = 6.0
WALKER_BRAKING = 1.5
_ALONG = math.cos(math.radians(30.0))
"""Cosine of the angle up to which two actors go the same way, on one lane."""
_BESIDE = 0.5
"""Metres between the sides of two actors on one lane."""


def collision_probability(
    states: FloatArray, present: BoolArray, actors: tuple[Actor, ...], ego: int
) -> FloatArray:
    """Returns the (n,) probabilities of a collision of an ego, 0..1.

    Args:
        states: (n, N, 9) frames, columns ``Col``.
        present: (n, N).
        actors: The N actors.
        ego: Row of the ego; where it is absent, the probability is 0.
    """
    own, others = states[:, [ego]], np.delete(states, ego, axis=1)
    rest = [actor for actor in actors if actor.row != ego]
    there = np.delete(present, ego, axis=1) & present[:, [ego]]
    if not rest:
        return np.zeros(len(states))
    is_walker = np.array([actor.role is Role.NPC_WALKER for actor in rest])
    width = np.array([actor.width for actor in rest])
    # What is absent has no state: it counts as far away.
    with np.errstate(invalid="ignore"):
        dx, dy = (others[..., col] - own[..., col] for col in (Col.X, Col.Y))
        cos, sin = elementary.cos(own[..., Col.YAW]), elementary.sin(own[..., Col.YAW])
        ahead, aside = dx * cos + dy * sin, dy * cos - dx * sin
        turn = others[..., Col.YAW] - own[..., Col.YAW]
        speed, other = (np.hypot(s[..., Col.VX], s[..., Col.VY]) for s in (own, others))
        on_lane = (np.abs(aside) < 0.5 * (width + actors[ego].width) + _BESIDE) & (
            (elementary.cos(turn) > _ALONG) | (other < 0.1)
        )
        braked = np.where(is_walker, WALKER_BRAKING, BRAKING)
        margin = 0.5 * (speed**2 / BRAKING - other**2 / braked)
        follows = is_walker & (ahead > 0.0)
        # A pedestrian behind the ego is none that it could run into.
        behind = is_walker & (ahead <= 0.0)
        along = np.where(behind, 0.0, np.where(follows, margin, np.abs(margin)) + MARGIN)
        across = speed**2 * np.abs(elementary.sin(turn)) / BRAKING + MARGIN
        level = np.abs(others[..., Col.Z] - own[..., Col.Z]) <= LEVEL_GAP
        distance = np.where(there & level, np.hypot(dx, dy), np.inf)
    lengthwise = _share(np.where(on_lane, along, 0.0), distance)
    sideways = _share(np.where(on_lane, 0.0, across), distance)
    high, low = np.maximum(lengthwise, sideways), np.minimum(lengthwise, sideways)
    together: FloatArray = high + (1.0 - high) * low
    return together


def _share(safe: FloatArray, distance: FloatArray) -> FloatArray:
    """Returns the (n,) greatest shares of safety distances that are missing."""
    counts = np.isfinite(distance) & (safe > distance)
    # Where none is missing, the share is 0, also where there is no state.
    missing = np.divide(safe - distance, safe, out=np.zeros_like(safe), where=counts)
    shares: FloatArray = missing.max(axis=1)
    return shares
