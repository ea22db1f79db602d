"""Trains ``plant-lite`` or ``ad-mlp`` and writes its weights; needs the extra ``training``.

::

    python -m drivora_service.training.imitation plant-lite weights.npz

Records the expert while a hand jerks the wheel, fits a network, and then a few times: lets the
network drive for seconds at a time, records how the expert goes on from there, and fits again to
all that was recorded. Prints how far off the waypoints are in runs that it was not fitted to.
Everything is drawn from fixed seeds and computed by one thread.
"""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch

from drivora_service.agents.ad_mlp.network import AdMlpNetwork, AdMlpWeights
from drivora_service.agents.ad_mlp.view import AdMlpView
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.imitation.agent import Network, View, WaypointAgent
from drivora_service.agents.plant_lite.network import PlantNetwork, PlantWeights
from drivora_service.agents.plant_lite.view import PlantView
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.training.courses import plans
from drivora_service.training.exchange import weights_of
from drivora_service.training.fitting import (
    Trainee,
    errors_at_constant_velocity,
    errors_of,
    fit,
)
from drivora_service.training.mlp_network import AdMlpTrainee
from drivora_service.training.plant_network import PlantTrainee
from drivora_service.training.recording import (
    Deviation,
    Jerks,
    Novice,
    Recorder,
    Samples,
    join,
    record,
)

_SEED = 100_000
"""Of the routes of the first recording; those of each round follow 100,000 further on."""
HELD_OUT_SEED = 900_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Recipe:
    """How an agent is trained.

    Attributes:
        view: Makes what its network sees.
        trainee: Makes the network to train.
        weights: What the agent has of it.
        traffic: Whether others drive while the expert is recorded.
        runs: On each network, at first.
        epochs: How often it is shown what was recorded at first.
        rounds: How often the network itself takes the wheel.
        round_runs: On each network, a round.
        round_epochs: How often it is shown all that was recorded until then.
        held_out: Runs on each network to which nothing is fitted, driven by the expert alone.
    """

    view: Callable[[], View]
    trainee: Callable[[], Trainee]
    weights: type[PlantWeights] | type[AdMlpWeights]
    traffic: bool
    runs: int
    epochs: int
    rounds: int
    round_runs: int
    round_epochs: int
    held_out: int


RECIPES = {
    "plant-lite": Recipe(
        view=PlantView, trainee=PlantTrainee, weights=PlantWeights, traffic=True,
        runs=30, epochs=6, rounds=2, round_runs=10, round_epochs=5, held_out=5,
    ),
    "ad-mlp": Recipe(
        view=AdMlpView, trainee=AdMlpTrainee, weights=AdMlpWeights, traffic=False,
        runs=20, epochs=30, rounds=2, round_runs=10, round_epochs=20, held_out=5,
    ),
}  # fmt: skip


def network_of(weights: PlantWeights | AdMlpWeights) -> Network:
    """Gives the network as the agent has it."""
    return PlantNetwork(weights) if isinstance(weights, PlantWeights) else AdMlpNetwork(weights)


def record_runs(
    recipe: Recipe, runs: int, seed: int, deviation: Callable[[], Deviation | None]
) -> Samples:
    """Records the expert on all networks.

    Args:
        recipe: Of the agent.
        runs: On each network.
        seed: Of the routes and the runs.
        deviation: Makes who takes the wheel in between.
    """
    networks = NetworkCatalogue(shipped_networks())
    return join(
        [
            record(plan, Recorder(IdmAgent(), recipe.view(), deviation(), seed + number))
            for number, plan in enumerate(
                plans(networks, runs=runs, seed=seed, traffic=recipe.traffic)
            )
        ]
    )


def train(recipe: Recipe) -> PlantWeights | AdMlpWeights:
    """Trains an agent's network from nothing; prints how far it is."""
    torch.set_num_threads(1)
    torch.manual_seed(0)
    torch.use_deterministic_algorithms(True)
    held_out = record_runs(recipe, recipe.held_out, HELD_OUT_SEED, lambda: None)
    print(f"held out: {len(held_out.seen)} samples", flush=True)
    print(f"constant velocity: {errors_at_constant_velocity(held_out)}", flush=True)
    trainee = recipe.trainee()
    samples = record_runs(recipe, recipe.runs, _SEED, Jerks)
    fit(trainee, samples, epochs=recipe.epochs, seed=0)
    print(f"{len(samples.seen)} samples: {errors_of(trainee, held_out)}", flush=True)
    for number in range(1, recipe.rounds + 1):
        network = network_of(weights_of(recipe.weights, trainee.parts()))

        def novice(network: Network = network) -> Deviation:
            return Novice(WaypointAgent(recipe.view(), network))

        new = record_runs(recipe, recipe.round_runs, _SEED * (number + 1), novice)
        samples = join([samples, new])
        fit(trainee, samples, epochs=recipe.round_epochs, seed=number)
        print(f"{len(samples.seen)} samples: {errors_of(trainee, held_out)}", flush=True)
    return weights_of(recipe.weights, trainee.parts())


def main() -> None:
    """Reads the command line, trains and writes."""
    parser = argparse.ArgumentParser(description="Trains an agent by imitation of `idm`.")
    parser.add_argument("agent", choices=sorted(RECIPES))
    parser.add_argument("weights", type=Path, help="file to write")
    options = parser.parse_args()
    np.savez(options.weights, **asdict(train(RECIPES[options.agent])))
    print(f"{options.weights}: sha256 {hashlib.sha256(options.weights.read_bytes()).hexdigest()}")


if __name__ == "__main__":
    main()
