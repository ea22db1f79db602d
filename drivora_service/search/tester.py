"""A testing method as ask/tell: it proposes candidates and is told what came of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

import numpy as np

from drivora_service.feedback.measurement import Measurement
from drivora_service.geometry.arrays import BoolArray, FloatArray
from drivora_service.oracles.verdict import Verdict
from drivora_service.search.genes import GeneSpace


class EvaluationStatus(StrEnum):
    """Whether a candidate was judged."""

    JUDGED = "judged"
    """Simulated and judged."""
    INVALID = "invalid"
    """No valid scenario; not simulated, and no part of the budget."""
    FAILED = "failed"
    """The run has no result: the agent, the simulator or the time limit ended it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Proposal:
    """A candidate that a tester wants to see evaluated.

    Attributes:
        values: (d,) genes, within the bounds of the space.
        origin: How it was made, in a word or two: ``initial``, ``mutation``, ``crossover`` ...
        generation: Number of the generation, cycle or round that it belongs to, from 0.
        parents: Numbers of the evaluations that it was made from.
    """

    values: FloatArray
    origin: str
    generation: int = 0
    parents: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evaluation:
    """What came of a proposal.

    Attributes:
        number: Of the proposal in the order of asking, from 0.
        violations: Verdicts of the campaign's oracles that count as failures of the ego: violated,
            and not known to be somebody else's fault. Empty unless judged.
        scores: The general objectives by name, to be minimised; ``None`` is not measurable.
        measurement: Of the tester's feedback; ``None`` unless judged.
    """

    number: int
    proposal: Proposal
    status: EvaluationStatus
    violations: tuple[Verdict, ...] = ()
    scores: Mapping[str, float | None] = field(default_factory=dict)
    measurement: Measurement | None = None


class Tester(Protocol):
    """A testing method.

    The caller asks and tells in one thread, and in an order that does not depend on time:
    evaluations are told one by one in the order of their numbers, and after each telling the tester
    is asked again. With the same space and a generator of the same seed a tester therefore proposes
    the same, so that its state can be rebuilt by telling it again what is known.
    """

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Proposes up to ``room`` candidates; none if it has to be told more first.

        A tester that proposes nothing while nothing is left to be told has ended.

        Raises:
            SearchError: If ``room`` is less than 1.
        """
        ...

    def tell(self, evaluation: Evaluation) -> None:
        """Takes the next evaluation.

        Raises:
            SearchError: If it is not the one whose turn it is.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TesterContext:
    """What a tester works with.

    Attributes:
        space: What can be varied.
        random: For every random draw of the tester.
        budget: Simulations that the campaign may make.
        conflicts: (p, p) which two of the p routes that egos choose from (by their gene ``path``)
            get in each other's way; symmetric, none with itself. ``None``: not known.
    """

    space: GeneSpace
    random: np.random.Generator
    budget: int
    conflicts: BoolArray | None = None
