"""Inputs of ad-mlp: the ego, its way and its past, in (112,) numbers; no other actors.

===========  =====================================================================================
0 to 9       the ego, as in ``WayView.show``
10 to 93     twelve pieces of the way, seven numbers each, likewise
94 to 109    its places 0.5, 1, 1.5 and 2 s ago: ahead and to the left (1/40 m), sine of its
             heading then, speed then (1/15 s/m)
110, 111     its acceleration (1/4 s²/m) and yaw rate (s)
===========  =====================================================================================

Places and headings are in the ego's present frame.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from drivora_service.agents.imitation.way_view import (
    EGO_SIZE,
    LENGTH_SCALE,
    PIECE_SIZE,
    PIECES,
    SPEED_SCALE,
    WayView,
)
from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import Float32Array, FloatArray
from drivora_service.observations.trace import Col


class _FrameInput(IntEnum):
    """Inputs of one place of the past."""

    AHEAD = 0
    LEFT = 1
    HEADING = 2
    """Its sine."""
    SPEED = 3


class _Past(IntEnum):
    """Columns of the kept places."""

    X = 0
    Y = 1
    YAW = 2
    SPEED = 3


FRAMES = 4
FRAME_SIZE = len(_FrameInput)
FRAMES_AT = EGO_SIZE + PIECES * PIECE_SIZE
SEEN_SIZE = FRAMES_AT + FRAMES * FRAME_SIZE + 2
_INTERVAL = 0.5
"""Seconds between two frames."""
_ACCELERATION_SCALE = 0.25


class AdMlpView:
    """Fills the inputs of the network.

    Attributes:
        seen: (112,) after ``look``.
    """

    def __init__(self) -> None:
        self.seen = np.zeros(SEEN_SIZE, dtype=np.float32)
        self._own = self.seen[:EGO_SIZE]
        self._pieces = self.seen[EGO_SIZE:FRAMES_AT].reshape(PIECES, PIECE_SIZE)
        self._frames = self.seen[FRAMES_AT:-2].reshape(FRAMES, FRAME_SIZE)

    def setup_env(self, context: AgentContext) -> None:
        """Finds the way of a run and clears the past."""
        self._way = WayView(context)
        self._apart = max(round(_INTERVAL / context.step_length), 1)
        self._past = np.zeros((FRAMES * self._apart + 1, len(_Past)))
        self._now = -1

    def follow(self, observation: Observation) -> None:
        """Follows the way, and stores the place."""
        self._way.follow(observation)
        ego = observation.ego
        state = (ego[Col.X], ego[Col.Y], ego[Col.YAW], observation.speed)
        if self._now < 0:
            # Before the first step it stood at its place.
            self._past[:] = (*state[:3], 0.0)
        self._now = (self._now + 1) % len(self._past)
        self._past[self._now] = state

    def look(self, observation: Observation) -> None:
        """Fills ``seen``."""
        self._way.show(observation, self._own, self._pieces)
        show_past(observation.ego, self._past, self._now, self._apart, self._frames)
        self.seen[-2] = _ACCELERATION_SCALE * observation.acceleration
        self.seen[-1] = observation.ego[Col.YAW_RATE]


@compiled
def show_past(ego: FloatArray, past: FloatArray, now: int, apart: int, out: Float32Array) -> None:
    """Fills the frames.

    Args:
        ego: (9,) the ego's state.
        past: (n, 4) of the last n steps, in a ring, columns ``_Past``.
        now: Row of ``past`` for this step.
        apart: Steps between two frames.
        out: (4, 4) filled.
    """
    cos, sin = math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW])
    for k in range(FRAMES):
        then = past[(now - (k + 1) * apart) % past.shape[0]]
        dx, dy = then[_Past.X] - ego[Col.X], then[_Past.Y] - ego[Col.Y]
        out[k, _FrameInput.AHEAD] = LENGTH_SCALE * (dx * cos + dy * sin)
        out[k, _FrameInput.LEFT] = LENGTH_SCALE * (dy * cos - dx * sin)
        out[k, _FrameInput.HEADING] = math.sin(then[_Past.YAW] - ego[Col.YAW])
        out[k, _FrameInput.SPEED] = SPEED_SCALE * then[_Past.SPEED]
