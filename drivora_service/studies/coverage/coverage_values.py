"""What the scenarios of a campaign cover, as values."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from drivora_service.search.genes import GeneKind
from drivora_service.shapes import Shape


class Turn(StrEnum):
    """The change of an ego's heading from the start to the end of its route."""

    STRAIGHT = "straight"
    LEFT = "left"
    RIGHT = "right"
    BACK = "back"
    """More than 135°."""
    UNKNOWN = "unknown"
    """The route has no heading at its start or its end, and no lane is there."""


class Others(StrEnum):
    """A kind of actors that a scenario places."""

    VEHICLES = "vehicles"
    WALKERS = "walkers"
    OBSTACLES = "obstacles"
    EGOS = "egos"
    """Other egos."""
    NONE = "none"


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneCoverage(Shape):
    """How often scenarios lead over the pieces of a lane, which are equally long.

    Attributes:
        lane: Id of the lane.
        egos: For each piece, from the lane's begin: ways of egos over it.
        actors: For each piece: ways of all actors over it, and actors that stand there.
    """

    lane: str
    egos: tuple[int, ...]
    actors: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkCoverage(Shape):
    """The lanes of a road network that scenarios use.

    Attributes:
        network: Name of the road network.
        share: Share of the length of its drivable lanes that any actor uses.
        ego_share: Share that egos use.
        lanes: Lanes with any use.
    """

    network: str
    share: float
    ego_share: float
    lanes: tuple[LaneCoverage, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class GeneCoverage(Shape):
    """The values of a gene that were tried, in bins from its least to its greatest value.

    Attributes:
        seed_number: Place of the seed scenario in the campaign, from 0.
        block: Name of the block of genes.
        simulations: For each bin, simulations with a value in it.
        failing: Those with a failure.
        avoidable: Those with a failure that is the fault of an ego and avoidable.
    """

    seed_number: int
    block: str
    name: str
    unit: str
    kind: GeneKind
    low: float
    high: float
    simulations: tuple[int, ...]
    failing: tuple[int, ...]
    avoidable: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioKind(Shape):
    """Simulations of one kind: an ego's turn, with one kind of other actors.

    A scenario with several kinds of other actors, or egos with several turns, counts in each.

    Attributes:
        turn: Turn of an ego.
        others: Kind of other actors.
        failing: Those with a failure.
        avoidable: Those with a failure that is the fault of an ego and avoidable.
    """

    turn: Turn
    others: Others
    simulations: int
    failing: int
    avoidable: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignCoverage(Shape):
    """What the scenarios of a campaign cover.

    Attributes:
        evaluations: Evaluations of the campaign so far.
        counted: Evaluations that are counted; ask again for the others where these are fewer.
        simulations: Simulated candidates among them.
        networks: By road network.
        genes: Genes that vary, by seed scenario; empty if they are not known any more.
        kinds: Kinds of scenarios, the most frequent first.
    """

    campaign_id: str
    evaluations: int
    counted: int
    simulations: int
    networks: tuple[NetworkCoverage, ...]
    genes: tuple[GeneCoverage, ...]
    kinds: tuple[ScenarioKind, ...]
