"""Courses for recording the expert: generated routes, without the benchmark's seeds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.documents import with_background
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.simulation.planning import plan_episode
from drivora_service.simulation.plans.episode_plan import EpisodePlan
from drivora_service.training.training_leaders import with_leaders

EXPERT = "idm"


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainingCourse:
    """Runs on a network.

    Attributes:
        network: Name of a shipped network.
        min_length: Minimum length of the route, metres.
        max_length: Maximum length of the route, metres.
        background: Number of background vehicles.
    """

    network: str
    min_length: float
    max_length: float
    background: int


COURSES = (
    TrainingCourse(network="tee-town", min_length=150.0, max_length=450.0, background=12),
    TrainingCourse(network="signal-grid", min_length=200.0, max_length=600.0, background=24),
    TrainingCourse(network="roundabout", min_length=250.0, max_length=700.0, background=25),
    TrainingCourse(network="arterial", min_length=200.0, max_length=600.0, background=24),
    TrainingCourse(network="old-town", min_length=150.0, max_length=450.0, background=15),
)


def plans(
    networks: NetworkCatalogue, *, runs: int, seed: int, crowding: int, leaders: bool = False
) -> Iterator[EpisodePlan]:
    """Yields the runs of all courses.

    Args:
        networks: Catalogue with the shipped networks.
        runs: Number of runs on each network.
        seed: Seed of the routes and of all random draws in the runs.
        crowding: Factor on the usual background traffic; 0 for none.
        leaders: Whether slow and standing cars are added on the ego's route.

    Raises:
        NetworkError: A network does not have enough routes.
    """
    random = np.random.default_rng(seed)
    for number, course in enumerate(COURSES):
        documents = generate_seeds(
            networks.get(course.network),
            count=runs,
            min_length=course.min_length,
            max_length=course.max_length,
            seed=seed + 1000 * number,
            agent=EXPERT,
        )
        for document in documents:
            if crowding:
                document = with_background(document, crowding * course.background)
            valid = validate_document(document, networks, None)
            plan = plan_episode(valid.scenario, valid.network)
            yield with_leaders(plan, random) if leaders else plan
