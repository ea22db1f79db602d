"""A planner that simulates proposals along its route, scores them and executes the best.

The method of PDM-Closed: Dauner, Hallgarten, Geiger, Chitta, *Parting with Misconceptions about
Learning-based Vehicle Motion Planning* (CoRL 2023). Lights, right of way and lane changes that the
route needs are those of ``idm``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.idm.corridor import SIDE_ROOM, TIGHT_ROOM, Actors, gap_on_line
from drivora_service.agents.idm.right_of_way import HARD_BRAKING, PATIENCE, find_halts, next_signal
from drivora_service.agents.idm.run_following import RunFollower, WayCol
from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation
from drivora_service.agents.pdm_closed.forecast import (
    STEP,
    STEPS,
    FutureCol,
    SeenCol,
    forecast,
    see_from_way,
)
from drivora_service.agents.pdm_closed.margins import MarginCol, side_margins
from drivora_service.agents.pdm_closed.parameters import PdmParameters
from drivora_service.agents.pdm_closed.paths import LanePaths
from drivora_service.agents.pdm_closed.proposals import (
    Choices,
    ProposalCol,
    ProposingCar,
    SeenActors,
    Start,
    propose,
)
from drivora_service.agents.pdm_closed.scoring import ScoreCol, score
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.observations.trace import Col

FACTORS = (1.0, 0.8, 0.6, 0.4, 0.2)
"""Shares of the speed limit that proposals are driven at, as in the paper."""
_WATCHED = 40.0
"""Radius within which all actors count, metres; beyond, those that can come near in time."""
_ROAD_AHEAD = 30
"""Number of points of the way (about metres) whose narrowest place bounds the offsets."""
_EDGE_ROOM = 0.15
"""Metres that proposals keep from the edge of the road."""
_OFFSET_COST = 0.05
"""Penalty of a proposal beside the lane's centre, in score: of equal ones, the middle wins."""
_CHANGE_COST = 0.02
"""Penalty of an offset other than that of the preceding step."""


class PdmClosedAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, parameters: PdmParameters) -> None:
        self._parameters = parameters

    def setup_env(self, context: AgentContext) -> None:
        """Finds the lane runs of the route, and the room beside them."""
        model = context.model
        self._runs = RunFollower(context, self._parameters.speed_factor)
        self._margins = [side_margins(context.network, way.run) for way in self._runs.ways]
        self._paths = LanePaths(context.network)
        self._half_length, self._half_width = 0.5 * model.length, 0.5 * model.width
        grip = 9.81 * context.friction
        self._max_braking = min(model.max_deceleration, grip)
        self._car = ProposingCar(
            half_length=self._half_length,
            half_width=self._half_width,
            wheelbase=model.wheelbase,
            max_braking=self._max_braking,
            max_steer=model.max_steer,
            max_speed=model.max_speed,
            grip=grip,
        )
        self._offsets = np.zeros(3)
        self._factors = np.array(FACTORS)
        self._stops = np.empty(len(FACTORS))
        count = len(self._offsets) * len(FACTORS)
        self._proposed = np.zeros((count, STEPS + 1, len(ProposalCol)))
        self._found = np.zeros((count, len(ScoreCol)))
        self._chosen = 0
        self._asked = 0.0
        self._share = min(context.step_length / STEP, 1.0)
        self._log = context.log
        self._log.declare("offset", "speed_factor", "score", "collision_time", "halt_distance")

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Returns the first control of the best proposal."""
        runs, v = self._runs, observation.speed
        runs.wait(v)
        runs.change_when_possible(observation)
        way, ego = runs.way, observation.ego
        line, arc = way.points[:, : WayCol.ARC], way.points[:, WayCol.ARC]
        x, y = ego[:2].tolist()
        runs.cursor, s, lateral = track_line(line, arc, runs.cursor, 5, 30, x, y)
        watched = self._find_watched(observation)
        objects, sizes = observation.objects[watched], observation.object_sizes[watched]
        kinds, ids = observation.object_kinds[watched], observation.object_ids[watched]
        future = np.empty((STEPS + 1, len(objects), len(FutureCol)))
        seen = np.empty((STEPS + 1, len(objects), len(SeenCol)))
        forecast(
            objects, self._paths.spans(observation.step, objects, kinds, ids),
            self._paths.points, future,
        )  # fmt: skip
        see_from_way(way.points, runs.cursor, sizes, future, seen)
        room = SIDE_ROOM if runs.waited < PATIENCE else TIGHT_ROOM
        self._find_stops(observation, objects, sizes, kinds, s, room)
        self._find_offsets()
        start = Start(ego.copy(), v, self._asked, observation.steer, runs.cursor, s, lateral)
        choices = Choices(self._offsets, self._factors, self._stops)
        propose(
            start, self._car, way.points, choices, SeenActors(seen, kinds, room), self._proposed
        )
        score(
            self._proposed, self._asked, self._half_length, self._half_width,
            way.points, self._margins[runs.current], future, sizes, self._found,
        )  # fmt: skip
        return self._execute(s)

    def _find_watched(self, observation: Observation) -> NDArray[np.int64]:
        """Returns the rows of the actors that can come near within the forecast."""
        objects, ego = observation.objects, observation.ego
        away = np.hypot(objects[:, Col.X] - ego[Col.X], objects[:, Col.Y] - ego[Col.Y])
        speeds = np.hypot(objects[:, Col.VX], objects[:, Col.VY])
        rows: NDArray[np.int64] = np.flatnonzero(
            away < _WATCHED + STEPS * STEP * (observation.speed + speeds)
        )
        return rows

    def _find_offsets(self) -> None:
        """Fills in the offsets to each side that the road ahead allows."""
        cursor, half_width = self._runs.cursor, self._half_width
        ahead = self._margins[self._runs.current][cursor : cursor + _ROAD_AHEAD]
        left, right = ahead[:, : MarginCol.ONCOMING].min(axis=0).tolist()
        side = self._parameters.offset
        self._offsets[1] = min(side, max(left - half_width - _EDGE_ROOM, 0.0))
        self._offsets[2] = -min(side, max(right - half_width - _EDGE_ROOM, 0.0))

    def _find_stops(
        self,
        observation: Observation,
        objects: FloatArray,
        sizes: FloatArray,
        kinds: NDArray[np.int64],
        s: float,
        room: float,
    ) -> None:
        """Fills in the arc lengths at which lights, right of way and lane ends halt each speed."""
        runs, v = self._runs, observation.speed
        way = runs.way
        line, arc = way.points[:, : WayCol.ARC], way.points[:, WayCol.ARC]
        actors, signal = Actors(objects, sizes, kinds), next_signal(observation)
        ahead = gap_on_line(
            line, arc, runs.cursor, s, min(90.0, 25.0 + 4.0 * v), self._half_length,
            self._half_width, room, v, actors,
        )  # fmt: skip
        limit = float(way.points[runs.cursor, WayCol.WANTED])
        find_halts(
            v, s, limit * self._factors, runs.waited, signal, actors, self._half_length, way.wall,
            way.conflicts, ahead, self._stops,
        )  # fmt: skip
        self._stops += s
        self._stops += self._half_length

    def _execute(self, s: float) -> AccelerationControl:
        """Chooses a proposal and returns its first control."""
        found, factors = self._found, len(FACTORS)
        beside = np.arange(len(found)) // factors
        merit = found[:, ScoreCol.SCORE] - _OFFSET_COST * (beside > 0)
        merit -= _CHANGE_COST * (beside != self._chosen // factors)
        if found[:, ScoreCol.SCORE].max() <= 0.0:
            # All are bad: the one that is good for longest; if all collide, the slowest.
            collisions = found[:, ScoreCol.COLLISION_TIME]
            share = -1e-3 if np.isfinite(collisions).all() else 1e-3
            merit += np.minimum(collisions, 10.0) + share * found[:, ScoreCol.PROGRESS]
        best = int(np.argmax(merit))
        self._chosen = best
        first = self._proposed[best, 0].tolist()
        asked, steer = first[ProposalCol.ACCELERATION], first[ProposalCol.STEER]
        before = self._asked
        # A proposal's steps are longer than the agent's; except for emergency braking.
        self._asked = asked if asked < -HARD_BRAKING else before + self._share * (asked - before)
        if found[best, ScoreCol.COLLISION_TIME] <= self._parameters.brake_within:
            self._asked = -min(self._parameters.emergency_braking, self._max_braking)
        self._log.plan(self._proposed[best, :, : ProposalCol.YAW])
        row = self._log.row
        row[0], row[1] = self._offsets[best // factors], FACTORS[best % factors]
        row[2], row[3] = found[best, ScoreCol.SCORE], found[best, ScoreCol.COLLISION_TIME]
        row[4] = self._stops[best % factors] - s - self._half_length
        return AccelerationControl(self._asked, steer)
