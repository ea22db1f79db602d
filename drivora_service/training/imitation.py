"""Trains ``plant-lite`` or ``ad-mlp`` and writes its weights; needs the extra ``training``.

::

    python -m drivora_service.training.imitation plant-lite weights.npz

Records the expert while a hand jerks the wheel, and fits a network; where the recipe has a second
stage, records the expert in other traffic and goes on with all that was recorded. Prints how far
off the waypoints are in runs that the network was not fitted to.
Everything is drawn from fixed seeds and computed by one thread.
"""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from drivora_service.agents.ad_mlp.network import AdMlpNetwork, AdMlpWeights
from drivora_service.agents.ad_mlp.view import AdMlpView
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.imitation.agent import Network, View, WaypointAgent
from drivora_service.agents.imitation.weights import save_weights
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
    Learner,
    Recorder,
    Samples,
    join,
    record,
)

_SEED = 100_000
"""Of the routes of the first stage; those of the next follow 100,000 further on."""
HELD_OUT_SEED = 900_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Traffic:
    """What the expert is recorded in.

    Attributes:
        crowding: Times the usual traffic; 0 for none.
        leaders: Whether there are slow and standing cars on its way.
    """

    crowding: int = 1
    leaders: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """A recording, and a fit to it and to those of the stages before.

    Attributes:
        runs: On each network.
        epochs: How often each sample is shown.
        traffic: What the expert is recorded in.
        with_learner: Whether the agent as fitted so far drives in between, instead of a hand that
            jerks the wheel.
    """

    runs: int
    epochs: int
    traffic: Traffic = Traffic()  # frozen
    with_learner: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Recipe:
    """How an agent is trained.

    Attributes:
        view: Makes what its network sees.
        trainee: Makes the network to train.
        weights: What the agent has of it.
        network: Makes the agent's network of them.
        batch: Samples a step.
        rate: Highest learning rate.
        stages: One after the other.
        held_out: Runs on each network to which nothing is fitted, driven by the expert alone, in
            the traffic of each stage.
    """

    view: Callable[[], View]
    trainee: Callable[[], Trainee]
    weights: type[PlantWeights] | type[AdMlpWeights]
    network: Callable[[Any], Network]
    batch: int
    rate: float
    stages: tuple[Stage, ...]
    held_out: int


RECIPES = {
    "plant-lite": Recipe(
        view=PlantView,
        trainee=PlantTrainee,
        weights=PlantWeights,
        network=PlantNetwork,
        batch=128,
        rate=2e-3,
        stages=(
            Stage(runs=40, epochs=8),
            Stage(runs=16, epochs=4, traffic=Traffic(leaders=True)),
            Stage(runs=8, epochs=3, traffic=Traffic(crowding=4)),
            Stage(runs=12, epochs=4, traffic=Traffic(leaders=True), with_learner=True),
        ),
        held_out=5,
    ),
    "ad-mlp": Recipe(
        view=AdMlpView,
        trainee=AdMlpTrainee,
        weights=AdMlpWeights,
        network=AdMlpNetwork,
        batch=256,
        rate=1e-3,
        stages=(Stage(runs=20, epochs=30, traffic=Traffic(crowding=0)),),
        held_out=5,
    ),
}


def record_runs(
    recipe: Recipe,
    runs: int,
    traffic: Traffic,
    seed: int,
    deviation: Callable[[], Deviation | None],
) -> Samples:
    """Records the expert on all networks.

    Args:
        recipe: Of the agent.
        runs: On each network.
        traffic: What else is on the roads.
        seed: Of the routes and the runs.
        deviation: Makes who takes the wheel in between.
    """
    networks = NetworkCatalogue(shipped_networks())
    every = plans(
        networks, runs=runs, seed=seed, crowding=traffic.crowding, leaders=traffic.leaders
    )
    return join(
        [
            record(plan, Recorder(IdmAgent(), recipe.view(), deviation(), seed + number))
            for number, plan in enumerate(every)
        ]
    )


def held_out_samples(recipe: Recipe, runs: int, traffic: Traffic | None = None) -> Samples:
    """Records the expert alone, in runs to which nothing is fitted; fewer are the first of more.

    Args:
        recipe: Of the agent.
        runs: On each network.
        traffic: What else is on the roads; unless given, as in the first stage.
    """
    return record_runs(
        recipe, runs, traffic or recipe.stages[0].traffic, HELD_OUT_SEED, lambda: None
    )


def train(recipe: Recipe) -> PlantWeights | AdMlpWeights:
    """Trains an agent's network from nothing; prints how far it is."""
    torch.set_num_threads(1)
    torch.manual_seed(0)
    torch.use_deterministic_algorithms(True)
    held_out = [
        (stage.traffic, held_out_samples(recipe, recipe.held_out, stage.traffic))
        for stage in recipe.stages
        if not stage.with_learner
    ]
    for traffic, samples in held_out:
        print(f"held out, {traffic}: {len(samples.seen)} samples", flush=True)
        print(f"  at constant velocity: {errors_at_constant_velocity(samples)}", flush=True)
    trainee = recipe.trainee()
    recorded = []
    for number, stage in enumerate(recipe.stages):
        seed = _SEED * (number + 1)
        deviation = _learner(recipe, trainee) if stage.with_learner else Jerks
        recorded.append(record_runs(recipe, stage.runs, stage.traffic, seed, deviation))
        samples = join(recorded)
        fit(
            trainee, samples, epochs=stage.epochs, batch=recipe.batch, rate=recipe.rate, seed=number
        )
        print(f"fitted to {len(samples.seen)} samples", flush=True)
        for traffic, unseen in held_out:
            print(f"  held out, {traffic}: {errors_of(trainee, unseen)}", flush=True)
    return weights_of(recipe.weights, trainee.parts())


def _learner(recipe: Recipe, trainee: Trainee) -> Callable[[], Deviation]:
    """Returns what makes a driver with the present weights."""
    network = recipe.network(weights_of(recipe.weights, trainee.parts()))
    return lambda: Learner(WaypointAgent(recipe.view(), network))


def main() -> None:
    """Reads the command line, trains and writes."""
    parser = argparse.ArgumentParser(description="Trains an agent by imitation of `idm`.")
    parser.add_argument("agent", choices=sorted(RECIPES))
    parser.add_argument("weights", type=Path, help="file to write")
    options = parser.parse_args()
    if not options.weights.parent.is_dir():
        parser.error(f"there is no folder {options.weights.parent} to write in: make it first")
    save_weights(train(RECIPES[options.agent]), options.weights)
    print(f"{options.weights}: sha256 {hashlib.sha256(options.weights.read_bytes()).hexdigest()}")


if __name__ == "__main__":
    main()
