"""The expert's network: two hidden layers with tanh, as in MetaDrive's own NumPy expert."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.geometry.array_shapes import Float32Array
from drivora_service.geometry.layers import product, tanh32

OBSERVATION_SIZE = 275
HIDDEN = 256


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ExpertWeights:
    """Weights of the policy; without the value function.

    Attributes:
        first: (275, 256).
        first_bias: (256,).
        second: (256, 256).
        second_bias: (256,).
        out: (256, 2) to the means of the actions; without the columns for their spread.
        out_bias: (2,).
    """

    first: Float32Array
    first_bias: Float32Array
    second: Float32Array
    second_bias: Float32Array
    out: Float32Array
    out_bias: Float32Array


def expert_action(weights: ExpertWeights, observation: Float32Array) -> Float32Array:
    """Returns the mean action of the expert, not clipped.

    Args:
        weights: Weights of the network.
        observation: (275,) in the layout of ``encoding``.

    Returns:
        (2,) steering and throttle or brake, both intended for -1..1.
    """
    hidden = tanh32(product(observation, weights.first) + weights.first_bias)
    hidden = tanh32(product(hidden, weights.second) + weights.second_bias)
    action: Float32Array = product(hidden, weights.out) + weights.out_bias
    return action
