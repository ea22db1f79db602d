"""Conversion of waypoints to acceleration and steering, for the agents that were trained here.

Frame: the ego's, x ahead and y to the left of its centre, metres.
"""

from __future__ import annotations

import math

from drivora_service.agents.idm.pure_pursuit import preview
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import Float32Array

WAYPOINTS = 4
INTERVAL = 0.5
"""Seconds between two waypoints; the first is as far from now."""
STEP_SCALE = 5.0
"""Scale of a network's displacements between waypoints, metres."""
_TRACKED = 2
"""Number of waypoints that determine the acceleration."""
_STANDING_WAY = 0.4
"""Metres; a standing ego whose last waypoint is nearer stays where it is."""
_STANDING_SPEED = 0.5
_HOLD = -1.5
"""m/s² while standing."""
_SHORTEST_AIM = 1.0
"""Metres of way, below which its direction is undefined and the wheel angle is kept."""
_HARDEST_START = 3.0
"""Maximum acceleration, m/s²."""


@compiled
def drive_waypoints(
    waypoints: Float32Array, speed: float, wheelbase: float, max_braking: float, last_steer: float
) -> tuple[float, float]:
    """Returns the acceleration (m/s²) and the front-wheel angle (radians) that follow waypoints.

    The constant acceleration fits the first second's waypoints along the way
    (least squares); the steering aims at a point of the way at the preview distance of ``idm``.

    Args:
        waypoints: (4, 2) places after each half second, metres.
        speed: Of the ego, m/s.
        wheelbase: Metres.
        max_braking: m/s², positive.
        last_steer: Present front-wheel angle, radians.
    """
    above, below = 0.0, 0.0
    x = y = way = 0.0
    ux, uy = 1.0, 0.0
    aim_at = preview(speed, wheelbase) - 0.5 * wheelbase
    aim_x = aim_y = 0.0
    aimed = False
    for k in range(WAYPOINTS):
        dx, dy = waypoints[k, 0] - x, waypoints[k, 1] - y
        part = math.hypot(dx, dy)
        if part > 1e-3:
            ux, uy = dx / part, dy / part
        if not aimed and way + part >= aim_at:
            aim_x, aim_y = x + (aim_at - way) * ux, y + (aim_at - way) * uy
            aimed = True
        x, y = waypoints[k, 0], waypoints[k, 1]
        way += math.copysign(part, dx)
        if k < _TRACKED:
            time = INTERVAL * (k + 1)
            above += 0.5 * time * time * (way - speed * time)
            below += 0.25 * time**4
    if speed < _STANDING_SPEED and way < _STANDING_WAY:
        return _HOLD, last_steer
    acceleration = min(max(above / below, -max_braking), _HARDEST_START)
    if way < _SHORTEST_AIM:
        return acceleration, last_steer
    if not aimed:
        aim_x, aim_y = x + (aim_at - way) * ux, y + (aim_at - way) * uy
    return acceleration, _steer_centre_at(aim_x, aim_y, wheelbase)


@compiled
def _steer_centre_at(x: float, y: float, wheelbase: float) -> float:
    """Returns the front-wheel angle that leads the centre to a point: pure pursuit (Coulter 1992).

    On a circle the centre moves at an angle to the heading (about half the wheelbase times the
    curvature): relative to the centre a point of its way is further to the side than relative to
    the rear axle, which the method assumes.
    """
    distance = max(math.hypot(x, y), 1e-3)
    return math.atan(wheelbase * 2.0 * y / distance / (distance + wheelbase))
