"""Entries of the catalogue of agents."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class AgentKind(StrEnum):
    """The kind of an ADS."""

    MODULE_BASED = "module-based"
    END_TO_END = "end-to-end"
    LANGUAGE_BASED = "language-based"
    BASELINE = "baseline"


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentEntry:
    """The catalogue's entry of an agent.

    Attributes:
        source: Source: paper, package.
        version: Version of its package or of its manifest; "" if unknown.
        installed: Whether it can be run here.
        reason: Reason if not installed, or "".
        privileged: Whether it bypasses the perception model.
    """

    name: str
    kind: AgentKind
    description: str
    source: str
    licence: str
    version: str = ""
    installed: bool = True
    reason: str = ""
    privileged: bool = False
