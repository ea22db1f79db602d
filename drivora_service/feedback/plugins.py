"""The feedbacks that a tester may name: those built in and those of installed packages."""

from __future__ import annotations

from importlib.metadata import entry_points

from drivora_service.errors import SearchError, UnknownName
from drivora_service.feedback.general import GENERAL
from drivora_service.feedback.measurement import Feedback, FeedbackChoice
from drivora_service.feedback.plugin import FeedbackPlugin

ENTRY_POINT_GROUP = "drivora_service.feedback"
BUILT_IN = (GENERAL,)


class FeedbackCatalogue:
    """Feedbacks by name; entry points are loaded when one of them is asked for."""

    def __init__(self) -> None:
        self._plugins = {plugin.name: plugin for plugin in BUILT_IN}
        self._found = {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}

    def names(self) -> tuple[str, ...]:
        """Gives the names of all feedbacks, sorted."""
        return tuple(sorted({*self._plugins, *self._found}))

    def plugin(self, name: str) -> FeedbackPlugin:
        """Gives a feedback's plug-in.

        Raises:
            UnknownName: If there is none of that name.
            SearchError: If an installed package's entry point is no feedback.
        """
        if name in self._plugins:
            return self._plugins[name]
        if name not in self._found:
            raise UnknownName("feedback", name, self.names())
        plugin = self._found[name].load()
        if not isinstance(plugin, FeedbackPlugin):
            raise SearchError(
                f"the entry point {name!r} of {ENTRY_POINT_GROUP!r} gives a "
                f"{type(plugin).__name__}; it must give a FeedbackPlugin"
            )
        self._plugins[name] = plugin
        return plugin

    def create(self, choice: FeedbackChoice) -> Feedback:
        """Makes the feedback of a choice."""
        return self.plugin(choice.name).create(choice.parameters)
