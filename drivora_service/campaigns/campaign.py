"""A campaign inside the service: who searches for failures of whom, where, and for how long."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.model import AgentChoice
from drivora_service.search.space.options import SpaceOptions

DEFAULT_ORACLES = (
    "collision",
    "red_light",
    "off_road",
    "wrong_way",
    "route_deviation",
    "blocked",
    "deadlock",
)
"""Rules whose violations are failures unless a campaign says otherwise: those that a driver would
be blamed for. The others describe how well a drive went."""

DEFAULT_LOOKAHEAD = 8


class FeedbackMode(StrEnum):
    """What a tester is told."""

    OWN = "own"
    """What came of each of its candidates."""
    SHUFFLED = "shuffled"
    """The results of another candidate, drawn at random: the method without its feedback."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TesterChoice:
    """The testing method of a campaign.

    Attributes:
        name: In the catalogue of testers.
        parameters: Those that differ from their defaults.
        mutation: Name of the mutation that takes the place of the tester's own, or "".
        selection: Name of the selection that takes the place of the tester's own, or "".
    """

    name: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    mutation: str = ""
    selection: str = ""
    feedback: FeedbackMode = FeedbackMode.OWN


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign:
    """A search for failures.

    All but ``name`` and ``workers`` decide which candidates are evaluated, and in which order.

    Attributes:
        name: For people.
        agent: Drives every ego; ``None``: as the scenario says.
        scenario: The seed scenario.
        budget: Simulations; candidates that are no valid scenario do not count.
        oracles: Rules whose violations are failures.
        seed: Of every random draw of the search.
        workers: Worker processes; ``None``: as many as the installation has.
        lookahead: Candidates that may wait to be told. Results are told this much later than they
            could be, whatever the number of workers, so that it does not change the search.
    """

    name: str
    tester: TesterChoice
    scenario: ScenarioDocument
    budget: int
    agent: AgentChoice | None = None
    space: SpaceOptions = field(default_factory=SpaceOptions)
    oracles: tuple[str, ...] = DEFAULT_ORACLES
    seed: int = 0
    workers: int | None = None
    lookahead: int = DEFAULT_LOOKAHEAD
