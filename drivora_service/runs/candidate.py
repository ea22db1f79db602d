"""Candidates of a search: the genes that a worker decodes, and the scenario that they encode."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.runs.adversary import AdversarySource


@dataclass(frozen=True, slots=True, kw_only=True)
class SpaceSource:
    """A gene space in text: the same source gives the same space on every machine.

    Attributes:
        seed: Canonical JSON text of the seed scenario.
        options: JSON text of the options of the space.
    """

    seed: str
    options: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """The paths with which those of a candidate's egos are compared.

    Other actors of its genes keep out of the area that an ego on its path could use.

    Attributes:
        paths: For each ego its poses, each (time, x, y, heading, speed, height) in SI units; empty:
            the paths of the seed scenario.
    """

    paths: tuple[tuple[tuple[float, ...], ...], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateSource:
    """Genes, and the space in which they are decoded.

    Attributes:
        values: (d,) genes as proposed.
        reference: Paths that belong to the scenario beside its genes; ``None`` for none.
        adversary: Adversary that acts during the run; ``None`` for none.
    """

    space: SpaceSource
    values: tuple[float, ...]
    reference: Reference | None = None
    adversary: AdversarySource | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """Decoded genes.

    Attributes:
        values: (d,) genes, repaired.
        document: Canonical JSON text of the scenario, with what an adversary did during the run; ""
            if there is none.
        problem: Why there is none, or "".
        prepare_s: Processor seconds of repairing, decoding and checking.
    """

    values: tuple[float, ...]
    document: str = ""
    problem: str = ""
    prepare_s: float = 0.0
