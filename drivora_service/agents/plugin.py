"""What an agent brings to the catalogue."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drivora_service.agents.entry import AgentEntry
from drivora_service.agents.interface import Agent
from drivora_service.agents.package_files import PackageFile
from drivora_service.agents.sumo_driver import SumoDriver


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchedAgentPlugin:
    """A built-in agent that runs in process and needs files of other packages, such as weights.

    ``drivora agents install NAME`` fetches the files into a folder of the agent's own; until then
    its entry says that it is not installed. Drivora itself ships none of them.

    Attributes:
        entry: As for every agent; ``licence`` is shown before anything is fetched.
        files: What to fetch. A change here makes an older installation count as none.
        create: Takes the document's parameters and the folder that holds the files; raises
            ``AgentError`` if it cannot use them.
    """

    entry: AgentEntry
    files: tuple[PackageFile, ...]
    create: Callable[[Mapping[str, Any], Path], Agent]

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return self.entry.name


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentPlugin:
    """What an entry point of the group ``drivora_service.agents`` gives: an entry and a factory.

    The factory takes the document's parameters and raises ``AgentError`` if it cannot use them.
    """

    entry: AgentEntry
    create: Callable[[Mapping[str, Any]], Agent | SumoDriver]

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return self.entry.name
