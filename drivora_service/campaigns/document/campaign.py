"""A campaign inside the service: tester, ADS, seed scenario, budget."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from drivora_service.feedback.objective_choice import ObjectiveChoice
from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    FailureDefinition,
)
from drivora_service.scenario.model import AgentChoice
from drivora_service.search.candidate_space import SpaceChoice
from drivora_service.search.space.space_options import SpaceOptions

DEFAULT_LOOKAHEAD = 8


class FeedbackMode(StrEnum):
    """The results that a tester is told."""

    OWN = "own"
    """The result of each of its candidates."""
    SHUFFLED = "shuffled"
    """The results of another candidate, drawn at random: the method without its feedback."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TesterChoice:
    """The testing method of a campaign.

    Attributes:
        name: Name in the catalogue of testers.
        parameters: Parameters that differ from their defaults.
        mutation: Name of the mutation that replaces the tester's own, or "".
        selection: Name of the selection that replaces the tester's own, or "".
    """

    name: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    mutation: str = ""
    selection: str = ""
    feedback: FeedbackMode = FeedbackMode.OWN


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign:
    """A search for failures.

    All but ``name`` and ``workers`` determine which candidates are evaluated, and in which order.

    Attributes:
        name: Display name.
        agent: The ADS of every ego; ``None``: as in the scenario.
        budget: Number of simulations; invalid candidates do not count.
        definition: What counts as a failure.
        objectives: What the tester minimises in place of its own objectives; empty: its own.
        seed: Seed of every random draw of the search.
        workers: Worker processes; ``None``: as many as the installation has.
        lookahead: Number of candidates whose results the tester may lack. It receives results this
            much later than possible, so that the number of workers does not change the search.
    """

    name: str
    tester: TesterChoice
    budget: int
    agent: AgentChoice | None = None
    space: SpaceChoice = field(default_factory=SpaceOptions)
    definition: FailureDefinition = DEFAULT_DEFINITION
    objectives: tuple[ObjectiveChoice, ...] = ()
    seed: int = 0
    workers: int | None = None
    lookahead: int = DEFAULT_LOOKAHEAD
