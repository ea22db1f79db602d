"""The coverage of a campaign: roads, genes, and kinds of scenarios, counted as it goes on.

What is counted are the scenarios of the simulated candidates, not the recordings: only failing runs
are recorded. Counting goes on where it ended, so that a growing campaign is never read twice.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.networks.projection import project_points
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.model import Scenario, Waypoint
from drivora_service.search.genes import GeneSpace
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_rows import CandidateRow
from drivora_service.studies.coverage.coverage_values import (
    CampaignCoverage,
    GeneCoverage,
    LaneCoverage,
    NetworkCoverage,
    Others,
    ScenarioKind,
    Turn,
)
from drivora_service.studies.coverage.road_coverage import RoadCoverage

BINS = 10
"""Bins of a continuous gene."""
_MOST_BINS = 20
"""Of a gene that is a whole number."""


_TURN = math.radians(45.0)
_BACK = math.radians(135.0)


def turns_of(network: RoadNetwork, scenarios: Sequence[Scenario]) -> list[set[Turn]]:
    """Returns the turns of the egos of each scenario on a network.

    Where the ends of a route have no heading, it is that of the lane there.
    """
    ends = [
        end
        for scenario in scenarios
        for ego in scenario.ego_vehicles
        for end in (ego.route[0], ego.route[-1])
    ]
    places = project_points(network, np.array([(end.x, end.y) for end in ends]))
    headings = iter(
        _heading(network, end, int(lane), float(s))
        for end, lane, s in zip(ends, places.lane, places.s, strict=True)
    )
    return [
        {_turn(next(headings), next(headings)) for _ in scenario.ego_vehicles}
        for scenario in scenarios
    ]


def _heading(network: RoadNetwork, end: Waypoint, lane: int, s: float) -> float | None:
    if end.yaw is not None or lane < 0:
        return end.yaw
    return network.lanes[lane].position_at(s)[2]


def _turn(start: float | None, end: float | None) -> Turn:
    if start is None or end is None:
        return Turn.UNKNOWN
    angle = math.remainder(end - start, math.tau)
    if abs(angle) > _BACK:
        return Turn.BACK
    if abs(angle) <= _TURN:
        return Turn.STRAIGHT
    return Turn.LEFT if angle > 0.0 else Turn.RIGHT


class CoverageCounts:
    """The counts of one campaign; not for several threads at once."""

    def __init__(
        self, networks: NetworkLookup, space_of: Callable[[int], GeneSpace | None]
    ) -> None:
        """Creates counts of 0.

        Args:
            networks: Catalogue of the road networks.
            space_of: Returns the genes of a seed scenario by its place; ``None``: not known.
        """
        self._networks, self._space_of = networks, space_of
        self.counted = 0
        self._simulations = 0
        self._roads: dict[str, tuple[RoadNetwork, RoadCoverage, RoadCoverage]] = {}
        self._genes: dict[int, tuple[GeneSpace, _GeneBins]] = {}
        self._kinds: Counter[tuple[Turn, Others, str]] = Counter()

    def add(self, rows: Sequence[CandidateRow]) -> None:
        """Counts the next evaluations.

        Raises:
            UnknownName: A road network is not in the catalogue any more.
        """
        simulated = [row for row in rows if row.status != EvaluationStatus.INVALID]
        scenarios = [from_canonical(row.document) for row in simulated]
        by_town: dict[str, list[tuple[CandidateRow, Scenario]]] = {}
        for row, scenario in zip(simulated, scenarios, strict=True):
            by_town.setdefault(scenario.map_region.town, []).append((row, scenario))
        for town, found in by_town.items():
            network, egos, actors = self._road(town)
            placed = [scenario for _, scenario in found]
            egos.add(placed, only_egos=True)
            actors.add(placed)
            for (row, scenario), turns in zip(found, turns_of(network, placed), strict=True):
                self._count_kinds(row, scenario, turns)
        self._count_genes(simulated)
        self._simulations += len(simulated)
        self.counted += len(rows)

    def coverage(self, campaign_id: str, evaluations: int) -> CampaignCoverage:
        """Returns what is covered.

        Args:
            campaign_id: Id of the campaign.
            evaluations: Number of its evaluations.
        """
        kinds = {(turn, others) for turn, others, _ in self._kinds}
        found = [
            ScenarioKind(
                turn=turn,
                others=others,
                **{name: self._kinds[turn, others, name] for name in _COUNTS},
            )
            for turn, others in kinds
        ]
        return CampaignCoverage(
            campaign_id=campaign_id,
            evaluations=evaluations,
            counted=self.counted,
            simulations=self._simulations,
            networks=tuple(_network_coverage(*road) for _, road in sorted(self._roads.items())),
            genes=tuple(
                gene
                for seed_number, (space, bins) in sorted(self._genes.items())
                for gene in _gene_coverages(seed_number, space, bins)
            ),
            kinds=tuple(sorted(found, key=lambda one: (-one.simulations, one.turn, one.others))),
        )

    def _road(self, town: str) -> tuple[RoadNetwork, RoadCoverage, RoadCoverage]:
        if town not in self._roads:
            network = self._networks.get(town)
            self._roads[town] = (network, RoadCoverage(network), RoadCoverage(network))
        return self._roads[town]

    def _count_kinds(self, row: CandidateRow, scenario: Scenario, turns: Collection[Turn]) -> None:
        counts = [
            name
            for name, counted in zip(_COUNTS, _classify_simulation(row), strict=True)
            if counted
        ]
        for turn in turns:
            for others in _others(scenario):
                self._kinds.update((turn, others, name) for name in counts)

    def _count_genes(self, rows: Sequence[CandidateRow]) -> None:
        for seed_number in sorted({row.seed_number for row in rows}):
            if seed_number not in self._genes:
                space = self._space_of(seed_number)
                if space is None:
                    continue
                self._genes[seed_number] = (space, _GeneBins(space))
            space, bins = self._genes[seed_number]
            own = [
                row
                for row in rows
                if row.seed_number == seed_number and len(row.genes) == len(space)
            ]
            if own:
                bins.add(
                    np.array([row.genes for row in own], dtype=np.float64),
                    np.array([_classify_simulation(row) for row in own], dtype=np.bool_),
                )


_COUNTS = ("simulations", "failing", "avoidable")


class _GeneBins:
    """Counts of the values of genes by bin."""

    def __init__(self, space: GeneSpace) -> None:
        values = space.highs - space.lows + 1.0
        whole = np.minimum(values, float(_MOST_BINS))
        self.bins = np.where(space.is_whole, whole, float(BINS)).astype(np.int64)
        self.counts = np.zeros((len(_COUNTS), len(space), max(_MOST_BINS, BINS)), dtype=np.int64)
        self._space = space

    def add(self, values: NDArray[np.float64], counted: NDArray[np.bool_]) -> None:
        """Counts (n, d) values, each for those of the (n, 3) counts that it belongs to."""
        unit = self._space.to_unit(values)
        bins = np.clip((unit * self.bins).astype(np.int64), 0, self.bins - 1)
        genes = np.broadcast_to(np.arange(len(self._space)), bins.shape)
        for count in range(len(_COUNTS)):
            rows = counted[:, count]
            np.add.at(self.counts[count], (genes[rows], bins[rows]), 1)


def _gene_coverages(seed_number: int, space: GeneSpace, bins: _GeneBins) -> list[GeneCoverage]:
    found = []
    for block in space.blocks:
        for place, gene in zip(range(*block.slice.indices(len(space))), block.genes, strict=True):
            if not space.varies[place]:
                continue
            counts: Mapping[str, tuple[int, ...]] = {
                name: tuple(bins.counts[count, place, : bins.bins[place]].tolist())
                for count, name in enumerate(_COUNTS)
            }
            found.append(
                GeneCoverage(
                    seed_number=seed_number,
                    block=block.name,
                    name=gene.name,
                    unit=gene.unit,
                    kind=gene.kind,
                    low=gene.low,
                    high=gene.high,
                    **counts,
                )
            )
    return found


def _network_coverage(
    network: RoadNetwork, egos: RoadCoverage, actors: RoadCoverage
) -> NetworkCoverage:
    lanes = []
    for lane, (of_egos, of_actors) in enumerate(
        zip(egos.counts_by_lane(), actors.counts_by_lane(), strict=True)
    ):
        if of_actors.any():
            lanes.append(
                LaneCoverage(
                    lane=network.lanes[lane].id,
                    egos=tuple(of_egos.tolist()),
                    actors=tuple(of_actors.tolist()),
                )
            )
    return NetworkCoverage(
        network=network.name, share=actors.share, ego_share=egos.share, lanes=tuple(lanes)
    )


def _classify_simulation(row: CandidateRow) -> tuple[bool, bool, bool]:
    """Returns whether a simulation counts as such, as failing, and as avoidably so."""
    return True, row.violations > 0, row.accountability == Accountability.AVOIDABLE


def _others(scenario: Scenario) -> list[Others]:
    present = {
        Others.VEHICLES: bool(scenario.npc_vehicles),
        Others.WALKERS: bool(scenario.npc_walkers),
        Others.OBSTACLES: bool(scenario.npc_obstacles),
        Others.EGOS: len(scenario.ego_vehicles) > 1,
    }
    return [others for others, is_there in present.items() if is_there] or [Others.NONE]
