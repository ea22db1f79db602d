"""A testing method as ask/tell: it proposes candidates and receives their evaluations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.objective_values import ObjectiveValues
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.adversary import AdversarySource
from drivora_service.runs.candidate import Reference
from drivora_service.search.aims import Aim
from drivora_service.search.genes import Block, GeneSpace

REFERENCE_ORIGIN = "reference"
"""Origin of a candidate with which the runs of others are compared: it is not replaced."""


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
    """A candidate that a tester proposes.

    Attributes:
        values: (d,) genes, within the bounds of the space.
        origin: How it was made, in a word or two: ``initial``, ``mutation``, ``crossover`` ...
        generation: Number of its generation, cycle or round, from 0.
        parents: Numbers of the evaluations from which it was made.
        redrawn: Number of mutants that were drawn for it before, and drawn again since they could
            not have changed the run of any ego.
        reference: Paths with which those of its egos are compared; ``None`` for none. It is not
            stored, as a tester proposes the same again.
        adversary: Adversary that acts during its run; ``None`` for none.
    """

    values: FloatArray
    origin: str
    generation: int = 0
    parents: tuple[int, ...] = ()
    redrawn: int = 0
    reference: Reference | None = None
    adversary: AdversarySource | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evaluation:
    """The result of a proposal.

    Attributes:
        number: Number of the proposal in the order of asking, from 0.
        violations: Verdicts of the campaign's oracles that count as failures of the ego: violated,
            and not known to be another actor's fault. Empty unless judged.
        verdicts: All verdicts of the run, those of oracles that the campaign does not count and
            those at another actor's fault among them. Empty unless judged.
        scores: The general objectives by name, and those of oracles of packages, to be minimised;
            ``None`` is not measurable. Empty unless judged; else a name that was not measured
            raises ``UnknownObjective``.
        measurement: Measurement by the tester's feedback; ``None`` unless judged.
        without_effect: Indices of genes whose change, to whatever values, could not have changed
            the run of any ego (``worker.without_effect``). Told truly also where the results are
            shuffled.
    """

    number: int
    proposal: Proposal
    status: EvaluationStatus
    violations: tuple[Verdict, ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    scores: Mapping[str, float | None] = field(default_factory=dict)
    measurement: Measurement | None = None
    without_effect: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Makes the scores of a judged candidate a mapping that refuses unknown names."""
        if self.scores:
            object.__setattr__(self, "scores", ObjectiveValues(self.scores))


class Tester(Protocol):
    """A testing method.

    The caller asks and tells in one thread, and in an order that does not depend on time:
    evaluations come one by one in the order of their numbers, and after each one the tester is
    asked again. With the same space and a generator of the same seed a tester therefore makes the
    same proposals, so that its state can be rebuilt by telling it the known evaluations again.
    """

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Proposes up to ``room`` candidates; none if it needs more evaluations first.

        A tester that proposes nothing while no evaluation is pending has ended.

        Raises:
            SearchError: ``room`` is less than 1.
        """
        ...

    def tell(self, evaluation: Evaluation) -> None:
        """Learns from the next evaluation.

        Raises:
            SearchError: It is out of order.
        """
        ...


class Checkpoints(Protocol):
    """The checkpoints of a tester: its state after some evaluations.

    They only save time: a tester without them comes to the same state by the evaluations that it
    receives again.
    """

    def last(self) -> tuple[int, bytes] | None:
        """Returns the latest checkpoint of which all evaluations are stored.

        Returns:
            The number of evaluations that the tester had received, and its state; ``None`` if
            there is none.
        """
        ...

    def save(self, told: int, state: bytes) -> None:
        """Stores the state after ``told`` evaluations."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TesterContext:
    """The context of a tester.

    Attributes:
        space: The gene space.
        random: Generator for every random draw of the tester.
        budget: Number of simulations that the campaign may make.
        conflicts: (p, p) which two of the p routes that egos choose from (by their gene ``path``)
            conflict; symmetric, none with itself. ``None``: not known.
        decode_alike: Returns whether two candidates (d,), the first of them repaired, decode to
            scenarios that cannot be told apart by their runs. ``None``: not known.
        ego_distance: Returns from a block of an actor or patch and (d,) genes how many metres from
            an ego's start it appears; ``None`` for other blocks. ``None``: not known.
        checkpoints: Place for checkpoints of testers that need long to rebuild their state;
            ``None``: none are kept.
        aims: Objectives that the campaign chose in place of those of the tester's feedback; empty:
            none.
    """

    space: GeneSpace
    random: np.random.Generator
    budget: int
    conflicts: BoolArray | None = None
    decode_alike: Callable[[FloatArray, FloatArray], bool] | None = None
    ego_distance: Callable[[Block, FloatArray], float | None] | None = None
    checkpoints: Checkpoints | None = None
    aims: tuple[Aim, ...] = ()

    def objective(self, default: str) -> str:
        """Returns the name of the one objective to minimise.

        Args:
            default: The tester's own.

        Raises:
            SearchError: The campaign chose several.
        """
        if len(self.aims) > 1:
            names = ", ".join(aim.name for aim in self.aims)
            raise SearchError(f"the tester minimises one objective; the campaign chose {names}")
        return self.aims[0].name if self.aims else default
