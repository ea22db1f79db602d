"""What an adversary sees: a situation as a vector of fixed length.

The values are those of the method's publication as far as they exist here (place, heading and speed
of the ego, rain, fog, wetness, time of day, signal), with the place along the ego's route in place
of coordinates; besides, the neighbouring lanes and the nearest actors, which decide what an action
can do. All are within -1..1.
"""

from __future__ import annotations

import math
from itertools import chain

import numpy as np

from drivora_service.adversaries.adversary_situation import EGO, Situation
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import EgoCol, Light, Role
from drivora_service.runs.adversary import OBSERVATION_SIZE
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.look import ActorState

_NEAREST = 4
"""Number of other actors that are seen."""
_REACH = 50.0
_FASTEST = 20.0
_LANE = 2.0
_DIGITS = 4
"""Decimals of the values: what is stored is what was decided by."""


def view_of(episode: Episode, situation: Situation | None) -> FloatArray:
    """Returns the (39,) view of a situation; zeros if the ego has left the world."""
    if situation is None:
        return np.zeros(OBSERVATION_SIZE)
    frames = episode.frames(episode.row)
    values = frames.ego_values[-1, EGO]
    ego, weather = situation.ego, situation.weather
    to_light = float(values[EgoCol.LIGHT_DISTANCE])
    aside = float(values[EgoCol.ROUTE_LATERAL])
    turn = math.remainder(ego.yaw - situation.path.at(situation.arc).yaw, math.tau)
    light = int(frames.ego_lights[-1, EGO])
    view = np.array(
        [
            situation.arc / situation.path.length,
            ego.speed / _FASTEST,
            0.0 if math.isnan(aside) else aside / _LANE,
            turn / math.pi,
            weather.precipitation / 100.0,
            weather.fog_density / 100.0,
            weather.wetness / 100.0,
            weather.sun_altitude_angle / 90.0,
            *(float(light == one) for one in Light),
            to_light / _REACH if math.isfinite(to_light) else 1.0,
            *(float(situation.neighbour(situation.arc, side) is not None) for side in (1, -1)),
            *_others(situation),
        ]
    )
    clipped: FloatArray = np.round(np.clip(view, -1.0, 1.0), _DIGITS) + 0.0
    return clipped


def _others(situation: Situation) -> FloatArray:
    """Returns six values of each of the nearest actors, in the ego's frame; zeros for missing."""
    ego = situation.ego
    near = sorted(
        situation.others, key=lambda one: (math.hypot(one.x - ego.x, one.y - ego.y), one.id)
    )
    seen = [_encode_actor(ego, one) for one in near[:_NEAREST]]
    values: FloatArray = np.zeros(6 * _NEAREST)
    values[: 6 * len(seen)] = list(chain.from_iterable(seen))
    return values


def _encode_actor(ego: ActorState, one: ActorState) -> tuple[float, ...]:
    cos, sin = math.cos(ego.yaw), math.sin(ego.yaw)
    dx, dy = one.x - ego.x, one.y - ego.y
    # Actors are seen to move where they head.
    vx = one.speed * math.cos(one.yaw) - ego.speed * cos
    vy = one.speed * math.sin(one.yaw) - ego.speed * sin
    return (
        1.0,
        (dx * cos + dy * sin) / _REACH,
        (-dx * sin + dy * cos) / _REACH,
        (vx * cos + vy * sin) / _FASTEST,
        (-vx * sin + vy * cos) / _FASTEST,
        float(one.role is Role.NPC_WALKER),
    )
