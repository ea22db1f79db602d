"""ad-mlp's network in PyTorch."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from drivora_service.agents.ad_mlp.network import HIDDEN
from drivora_service.agents.ad_mlp.view import SEEN_SIZE
from drivora_service.agents.imitation.waypoints import STEP_SCALE, WAYPOINTS
from drivora_service.training.weight_exchange import Parts


class AdMlpTrainee:
    """The network in training."""

    def __init__(self) -> None:
        self.modules = nn.Sequential(
            nn.Linear(SEEN_SIZE, HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, 2 * WAYPOINTS),
        )

    def waypoints(self, seen: Tensor) -> Tensor:
        """Returns (n, 4, 2) waypoints in metres for (n, 112) numbers."""
        steps = self.modules(seen).reshape(-1, WAYPOINTS, 2)
        return STEP_SCALE * torch.cumsum(steps, dim=1)

    def parts(self) -> dict[str, Parts]:
        """Returns the parameters by the agent's names for them."""
        first, second, steps = (self.modules[k] for k in (0, 2, 4))
        return {
            "first": first.weight,
            "first_bias": first.bias,
            "second": second.weight,
            "second_bias": second.bias,
            "steps": steps.weight,
            "steps_bias": steps.bias,
        }
