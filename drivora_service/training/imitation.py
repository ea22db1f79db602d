"""Trains ``plant-lite`` or ``ad-mlp`` and writes its weights; needs the extra ``training``.

::

    python -m drivora_service.training.imitation plant-lite weights.npz

Records the expert while the steering wheel is disturbed, and fits a network; a recipe with a second
stage records the expert in other traffic and continues with all recordings. Prints the errors of
the waypoints in runs that the network was not fitted to.
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
from torch import Tensor, nn

from drivora_service.agents.ad_mlp.network import HIDDEN, AdMlpNetwork, AdMlpWeights
from drivora_service.agents.ad_mlp.view import SEEN_SIZE, AdMlpView
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.imitation.agent import Network, View, WaypointAgent
from drivora_service.agents.imitation.waypoints import STEP_SCALE, WAYPOINTS
from drivora_service.agents.imitation.weights import save_weights
from drivora_service.agents.plant_lite.network import PlantNetwork, PlantWeights
from drivora_service.agents.plant_lite.view import PlantView
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.training.demonstrations import (
    Jerks,
    Learner,
    PerturbingDriver,
    Recorder,
    Samples,
    join,
    record,
)
from drivora_service.training.fitting import (
    Trainee,
    errors_at_constant_velocity,
    errors_of,
    fit,
)
from drivora_service.training.plant_network import PlantTrainee
from drivora_service.training.training_courses import plans
from drivora_service.training.weight_exchange import Parts, weights_of

_SEED = 100_000
"""Seed of the first stage's routes; each further stage adds 100,000."""
HELD_OUT_SEED = 900_000


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Traffic:
    """The traffic in which the expert is recorded.

    Attributes:
        crowding: Factor on the usual traffic; 0 for none.
        leaders: Whether there are slow and standing cars on its route.
    """

    crowding: int = 1
    leaders: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """A recording, and a fit to it and to those of the preceding stages.

    Attributes:
        runs: Number of runs on each network.
        epochs: Number of passes over the samples.
        traffic: Traffic in which the expert is recorded.
        with_learner: Whether the agent, as fitted so far, drives in between, instead of a disturbed
            steering wheel.
    """

    runs: int
    epochs: int
    traffic: Traffic = Traffic()  # frozen
    with_learner: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Recipe:
    """The recipe of an agent's training.

    Attributes:
        view: Makes the view of its network.
        trainee: Makes the network to train.
        weights: Type of the agent's weights.
        network: Makes the agent's network from its weights.
        batch: Samples in each step.
        rate: Highest learning rate.
        stages: Stages in order.
        held_out: Held-out runs on each network, driven by the expert alone, in
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
    perturbing: Callable[[], PerturbingDriver | None],
) -> Samples:
    """Records the expert on all networks.

    Args:
        recipe: Recipe of the agent.
        runs: Number of runs on each network.
        traffic: Other traffic.
        seed: Seed of the routes and the runs.
        perturbing: Makes the perturbing driver, or returns ``None``.
    """
    networks = NetworkCatalogue(shipped_networks())
    every = plans(
        networks, runs=runs, seed=seed, crowding=traffic.crowding, leaders=traffic.leaders
    )
    return join(
        [
            record(plan, Recorder(IdmAgent(), recipe.view(), perturbing(), seed + number))
            for number, plan in enumerate(every)
        ]
    )


def record_held_out_samples(recipe: Recipe, runs: int, traffic: Traffic | None = None) -> Samples:
    """Records the expert alone in held-out runs; fewer runs are the first ones of more.

    Args:
        recipe: Recipe of the agent.
        runs: Number of runs on each network.
        traffic: Other traffic; by default that of the first stage.
    """
    return record_runs(
        recipe, runs, traffic or recipe.stages[0].traffic, HELD_OUT_SEED, lambda: None
    )


def train(recipe: Recipe) -> PlantWeights | AdMlpWeights:
    """Trains an agent's network from scratch; prints its errors."""
    torch.set_num_threads(1)
    torch.manual_seed(0)
    torch.use_deterministic_algorithms(True)
    held_out = [
        (stage.traffic, record_held_out_samples(recipe, recipe.held_out, stage.traffic))
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
        perturbing = _learner(recipe, trainee) if stage.with_learner else Jerks
        recorded.append(record_runs(recipe, stage.runs, stage.traffic, seed, perturbing))
        samples = join(recorded)
        fit(
            trainee, samples, epochs=stage.epochs, batch=recipe.batch, rate=recipe.rate, seed=number
        )
        print(f"fitted to {len(samples.seen)} samples", flush=True)
        for traffic, unseen in held_out:
            print(f"  held out, {traffic}: {errors_of(trainee, unseen)}", flush=True)
    return weights_of(recipe.weights, trainee.parts())


def _learner(recipe: Recipe, trainee: Trainee) -> Callable[[], PerturbingDriver]:
    """Returns a factory of drivers with the present weights."""
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
