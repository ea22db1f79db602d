"""What a catalogue says of an agent."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class AgentKind(StrEnum):
    """How an ADS is built."""

    MODULE_BASED = "module-based"
    END_TO_END = "end-to-end"
    LANGUAGE_BASED = "language-based"
    BASELINE = "baseline"


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentEntry:
    """What the catalogue says of an agent.

    Attributes:
        source: Where it comes from: paper, package.
        version: Of the package that brings it, or what its manifest says; "" if that says nothing.
        installed: Whether it can be run here.
        reason: Why not, or "".
        privileged: Whether it sees more than the perception model lets through.
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
