"""An ADS in a process of its own: follows its route, stops for actors, red lights and stop signs.

Needs grpcio, protobuf and numpy. Drivora starts it as its ``agent.yaml`` says; by hand, at an
address of your choice::

    DRIVORA_AGENT_ADDRESS=localhost:50051 python agent.py
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.remote.serving import serve
from drivora_service.agents.remote.views import ContextView
from drivora_service.observations.trace import Col, Light

CRUISE = 8.0
"""m/s at most."""

BRAKE = 2.5
"""m/s², what it plans to brake with."""

LOOK_AHEAD = 40.0
"""Metres along the route within which it looks for others and for bends."""

SIDE_ACCELERATION = 2.0
"""m/s² in bends."""


class RouteFollower:
    """Pure pursuit along the route, at a speed from which it can stop."""

    def setup_env(self, context: ContextView) -> None:
        """Takes the route; called before every run."""
        self.context = context
        route = context.route
        step = np.diff(route.line, axis=0)
        heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
        bend = np.zeros(len(route.line))
        bend[1:-1] = np.abs(np.diff(heading)) / np.maximum(np.diff(route.arc)[1:], 0.2)
        bend = np.convolve(bend, np.full(5, 0.2), mode="same")
        self.bend_speed = np.sqrt(SIDE_ACCELERATION / np.maximum(bend, 1e-3))
        self.stop_signs: list[float] = route.stop_signs.tolist()
        self.standing_steps = 0
        context.log.declare("wanted_speed", "free_distance")
        context.log.event(f"{route.arc[-1]:.0f} m to drive, {len(context.lanes)} lanes around")

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Decides; called every step."""
        free = min(
            self.distance_to_others(observation),
            self.distance_to_halt(observation),
            self.distance_to_stop_sign(observation),
        )
        route, s = self.context.route, observation.route_s
        ahead = (route.arc >= s) & (route.arc <= s + LOOK_AHEAD)
        bends = np.sqrt(self.bend_speed[ahead] ** 2 + 2 * BRAKE * (route.arc[ahead] - s))
        wanted = min(
            CRUISE,
            observation.speed_limit,
            math.sqrt(2 * BRAKE * max(free, 0.0)),
            float(bends.min(initial=CRUISE)),
        )
        log = self.context.log
        log.row[0], log.row[1] = wanted, free
        acceleration = min(2.0 * (wanted - observation.speed), 2.0)
        if free < 0.5:
            acceleration = -self.context.vehicle.max_deceleration
        return AccelerationControl(acceleration, self.steer(observation))

    def distance_to_others(self, observation: Observation) -> float:
        """Metres to the nearest actor on the route ahead."""
        route, vehicle = self.context.route, self.context.vehicle
        s = observation.route_s
        ahead = np.flatnonzero((route.arc > s) & (route.arc < s + LOOK_AHEAD))
        if not len(observation.objects) or not len(ahead):
            return math.inf
        places = observation.objects[:, [Col.X, Col.Y]]
        gaps = np.hypot(*(places[:, None] - route.line[ahead][None]).transpose(2, 0, 1))
        nearest = gaps.argmin(axis=1)
        lengths, widths = observation.object_sizes.T
        in_way = gaps.min(axis=1) < 0.5 * (widths + vehicle.width) + 0.3
        free = route.arc[ahead][nearest] - s - 0.5 * (vehicle.length + lengths) - 3.0
        return float(free[in_way].min(initial=math.inf))

    def distance_to_halt(self, observation: Observation) -> float:
        """Metres to a stop line at which it has to stop, and can."""
        if observation.light not in (Light.RED, Light.YELLOW):
            return math.inf
        distance = observation.light_distance - 1.0
        needed = observation.speed**2 / (2 * self.context.vehicle.max_deceleration)
        return distance if needed < observation.light_distance else math.inf

    def distance_to_stop_sign(self, observation: Observation) -> float:
        """Metres to the line of the next stop sign, until the ego has stood there for a second."""
        if not self.stop_signs:
            return math.inf
        distance = self.stop_signs[0] - observation.route_s - self.context.vehicle.length / 2
        self.standing_steps += distance < 3.0 and abs(observation.speed) < 0.05
        if self.standing_steps * self.context.step_length > 1.0 or distance < -1.0:
            self.stop_signs.pop(0)
            self.standing_steps = 0
            return math.inf
        return distance - 1.0

    def steer(self, observation: Observation) -> float:
        """Angle of the front wheels, radians."""
        route = self.context.route
        reach = max(4.0, 0.8 * observation.speed)
        goal = min(int(np.searchsorted(route.arc, observation.route_s + reach)), len(route.arc) - 1)
        x, y, yaw = observation.ego[:3]
        goal_x, goal_y = route.line[goal]
        angle = math.atan2(goal_y - y, goal_x - x) - yaw
        distance = max(math.hypot(goal_y - y, goal_x - x), 1.0)
        return math.atan(2 * self.context.vehicle.wheelbase * math.sin(angle) / distance)


if __name__ == "__main__":
    serve(RouteFollower, name="external-agent")
