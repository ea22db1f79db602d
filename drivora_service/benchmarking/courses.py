"""The fixed scenarios of the benchmark.

Cards of different days and machines compare only if everything here was the same. Whoever changes
a course, or what the seed generator makes of one, counts ``VERSION`` up.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.documents import ScenarioDocument, with_background
from drivora_service.scenario.seeds import generate_seeds

VERSION = 1
"""Of the benchmark; cards of different versions do not compare."""

RUNS = 10
"""Runs on each network, unless told otherwise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """Where the scenarios of a network come from.

    Attributes:
        network: Name of a shipped network.
        min_length: Metres of route at least.
        max_length: Metres of route at most.
        background: Vehicles of background traffic.
        seed: Of the routes, and of everything in the runs that is drawn at random.
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
class Heat:
    """One scenario of the benchmark, whoever drives it.

    Attributes:
        network: It takes place on.
        number: Among those of its network, from 1.
        document: Its one ego has no agent of its own choice yet: ``with_agent`` gives it one.
    """

    network: str
    number: int
    document: ScenarioDocument

    @property
    def name(self) -> str:
        """Names it and the files about it."""
        return f"{self.network}-{self.number:02d}"


def heats(networks: NetworkCatalogue, runs: int) -> Iterator[Heat]:
    """Returns the scenarios of all courses; fewer are the first ones of more.

    Args:
        networks: Has the shipped networks.
        runs: Scenarios of each course.

    Raises:
        NetworkError: A network does not offer that many routes.
        InvalidDocument: So many cannot be asked for.
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
            yield Heat(
                network=course.network,
                number=number,
                document=with_background(document, course.background),
            )
