"""The actors of an episode as arrays that grow: a row for each actor, a frame for each step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.interface import ObjectKind
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.observations.trace import Actor, Col, EgoCol, Role

_MOST_ROWS_AT_ONCE = 4096
KIND_OF_ROLE = {
    Role.EGO: ObjectKind.VEHICLE,
    Role.NPC_VEHICLE: ObjectKind.VEHICLE,
    Role.BACKGROUND: ObjectKind.VEHICLE,
    Role.NPC_WALKER: ObjectKind.WALKER,
    Role.NPC_OBSTACLE: ObjectKind.OBSTACLE,
}


class WorldFrames(NamedTuple):
    """The frames of all actors, as the kernels of a step take them.

    Attributes:
        states: (capacity, N, 9) frames, columns ``Col``.
        present: (capacity, N) whether the actor is in the world.
        sizes: (N, 2), columns ``SizeCol``.
    """

    states: FloatArray
    present: BoolArray
    sizes: FloatArray


class World:
    """All frames of all actors so far.

    Attributes:
        actors: Rows in order; the egos come first.
        sizes: (N, 2), columns ``SizeCol``.
        heights: (N,) metres.
        kinds: (N,) ``ObjectKind``.
        states: (capacity, N, 9) frames, columns ``Col``.
        present: (capacity, N).
        ego_values: (capacity, M, 8), columns ``EgoCol``.
        ego_lights: (capacity, M).
        logs: (capacity, M, K) numeric agent logs.
        frames: The present arrays of ``states``, ``present`` and ``sizes``; another record after
            ``grow`` and ``add_actor``.
    """

    def __init__(
        self,
        actors: list[Actor],
        heights: Sequence[float],
        ego_count: int,
        log_count: int,
        *,
        expected_rows: int,
    ) -> None:
        """Allocates ``expected_rows`` frames, up to a limit; grows as needed."""
        self.actors = actors
        self.heights: FloatArray = np.array(heights)
        self.ego_count = ego_count
        self.sizes: FloatArray = np.array([(a.length, a.width) for a in actors])
        self.kinds: IntArray = np.array([KIND_OF_ROLE[a.role] for a in actors], dtype=np.int64)
        n = len(actors)
        rows = min(max(expected_rows, 1), _MOST_ROWS_AT_ONCE)
        # Not filled: with the rates, each step writes NaN to the rows of absent actors.
        self.states: FloatArray = np.empty((rows, n, len(Col)))
        self.present: BoolArray = np.zeros((rows, n), dtype=np.bool_)
        self.ego_values: FloatArray = np.full((rows, ego_count, len(EgoCol)), np.nan)
        self.ego_lights: NDArray[np.uint8] = np.zeros((rows, ego_count), dtype=np.uint8)
        self.logs: FloatArray = np.full((rows, ego_count, log_count), np.nan)
        self.frames = WorldFrames(self.states, self.present, self.sizes)

    @property
    def capacity(self) -> int:
        """Number of frames that fit."""
        return len(self.states)

    def grow(self) -> None:
        """Doubles the capacity for frames."""
        more = self.capacity
        self.states = np.concatenate((self.states, np.empty_like(self.states)))
        self.present = np.concatenate((self.present, np.zeros_like(self.present)))
        self.ego_values = np.concatenate(
            (self.ego_values, np.full((more, *self.ego_values.shape[1:]), np.nan))
        )
        self.ego_lights = np.concatenate((self.ego_lights, np.zeros_like(self.ego_lights)))
        self.logs = np.concatenate((self.logs, np.full((more, *self.logs.shape[1:]), np.nan)))
        self.frames = WorldFrames(self.states, self.present, self.sizes)

    def add_actor(self, actor: Actor, height: float) -> None:
        """Adds a row; the actor is absent in all frames so far."""
        self.actors.append(actor)
        self.heights = np.append(self.heights, height)
        self.sizes = np.concatenate((self.sizes, [(actor.length, actor.width)]))
        self.kinds = np.append(self.kinds, KIND_OF_ROLE[actor.role])
        empty = np.full((self.capacity, 1, len(Col)), np.nan)
        self.states = np.concatenate((self.states, empty), axis=1)
        absent = np.zeros((self.capacity, 1), dtype=np.bool_)
        self.present = np.concatenate((self.present, absent), axis=1)
        self.frames = WorldFrames(self.states, self.present, self.sizes)
