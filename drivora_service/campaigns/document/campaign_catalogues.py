"""The catalogues for the names in a campaign."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.feedback.catalogue import FeedbackCatalogue
    from drivora_service.metrics.catalogue import MetricCatalogue
    from drivora_service.networks.catalogue import NetworkCatalogue
    from drivora_service.oracles.catalogue import OracleCatalogue
    from drivora_service.oracles.laws.sources import LawSource
    from drivora_service.search.catalogue import TesterCatalogue


class Catalogues:
    """Catalogues of everything that a campaign may name.

    Each is made when it is first read: those of agents, testers and oracles import much code, of
    which most commands and requests need none.
    """

    def __init__(
        self,
        networks: NetworkCatalogue,
        agents_folder: Path | None = None,
        laws: tuple[LawSource, ...] = (),
    ) -> None:
        """Creates the catalogues; nothing is looked up yet.

        Args:
            networks: The road networks.
            agents_folder: Folder of installed agents and of the operator's manifests.
            laws: The user's law files.
        """
        self.networks = networks
        self._agents_folder = agents_folder
        self._laws = laws

    @cached_property
    def agents(self) -> AgentCatalogue:
        """The agents of this installation."""
        from drivora_service.agents.catalogue import AgentCatalogue

        return AgentCatalogue(folder=self._agents_folder)

    @cached_property
    def testers(self) -> TesterCatalogue:
        """The testers of this installation."""
        from drivora_service.search.catalogue import TesterCatalogue

        return TesterCatalogue()

    @cached_property
    def metrics(self) -> MetricCatalogue:
        """The metrics of this installation."""
        from drivora_service.metrics.catalogue import MetricCatalogue

        return MetricCatalogue()

    @cached_property
    def feedbacks(self) -> FeedbackCatalogue:
        """The feedbacks of this installation."""
        from drivora_service.feedback.catalogue import FeedbackCatalogue

        library = self.oracles.library
        return FeedbackCatalogue([library.law(name) for name in library.names()])

    @cached_property
    def oracles(self) -> OracleCatalogue:
        """The oracles of this installation."""
        from drivora_service.oracles.catalogue import OracleCatalogue

        return OracleCatalogue(self._laws)
