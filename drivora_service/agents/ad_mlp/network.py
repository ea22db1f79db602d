"""ad-mlp's network: two hidden layers, and the displacement from each waypoint to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.agents.imitation.waypoints import STEP_SCALE, WAYPOINTS
from drivora_service.geometry.array_shapes import Float32Array
from drivora_service.geometry.layers import product

HIDDEN = 192


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AdMlpWeights:
    """Weights of the network, inputs first.

    Attributes:
        first: (112, 192) and ``first_bias`` (192,).
        second: (192, 192) and ``second_bias`` (192,).
        steps: (192, 8) and ``steps_bias`` (8,).
    """

    first: Float32Array
    first_bias: Float32Array
    second: Float32Array
    second_bias: Float32Array
    steps: Float32Array
    steps_bias: Float32Array


class AdMlpNetwork:
    """The network."""

    def __init__(self, weights: AdMlpWeights) -> None:
        """Args: weights: Weights of the network."""
        self._weights = weights

    def waypoints(self, seen: Float32Array) -> Float32Array:
        """Returns (4, 2) places after each half second, in the ego's frame, metres.

        Args:
            seen: (112,) in the layout of ``view``.
        """
        w = self._weights
        hidden = product(seen, w.first)
        hidden += w.first_bias
        np.maximum(hidden, 0.0, out=hidden)
        hidden = product(hidden, w.second)
        hidden += w.second_bias
        np.maximum(hidden, 0.0, out=hidden)
        steps = product(hidden, w.steps)
        steps += w.steps_bias
        points: Float32Array = steps.reshape(WAYPOINTS, 2).cumsum(axis=0, dtype=np.float32)
        points *= np.float32(STEP_SCALE)
        return points
