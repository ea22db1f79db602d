"""The network of PufferLib's driving policy: encoders by kind of object, maximum of each, LSTM.

Architecture: class ``GPUDrive`` under ``LSTMWrapper`` in PufferLib 3.0. Inputs are encoded by
one linear layer for each kind of object; of all vehicles and of all pieces of road the largest
response of each of 64 features is kept, so that their order does not matter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import Float32Array
from drivora_service.geometry.layers import product, tanh32

EGO_SIZE = 6
VEHICLES = 63
VEHICLE_SIZE = 7
ROAD_PIECES = 200
ROAD_SIZE = 7
"""The last of them is a kind, 0 to 6, which the network encodes as one of seven inputs."""
ROAD_KINDS = 7
OBSERVATION_SIZE = EGO_SIZE + VEHICLES * VEHICLE_SIZE + ROAD_PIECES * ROAD_SIZE
FEATURES = 64
HIDDEN = 512
ACCELERATIONS = 7
STEERINGS = 13


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DriveWeights:
    """Weights of the policy, inputs first; without the value function.

    Attributes:
        ego: (6, 64) and ``ego_bias`` (64,).
        road: (6, 64) of the numbers of a piece of road, ``road_kinds`` (7, 64) of its kind with the
            bias added.
        vehicle: (7, 64) and ``vehicle_bias`` (64,).
        shared: (192, 512) and ``shared_bias`` (512,), of ego, road and vehicles in this order.
        lstm: (1024, 2048) of input above hidden state, gates in the order input, forget, cell,
            output; ``lstm_bias`` (2048,).
        actor: (512, 20) to logits of the accelerations, then of the steering angles; ``actor_bias``
            (20,).
    """

    ego: Float32Array
    ego_bias: Float32Array
    road: Float32Array
    road_kinds: Float32Array
    vehicle: Float32Array
    vehicle_bias: Float32Array
    shared: Float32Array
    shared_bias: Float32Array
    lstm: Float32Array
    lstm_bias: Float32Array
    actor: Float32Array
    actor_bias: Float32Array


class DrivePolicy:
    """The policy with its memory. One object drives one vehicle."""

    def __init__(self, weights: DriveWeights) -> None:
        """Args: weights: Weights of the network."""
        self._weights = weights
        self.forget()

    def forget(self) -> None:
        """Clears the memory, as at the start of an episode."""
        self._hidden = np.zeros(HIDDEN, dtype=np.float32)
        self._cell = np.zeros(HIDDEN, dtype=np.float32)

    def logits(self, observation: Float32Array) -> Float32Array:
        """Returns the (20,) logits of the actions, and updates the memory.

        Args:
            observation: (1847,) in the layout of ``encoding``.
        """
        w = self._weights
        vehicles_at, road_at = EGO_SIZE, EGO_SIZE + VEHICLES * VEHICLE_SIZE
        vehicles = observation[vehicles_at:road_at].reshape(VEHICLES, VEHICLE_SIZE)
        road = observation[road_at:].reshape(ROAD_PIECES, ROAD_SIZE)
        kinds = road[:, -1].astype(np.int64)
        seen = np.concatenate(
            (
                product(observation[:vehicles_at], w.ego) + w.ego_bias,
                (product(road[:, :-1], w.road) + w.road_kinds[kinds]).max(axis=0),
                product(vehicles, w.vehicle).max(axis=0) + w.vehicle_bias,
            )
        )
        shared = np.maximum(product(_gelu(seen), w.shared) + w.shared_bias, 0.0)
        gates = product(np.concatenate((shared, self._hidden)), w.lstm) + w.lstm_bias
        write, keep, show = (_sigmoid(gates[k * HIDDEN : (k + 1) * HIDDEN]) for k in (0, 1, 3))
        self._cell = keep * self._cell + write * tanh32(gates[2 * HIDDEN : 3 * HIDDEN])
        self._hidden = show * tanh32(self._cell)
        logits: Float32Array = product(self._hidden, w.actor) + w.actor_bias
        return logits


def _gelu(x: Float32Array) -> Float32Array:
    """Returns x Phi(x) with the normal distribution function (Hendrycks and Gimpel 2016)."""
    # For so few numbers, no library of special functions is loaded.
    scaled = (x * math.sqrt(0.5)).tolist()
    share = np.fromiter(map(math.erf, scaled), dtype=np.float32, count=len(scaled))
    weighted: Float32Array = np.float32(0.5) * x * (np.float32(1.0) + share)
    return weighted


def _sigmoid(x: Float32Array) -> Float32Array:
    """Returns 1 / (1 + exp(-x)), without overflow."""
    share: Float32Array = np.float32(0.5) * (np.float32(1.0) + tanh32(np.float32(0.5) * x))
    return share
