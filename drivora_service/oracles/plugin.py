"""The plug-in by which a package registers an oracle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from drivora_service.oracles.verdict import Oracle


@dataclass(frozen=True, slots=True, kw_only=True)
class OracleObjective:
    """A value by which an oracle directs a search: smaller is nearer to a violation.

    The oracle gives it as evidence of its verdicts, under this name: a finite number, or ``None``
    where it is not measurable. An ego's value is the least of its verdicts.

    Attributes:
        name: In snake case, at most 60 characters; no other objective has it.
        description: One sentence.
        unit: Unit of the value; `1` for a share.
    """

    name: str
    description: str
    unit: str = "1"


@dataclass(frozen=True, slots=True, kw_only=True)
class OraclePlugin:
    """The object that an entry point of the group ``drivora_service.oracles`` names.

    Attributes:
        name: Name of the oracle that the factory makes: in snake case, at most 60 characters.
        description: One sentence.
        create: Factory of the oracle, called once in each process.
        objectives: Objectives that its verdicts have as evidence; the values up to 0 are those of
            violations.
    """

    name: str
    description: str
    create: Callable[[], Oracle]
    objectives: tuple[OracleObjective, ...] = ()
