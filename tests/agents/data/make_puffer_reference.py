"""Makes ``puffer_drive.npz``: what PufferLib's own network answers to observations.

Run in an environment of its own with ``torch``, ``numpy``, ``gymnasium`` and the unpacked source
archive of ``pufferlib`` 3.0.0 (building it is not needed)::

    PYTHONPATH=pufferlib-3.0.0 python make_puffer_reference.py pufferlib-3.0.0 puffer_drive.npz

The observations are drawn: eight steps of a scene whose vehicles move, in the ranges that occur.
The memory is carried from step to step.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import torch
from gymnasium import spaces
from pufferlib.models import LSTMWrapper
from pufferlib.ocean.torch import GPUDrive

STEPS, VEHICLES, PIECES = 8, 12, 180


def draw_observations() -> np.ndarray:
    rng = np.random.default_rng(7)
    seen = np.zeros((STEPS, 1847), dtype=np.float32)
    vehicles = seen[:, 6:447].reshape(STEPS, 63, 7)
    road = seen[:, 447:].reshape(STEPS, 200, 7)
    start = rng.uniform(-0.4, 0.4, (VEHICLES, 2))
    speed, heading = rng.uniform(0.0, 0.15, VEHICLES), rng.uniform(-np.pi, np.pi, VEHICLES)
    places = rng.uniform(-0.5, 0.5, (PIECES, 2))
    direction = rng.uniform(-np.pi, np.pi, PIECES)
    for step in range(STEPS):
        seen[step, :5] = 0.4 - 0.008 * step, 0.02 * np.sin(step), 0.08, 0.093, 0.114
        motion = np.column_stack((np.cos(heading), np.sin(heading))) * speed[:, None]
        vehicles[step, :VEHICLES, :2] = start + 0.1 * step * motion
        vehicles[step, :VEHICLES, 2:4] = 0.093, 0.114
        vehicles[step, :VEHICLES, 4] = 0.5 * np.pi * np.cos(heading)
        vehicles[step, :VEHICLES, 5] = 0.5 * np.pi * np.sin(heading)
        vehicles[step, :VEHICLES, 6] = speed
        road[step, :PIECES, :2] = places - [0.008 * step, 0.0]
        road[step, :PIECES, 2:4] = 0.03, 0.001
        road[step, :PIECES, 4] = 0.5 * np.pi * np.cos(direction)
        road[step, :PIECES, 5] = 0.5 * np.pi * np.sin(direction)
        road[step, :PIECES, 6] = np.arange(PIECES) % 3
    return seen


def main(source: Path, path: Path) -> None:
    env = SimpleNamespace(
        single_observation_space=spaces.Box(-1, 1, (1847,), np.float32),
        single_action_space=spaces.MultiDiscrete([7, 13]),
    )
    network = LSTMWrapper(env, GPUDrive(env, input_size=64, hidden_size=512), 512, 512)
    numbers = np.fromfile(
        source / "pufferlib" / "resources" / "gpudrive" / "gpudrive_weights.bin", dtype=np.float32
    )
    at = 0
    with torch.no_grad():
        for _, parameter in network.named_parameters():
            part = numbers[at : at + parameter.numel()].reshape(tuple(parameter.shape))
            parameter.copy_(torch.from_numpy(part.copy()))
            at += parameter.numel()
        assert at == len(numbers)
        seen, state, logits = draw_observations(), {"lstm_h": None, "lstm_c": None}, []
        for one in seen:
            actions, _ = network.forward_eval(torch.from_numpy(one[None]), state)
            logits.append(torch.cat(actions, dim=1)[0].numpy())
    np.savez_compressed(path, observation=seen, logits=np.array(logits, dtype=np.float32))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
