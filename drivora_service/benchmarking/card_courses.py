"""The fixed scenarios of the benchmark.

Cards are comparable only with identical scenarios. A change of a course, or of the seed generator's
result for one, must increase ``VERSION``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.documents import ScenarioDocument, with_background
from drivora_service.scenario.seed_generation import generate_seeds

VERSION = 1
"""Version of the benchmark; cards of different versions are not comparable."""

RUNS = 10
"""Default number of runs on each network."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """The parameters of a network's scenarios.

    Attributes:
        network: Name of a shipped network.
        min_length: Minimum length of the route, metres.
        max_length: Maximum length of the route, metres.
        background: Number of background vehicles.
        seed: Seed of the routes and of all random draws in the runs.
    """

    network: str
    min_length: float
    max_length: float
    background: int
    seed: int


COURSES = (
    Course(network="tee-town", min_length=150.0, max_length=400.0, background=10, seed=1000),
    Course(network="signal-grid", min_length=250.0, max_length=600.0, background=20, seed=2000),
    Course(network="roundabout", min_length=300.0, max_length=700.0, background=25, seed=3000),
)
"""Signals, all-way stops and plain priority; signals and several lanes; yielding in rings."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BenchmarkScenario:
    """A scenario of the benchmark, without an agent.

    Attributes:
        network: Network of the scenario.
        number: Number among those of its network, from 1.
        document: Document with one ego, whose agent ``with_agent`` sets.
    """

    network: str
    number: int
    document: ScenarioDocument

    @property
    def name(self) -> str:
        """Name of the scenario and of its files."""
        return f"{self.network}-{self.number:02d}"


def benchmark_scenarios(networks: NetworkCatalogue, runs: int) -> Iterator[BenchmarkScenario]:
    """Yields the scenarios of all courses; fewer are the first of more.

    Args:
        networks: Catalogue with the shipped networks.
        runs: Number of scenarios of each course.

    Raises:
        NetworkError: A network does not have enough routes.
        InvalidDocument: The number of runs is out of bounds.
    """
    for course in COURSES:
        documents = generate_seeds(
            networks.get(course.network),
            count=runs,
            min_length=course.min_length,
            max_length=course.max_length,
            seed=course.seed,
            agent="idm",
        )
        for number, document in zip(count(1), documents, strict=False):
            yield BenchmarkScenario(
                network=course.network,
                number=number,
                document=with_background(document, course.background),
            )
