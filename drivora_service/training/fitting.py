"""Fitting of a network to samples, and its errors on held-out samples."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch
from torch import Tensor

from drivora_service.agents.imitation.way_view import SPEED_SCALE
from drivora_service.agents.imitation.waypoints import INTERVAL, WAYPOINTS
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.training.demonstrations import Samples
from drivora_service.training.weight_exchange import Parts

_WEIGHT_DECAY = 1e-4
_SIDE_WEIGHT = 2.0
"""Weight of a lateral error; a longitudinal one has 1."""
_LONGEST_GRADIENT = 1.0


class Trainee(Protocol):
    """A network in training."""

    modules: torch.nn.Module

    def waypoints(self, seen: Tensor) -> Tensor:
        """Returns (n, 4, 2) waypoints in metres for (n, K) numbers."""
        ...

    def parts(self) -> dict[str, Parts]:
        """Returns the parameters by the agent's names for them."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class DisplacementErrors:
    """Mean distances between predicted and actual places of the expert, metres.

    Attributes:
        after: Errors of the waypoints, 0.5 s apart.
    """

    after: tuple[float, ...]

    def __str__(self) -> str:
        told = (f"{INTERVAL * (k + 1):g} s {self.after[k]:.3f} m" for k in (0, 1, 3))
        return ", ".join(told)


def fit(
    trainee: Trainee, samples: Samples, *, epochs: int, batch: int, rate: float, seed: int
) -> None:
    """Fits a network by AdamW to the least absolute error; the learning rate ends at zero.

    Args:
        trainee: Network, fitted from its present weights on.
        samples: Samples to fit to.
        epochs: Number of passes over the samples.
        batch: Samples in each step.
        rate: Highest learning rate.
        seed: Seed of the order of the samples.
    """
    generator = torch.Generator().manual_seed(seed)
    seen, wanted = torch.from_numpy(samples.seen), torch.from_numpy(samples.waypoints)
    known = torch.from_numpy(samples.known).float()[:, :, None]
    weight = known * torch.tensor([1.0, _SIDE_WEIGHT])
    batches = math.ceil(len(seen) / batch)
    optimiser = torch.optim.AdamW(trainee.modules.parameters(), lr=rate, weight_decay=_WEIGHT_DECAY)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimiser, max_lr=rate, total_steps=epochs * batches, pct_start=0.1
    )
    trainee.modules.train()
    for _ in range(epochs):
        order = torch.randperm(len(seen), generator=generator)
        for rows in order.split(batch):
            error = (trainee.waypoints(seen[rows]) - wanted[rows]).abs() * weight[rows]
            loss = error.sum() / weight[rows].sum()
            optimiser.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(trainee.modules.parameters(), _LONGEST_GRADIENT)
            optimiser.step()
            schedule.step()


def errors_of(trainee: Trainee, samples: Samples) -> DisplacementErrors:
    """Returns the errors of a network."""
    trainee.modules.eval()
    with torch.no_grad():
        parts = [trainee.waypoints(part) for part in torch.from_numpy(samples.seen).split(1024)]
    return _errors(torch.cat(parts).numpy().astype(np.float64), samples)


def errors_at_constant_velocity(samples: Samples) -> DisplacementErrors:
    """Returns the errors of predicting constant velocity."""
    points = np.zeros(samples.waypoints.shape)
    speed = samples.seen[:, 0].astype(np.float64) / SPEED_SCALE
    points[:, :, 0] = speed[:, None] * INTERVAL * np.arange(1, WAYPOINTS + 1)
    return _errors(points, samples)


def _errors(points: FloatArray, samples: Samples) -> DisplacementErrors:
    distance = np.hypot(*(points - samples.waypoints).transpose(2, 0, 1))
    after = [float(distance[samples.known[:, k], k].mean()) for k in range(WAYPOINTS)]
    return DisplacementErrors(after=tuple(after))
