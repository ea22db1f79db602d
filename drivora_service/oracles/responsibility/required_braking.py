"""Whether a party could have braked in time, as UNECE R157's competent driver."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.observations.trace import Col
from drivora_service.oracles.responsibility.party import GRAVITY, Party

REACTION = 1.15
"""Seconds from the moment at which the risk can be perceived to the first braking: 0.4 s of
evaluation and 0.75 s of delay (UNECE R157, annex 3)."""

DECELERATION = 0.774 * GRAVITY
"""m/s² of the competent driver's braking (UNECE R157, annex 3), if the road has that grip all the
way from the moment at which the risk could be perceived."""

RAMP = 0.6
"""Seconds until the braking is full (UNECE R157, annex 3)."""


def could_brake(
    one: Party,
    other: Party,
    step: int,
    reaction: float = REACTION,
    deceleration: float = DECELERATION,
    limit: float = math.inf,
) -> bool:
    """Returns whether ``one``, which runs into ``other``, could have kept behind it by braking.

    Both are projected on the heading of ``one`` at the contact. The other moves as recorded,
    and after the contact at its last speed; a speed towards ``one`` counts as standing.

    Distances are measured from where each is at the contact. There the boxes touch, so ``one`` is
    behind the other for as long as it has come less far than the other, whatever their sizes.

    Args:
        one: The party that brakes.
        other: The party ahead of it.
        step: Row of the trace at which the risk could be perceived.
        reaction: Seconds from then to the first braking.
        deceleration: m/s² of the full braking, where the road has the grip.
        limit: m/s that ``one`` drives at most from ``step`` on.
    """
    begin = min(max(step - one.first, 0), one.count - 1)
    dt = one.step_length
    driven = one.travelled - float(one.travelled[-1])
    cos, sin = math.cos(one.yaw), math.sin(one.yaw)
    ahead = (other.states[:, Col.X] - other.states[-1, Col.X]) * cos
    ahead = ahead + (other.states[:, Col.Y] - other.states[-1, Col.Y]) * sin
    last = float(ahead[-1] - ahead[-2]) / dt if other.count > 1 else 0.0
    last = max(last, 0.0)
    steps = np.diff(one.travelled)
    # The least grip counts on the whole way: no party is blamed for want of a braking that the road
    # might not have held.
    full = min(deceleration, float(one.grip[begin:].min()))
    place, time = float(driven[begin]), 0.0
    speed = float(steps[min(begin, len(steps) - 1)]) / dt if len(steps) else 0.0
    speed = min(speed, limit)
    k = begin
    while True:
        k, time = k + 1, time + dt
        if time <= reaction:
            speed = min(float(steps[k - 1]) / dt, limit) if k < one.count else speed
            place += speed * dt
        else:
            braking = full * min(1.0, (time - reaction) / RAMP)
            speed = max(0.0, speed - braking * dt)
            place += speed * dt
        # Both records end with the contact, but may begin at different rows.
        row = k - (one.count - other.count)
        if row >= 0:
            known = row < other.count
            free = float(ahead[row]) if known else (row - other.count + 1) * dt * last
            if place > free - 1e-3:
                return False
        # From here on the room between them only grows: ``one`` gets no faster.
        if k >= one.count - 1 and speed <= last:
            return True
