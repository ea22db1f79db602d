"""What makes an oracle known by a name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from drivora_service.oracles.verdict import Oracle


@dataclass(frozen=True, slots=True, kw_only=True)
class OraclePlugin:
    """What an entry point of the group ``drivora_service.oracles`` gives.

    Attributes:
        name: Of the oracle that the factory makes: in snake case, at most 60 characters.
        description: One sentence for people.
        create: Makes the oracle, once a process.
    """

    name: str
    description: str
    create: Callable[[], Oracle]
