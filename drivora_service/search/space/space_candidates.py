"""From genes to checked scenarios."""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from functools import cached_property, lru_cache, partial

from drivora_service.errors import Problem, SearchError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.runs.candidate import Candidate, Reference, SpaceSource
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.checks.placed_actors import PlacedActor, place_actors
from drivora_service.scenario.checks.route_checks import RouteCheck, check_route
from drivora_service.scenario.checks.start_overlaps import StartPose
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.validation import scenario_problems
from drivora_service.search.candidate_space import CandidateSpace
from drivora_service.search.genes import GeneSpace
from drivora_service.search.space.keeping_clear import keep_clear, with_reference
from drivora_service.search.space.source import source_of
from drivora_service.search.space.usable_area import PlannedMotions


class ScenarioCandidates:
    """Decodes values, and validates the scenario as a document.

    Attributes:
        space: Decodes values.
    """

    def __init__(
        self,
        space: CandidateSpace,
        networks: NetworkLookup,
        agents: Collection[str],
        motions: PlannedMotions,
    ) -> None:
        """Creates the decoder of candidates.

        Args:
            space: Decodes values.
            networks: Catalogue for the town of a scenario.
            agents: Names of the available agents.
            motions: Plans the motions of actors, for candidates with a reference.
        """
        self.space, self._networks, self._agents = space, networks, agents
        self._motions = motions
        self._check_route = make_cached_route_check(space.seed)

    @property
    def genes(self) -> GeneSpace:
        """The genes of the candidates."""
        return self.space.genes

    @cached_property
    def source(self) -> SpaceSource:
        """The space in text."""
        return source_of(self.space)

    def prepare(self, values: FloatArray, reference: Reference | None = None) -> Candidate:
        """Repairs values (d,), decodes them, and checks the scenario.

        Args:
            values: (d,) genes.
            reference: Paths of the egos; actors of the genes that would enter the area that an ego
                could use on its path are redrawn, or become absent.
        """
        begun = time.thread_time()
        try:
            return self._prepare(values, reference, begun)
        except SearchError as error:
            # The space of a package failed; so does the candidate, and not the worker.
            return Candidate(
                values=tuple(values.tolist()),
                problem=str(error),
                prepare_s=time.thread_time() - begun,
            )

    def _prepare(self, values: FloatArray, reference: Reference | None, begun: float) -> Candidate:
        repaired = self.space.repair(values)
        if reference is None:
            scenario = self.space.scenario(repaired)
        else:
            repaired, scenario = keep_clear(
                self.space, repaired, partial(with_reference, reference=reference), self._motions
            )
        problems = scenario_problems(scenario, self._networks, self._agents, self._check_route)
        return Candidate(
            values=tuple(repaired.tolist()),
            document="" if problems else canonical_json(scenario),
            problem="; ".join(f"{one.pointer}: {one.message}" for one in problems),
            prepare_s=time.thread_time() - begun,
        )


def make_cached_route_check(seed: Scenario) -> RouteCheck:
    """Returns a check of routes that caches the results for those of a seed scenario.

    They are in every candidate. Routes from genes are hardly ever repeated.
    """
    shared = frozenset(place_actors(seed, FrameTransform())[0])
    remembered = lru_cache(maxsize=len(shared))(check_route)

    def check(
        actor: PlacedActor, network: RoadNetwork
    ) -> tuple[Sequence[Problem], StartPose | None]:
        return (remembered if actor in shared else check_route)(actor, network)

    return check
