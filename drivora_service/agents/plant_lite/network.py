"""plant-lite's network: a transformer over tokens, and a recurrent decoder of waypoints.

As in PlanT (Renz et al. 2022), inputs become tokens by one linear layer for each kind of object;
the token of the ego replaces PlanT's [CLS], and its encoding initialises a gated recurrent unit
that outputs one waypoint after the other. Layers are normalised before attention and before the
feed-forward part (Xiong et al. 2020).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.agents.imitation.way_view import EGO_SIZE, PIECE_SIZE, PIECES
from drivora_service.agents.imitation.waypoints import STEP_SCALE, WAYPOINTS
from drivora_service.agents.plant_lite.view import OBJECT_SIZE, OBJECTS, OBJECTS_AT
from drivora_service.geometry.array_shapes import Float32Array
from drivora_service.geometry.layers import exp32, product, products, tanh32

WIDTH = 48
HEADS = 4
LAYERS = 2
INNER = 96
"""Width of the feed-forward part."""
NORM_EPSILON = 1e-5
_TOKENS = 1 + PIECES + OBJECTS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlantWeights:
    """Weights of the network, inputs first; L layers, each token of width 48.

    Attributes:
        ego: (10, 48) and ``ego_bias`` (48,).
        piece: (7, 48) and ``piece_bias`` (48,).
        other: (14, 48) and ``other_bias`` (48,).
        attend_norm: (L, 2, 48) factor and offset.
        attend: (L, 48, 144) to queries, keys and values; ``attend_bias`` (L, 144).
        join: (L, 48, 48) of all heads; ``join_bias`` (L, 48).
        think_norm: (L, 2, 48) factor and offset.
        think: (L, 48, 96); ``think_bias`` (L, 96).
        conclude: (L, 96, 48); ``conclude_bias`` (L, 48).
        last_norm: (2, 48).
        turn_to: (2, 144) from the last waypoint to reset, update and new state; ``turn_to_bias``
            (144,).
        keep: (48, 144) from the state to the same; ``keep_bias`` (144,).
        step: (48, 2) to the displacement to the next waypoint; ``step_bias`` (2,).
    """

    ego: Float32Array
    ego_bias: Float32Array
    piece: Float32Array
    piece_bias: Float32Array
    other: Float32Array
    other_bias: Float32Array
    attend_norm: Float32Array
    attend: Float32Array
    attend_bias: Float32Array
    join: Float32Array
    join_bias: Float32Array
    think_norm: Float32Array
    think: Float32Array
    think_bias: Float32Array
    conclude: Float32Array
    conclude_bias: Float32Array
    last_norm: Float32Array
    turn_to: Float32Array
    turn_to_bias: Float32Array
    keep: Float32Array
    keep_bias: Float32Array
    step: Float32Array
    step_bias: Float32Array


class PlantNetwork:
    """The network with its buffers. One object drives one ego."""

    def __init__(self, weights: PlantWeights) -> None:
        """Args: weights: Weights of the network."""
        self._weights = weights
        self._tokens = np.empty((_TOKENS, WIDTH), dtype=np.float32)
        self._heads = np.empty((_TOKENS, 3 * WIDTH), dtype=np.float32)
        self._inner = np.empty((_TOKENS, INNER), dtype=np.float32)
        self._waypoints = np.empty((WAYPOINTS, 2), dtype=np.float32)

    def waypoints(self, seen: Float32Array) -> Float32Array:
        """Returns (4, 2) places after each half second, in the ego's frame, metres.

        Args:
            seen: (262,) in the layout of ``view``.

        Returns:
            An array that the next call overwrites.
        """
        return self._decode(self._encode(seen))

    def _encode(self, seen: Float32Array) -> Float32Array:
        """Returns the (48,) token of the ego after the encoder."""
        w = self._weights
        others = seen[OBJECTS_AT:].reshape(OBJECTS, OBJECT_SIZE)
        count = 1 + PIECES + int(others[:, 0].sum())
        tokens, heads, inner = self._tokens[:count], self._heads[:count], self._inner[:count]
        pieces = seen[EGO_SIZE:OBJECTS_AT].reshape(PIECES, PIECE_SIZE)
        np.add(product(seen[:EGO_SIZE], w.ego), w.ego_bias, out=tokens[0])
        np.add(product(pieces, w.piece), w.piece_bias, out=tokens[1 : 1 + PIECES])
        shown = others[: count - 1 - PIECES]
        np.add(product(shown, w.other), w.other_bias, out=tokens[1 + PIECES :])
        for layer in range(LAYERS):
            # Only the ego's token of the last layer is needed.
            if layer == LAYERS - 1:
                wanted, inner = tokens[:1], inner[:1]
            else:
                wanted = tokens
            given = product(_normal(tokens, w.attend_norm[layer]), w.attend[layer])
            np.add(given, w.attend_bias[layer], out=heads)
            mixed = _attention(heads, len(wanted))
            wanted += product(mixed, w.join[layer])
            wanted += w.join_bias[layer]
            given = product(_normal(wanted, w.think_norm[layer]), w.think[layer])
            np.add(given, w.think_bias[layer], out=inner)
            np.maximum(inner, 0.0, out=inner)
            wanted += product(inner, w.conclude[layer])
            wanted += w.conclude_bias[layer]
        last: Float32Array = _normal(tokens[:1], w.last_norm)[0]
        return last

    def _decode(self, state: Float32Array) -> Float32Array:
        """Returns waypoints by a gated recurrent unit (Cho et al. 2014) from its first state."""
        w, points = self._weights, self._waypoints
        at = np.zeros(2, dtype=np.float32)
        for k in range(WAYPOINTS):
            given = product(at, w.turn_to) + w.turn_to_bias
            kept = product(state, w.keep) + w.keep_bias
            gates = _sigmoid(given[: 2 * WIDTH] + kept[: 2 * WIDTH])
            reset, update = gates[:WIDTH], gates[WIDTH:]
            fresh = tanh32(given[2 * WIDTH :] + reset * kept[2 * WIDTH :])
            state = fresh + update * (state - fresh)
            at = at + (product(state, w.step) + w.step_bias)
            np.multiply(at, np.float32(STEP_SCALE), out=points[k])
        return points


def _normal(tokens: Float32Array, norm: Float32Array) -> Float32Array:
    """Normalises each token (Ba, Kiros, Hinton 2016)."""
    centred: Float32Array = tokens - tokens.mean(axis=1, keepdims=True)
    spread = np.einsum("ij,ij->i", centred, centred) / np.float32(tokens.shape[1])
    centred *= norm[0] / np.sqrt(spread + np.float32(NORM_EPSILON))[:, None]
    centred += norm[1]
    return centred


def _attention(heads: Float32Array, queries: int) -> Float32Array:
    """Mixes values by scaled dot products (Vaswani et al. 2017).

    Args:
        heads: (n, 144) queries, keys and values of all heads.
        queries: Number of tokens with queries.

    Returns:
        (queries, 48).
    """
    parts = heads.reshape(len(heads), 3, HEADS, WIDTH // HEADS)
    ask = parts[:queries, 0].transpose(1, 0, 2)
    offer = parts[:, 1].transpose(1, 2, 0)
    value = parts[:, 2].transpose(1, 0, 2)
    share = products(ask, offer)
    share *= np.float32(1.0 / math.sqrt(WIDTH // HEADS))
    share -= share.max(axis=2, keepdims=True)
    share = exp32(share)
    share /= share.sum(axis=2, keepdims=True)
    mixed = products(share, value)
    return mixed.transpose(1, 0, 2).reshape(queries, WIDTH)


def _sigmoid(x: Float32Array) -> Float32Array:
    """Returns 1 / (1 + exp(-x)), without overflow."""
    share: Float32Array = np.float32(0.5) * (np.float32(1.0) + tanh32(np.float32(0.5) * x))
    return share
