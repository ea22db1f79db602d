"""The catalogue of feedbacks: built-in ones and those of installed packages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from drivora_service.errors import SearchError
from drivora_service.feedback.avfuzzer import AVFUZZER
from drivora_service.feedback.behavexplor import BEHAVEXPLOR
from drivora_service.feedback.decictor import DECICTOR
from drivora_service.feedback.deepcollision import DEEPCOLLISION
from drivora_service.feedback.doppeltest import DOPPELTEST
from drivora_service.feedback.drivefuzz import DRIVEFUZZ
from drivora_service.feedback.general import GENERAL
from drivora_service.feedback.lawbreaker import lawbreaker_feedback
from drivora_service.feedback.measurement import Feedback, FeedbackChoice
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.feedback.samota import SAMOTA
from drivora_service.oracles.laws.law import Law
from drivora_service.plugin_table import PluginTable

BUILT_IN = (
    GENERAL,
    AVFUZZER,
    BEHAVEXPLOR,
    SAMOTA,
    DOPPELTEST,
    DRIVEFUZZ,
    DEEPCOLLISION,
    DECICTOR,
)
"""Those that depend on nothing else; that of LawBreaker depends on the laws."""


class FeedbackCatalogue:
    """Feedbacks by name."""

    def __init__(self, laws: Sequence[Law] | None = None) -> None:
        """Finds all feedbacks.

        Args:
            laws: Traffic laws for the feedback of LawBreaker; ``None``: the shipped ones.
        """
        self._table = PluginTable(
            kind="feedback",
            group="drivora_service.feedback",
            type_=FeedbackPlugin,
            built_in=(*BUILT_IN, lawbreaker_feedback(laws)),
            error=SearchError,
        )

    def names(self) -> tuple[str, ...]:
        """Returns the names of all feedbacks, sorted."""
        return self._table.names()

    def package(self, name: str) -> str:
        """Returns the name of a feedback's package, "" for a built-in one."""
        return self._table.package(name)

    def plugin(self, name: str) -> FeedbackPlugin:
        """Returns a feedback's plug-in.

        Raises:
            UnknownName: There is no feedback of that name.
            SearchError: The entry point of an installed package is no feedback.
        """
        return self._table.plugin(name)

    def versions(self, name: str) -> Mapping[str, str]:
        """Returns the package of a feedback with its version; empty for a built-in one."""
        return self._table.versions(name)

    def create(self, choice: FeedbackChoice) -> Feedback:
        """Returns the feedback of a choice, with its parameters."""
        return self.plugin(choice.name).create(choice.parameters)
