"""plant-lite's network in PyTorch, made of its own modules."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from drivora_service.agents.imitation.way_view import EGO_SIZE, PIECE_SIZE, PIECES
from drivora_service.agents.imitation.waypoints import STEP_SCALE, WAYPOINTS
from drivora_service.agents.plant_lite.network import (
    HEADS,
    INNER,
    LAYERS,
    NORM_EPSILON,
    WIDTH,
)
from drivora_service.agents.plant_lite.view import OBJECT_SIZE, OBJECTS, OBJECTS_AT
from drivora_service.training.weight_exchange import Parts


class PlantTrainee:
    """The network in training."""

    def __init__(self) -> None:
        self.modules = nn.ModuleDict(
            {
                "ego": nn.Linear(EGO_SIZE, WIDTH),
                "piece": nn.Linear(PIECE_SIZE, WIDTH),
                "other": nn.Linear(OBJECT_SIZE, WIDTH),
                "layers": nn.ModuleList(
                    nn.TransformerEncoderLayer(
                        WIDTH, HEADS, INNER, dropout=0.0, layer_norm_eps=NORM_EPSILON,
                        batch_first=True, norm_first=True,
                    )
                    for _ in range(LAYERS)
                ),
                "norm": nn.LayerNorm(WIDTH, eps=NORM_EPSILON),
                "decoder": nn.GRUCell(2, WIDTH),
                "step": nn.Linear(WIDTH, 2),
            }
        )  # fmt: skip

    def waypoints(self, seen: Tensor) -> Tensor:
        """Returns (n, 4, 2) waypoints in metres for (n, 262) numbers."""
        parts = self.modules
        pieces = seen[:, EGO_SIZE:OBJECTS_AT].reshape(-1, PIECES, PIECE_SIZE)
        others = seen[:, OBJECTS_AT:].reshape(-1, OBJECTS, OBJECT_SIZE)
        tokens = torch.cat(
            (
                parts["ego"](seen[:, None, :EGO_SIZE]),
                parts["piece"](pieces),
                parts["other"](others),
            ),
            dim=1,
        )
        absent = torch.zeros(tokens.shape[:2], dtype=torch.bool)
        absent[:, 1 + PIECES :] = others[:, :, 0] < 0.5
        *first, last = parts["layers"]
        for layer in first:
            tokens = layer(tokens, src_key_padding_mask=absent)
        state = parts["norm"](_first_token(last, tokens, absent))
        at = torch.zeros(len(seen), 2)
        points = []
        for _ in range(WAYPOINTS):
            state = parts["decoder"](at, state)
            at = at + parts["step"](state)
            points.append(at)
        return STEP_SCALE * torch.stack(points, dim=1)

    def parts(self) -> dict[str, Parts]:
        """Returns the parameters by the agent's names for them."""
        parts, layers = self.modules, self.modules["layers"]
        decoder, norm = parts["decoder"], parts["norm"]
        return {
            "ego": parts["ego"].weight,
            "ego_bias": parts["ego"].bias,
            "piece": parts["piece"].weight,
            "piece_bias": parts["piece"].bias,
            "other": parts["other"].weight,
            "other_bias": parts["other"].bias,
            "attend_norm": [[one.norm1.weight, one.norm1.bias] for one in layers],
            "attend": [one.self_attn.in_proj_weight for one in layers],
            "attend_bias": [one.self_attn.in_proj_bias for one in layers],
            "join": [one.self_attn.out_proj.weight for one in layers],
            "join_bias": [one.self_attn.out_proj.bias for one in layers],
            "think_norm": [[one.norm2.weight, one.norm2.bias] for one in layers],
            "think": [one.linear1.weight for one in layers],
            "think_bias": [one.linear1.bias for one in layers],
            "conclude": [one.linear2.weight for one in layers],
            "conclude_bias": [one.linear2.bias for one in layers],
            "last_norm": [norm.weight, norm.bias],
            "turn_to": decoder.weight_ih,
            "turn_to_bias": decoder.bias_ih,
            "keep": decoder.weight_hh,
            "keep_bias": decoder.bias_hh,
            "step": parts["step"].weight,
            "step_bias": parts["step"].bias,
        }


def _first_token(layer: nn.TransformerEncoderLayer, tokens: Tensor, absent: Tensor) -> Tensor:
    """Returns a layer's output for the (n, WIDTH) first tokens, the only ones that are needed.

    The layer itself would compute all tokens, of which two thirds of the work are unused.
    """
    normal = layer.norm1(tokens)
    mixed, _ = layer.self_attn(
        normal[:, :1], normal, normal, key_padding_mask=absent, need_weights=False
    )
    state = tokens[:, 0] + mixed[:, 0]
    thought = layer.linear2(torch.relu(layer.linear1(layer.norm2(state))))
    joined: Tensor = state + thought
    return joined
