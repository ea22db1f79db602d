"""Makes ``plant_lite.npz`` and ``ad_mlp.npz``: what PyTorch answers with the shipped weights.

Run with the extra ``training``::

    python tests/agents/data/make_imitation_reference.py tests/agents/data plant-lite ad-mlp

The expert of the training drives two runs of each network to which nothing was fitted; of what the
networks would see there every 40th sample is stored, with the waypoints that PyTorch's own modules
make of it.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import torch

from drivora_service.agents.imitation.weights import load_weights
from drivora_service.training.imitation import RECIPES, record_held_out_samples
from drivora_service.training.weight_exchange import put_weights

EVERY = 40


def main(folder: Path, agents: list[str]) -> None:
    torch.set_num_threads(1)
    for agent in agents:
        recipe = RECIPES[agent]
        trainee = recipe.trainee()
        put_weights(load_weights(recipe.weights), trainee.parts())
        trainee.modules.eval()
        samples = record_held_out_samples(recipe, 2)
        seen = samples.seen[::EVERY]
        with torch.no_grad():
            waypoints = trainee.waypoints(torch.from_numpy(seen)).numpy()
        path = folder / f"{agent.replace('-', '_')}.npz"
        np.savez_compressed(path, seen=seen, waypoints=waypoints)
        print(f"{path}: {len(seen)} samples")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
