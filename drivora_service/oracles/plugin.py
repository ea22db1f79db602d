"""The plug-in by which a package registers an oracle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from drivora_service.oracles.verdict import Oracle


@dataclass(frozen=True, slots=True, kw_only=True)
class OraclePlugin:
    """The object that an entry point of the group ``drivora_service.oracles`` names.

    Attributes:
        name: Name of the oracle that the factory makes: in snake case, at most 60 characters.
        description: One sentence.
        create: Factory of the oracle, called once in each process.
    """

    name: str
    description: str
    create: Callable[[], Oracle]
