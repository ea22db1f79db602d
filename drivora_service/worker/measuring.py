"""Measuring a run for a tester, by a feedback that may come from a plug-in."""

from __future__ import annotations

import math
import traceback
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

from drivora_service.errors import DrivoraError, PluginError, SearchError
from drivora_service.feedback.catalogue import FeedbackCatalogue
from drivora_service.feedback.measurement import Feedback, FeedbackChoice, Measurement
from drivora_service.foreign_errors import exception_place
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.laws.law import Law
from drivora_service.plugin_table import describe_plugin

_LOG = 4000
"""Number of characters of a traceback that are kept."""


@lru_cache(maxsize=1)
def _catalogue(laws: tuple[Law, ...]) -> FeedbackCatalogue:
    return FeedbackCatalogue(laws)


def make_feedback(choice: FeedbackChoice, laws: tuple[Law, ...] = ()) -> Feedback:
    """Returns the feedback of a choice, with its parameters.

    Args:
        choice: The choice.
        laws: The traffic laws that judge runs.

    Raises:
        UnknownName: There is no feedback of that name.
        SearchError: It does not accept these parameters.
        PluginError: The plug-in cannot be loaded, or raises anything else.
    """
    try:
        plugin = _catalogue(laws).plugin(choice.name)
    except SearchError as error:
        raise PluginError(str(error), cause="feedback_plugin", log=_log(error)) from error
    try:
        return plugin.create(choice.parameters)
    except DrivoraError:
        raise
    except (Exception, SystemExit) as error:
        raise _make_plugin_error(choice.name, "when it was made", error) from error


def is_built_in(feedback: Feedback | None) -> bool:
    """Returns whether a feedback is part of this package, or there is none."""
    package = __name__.partition(".")[0]
    return feedback is None or type(feedback).__module__.partition(".")[0] == package


def measure_run(name: str, feedback: Feedback, run: RunView) -> Measurement:
    """Measures a run.

    Args:
        name: Name of the feedback in its catalogue.
        feedback: The feedback.
        run: The run.

    Raises:
        PluginError: The feedback raised, or its answer is no measurement.
    """
    try:
        answer: Any = feedback.measure(run)
        expected = tuple(feedback.objectives)
    except (Exception, SystemExit) as error:
        raise _make_plugin_error(name, "when it measured a run", error) from error
    problem = next(_problems(answer, expected), "")
    if problem:
        raise PluginError(
            f"{_words(name)} answered {problem}", cause="feedback_invalid_measurement"
        )
    measured: Measurement = answer
    return measured


def _problems(answer: Any, expected: tuple[str, ...]) -> Iterator[str]:
    """Yields what is wrong with an answer, as ends of a sentence that begins with "answered"."""
    if not isinstance(answer, Measurement):
        yield f"a {type(answer).__name__}; allowed: a Measurement"
        return
    if tuple(answer.objectives) != expected:
        yield f"the objectives {', '.join(answer.objectives)}; it promised: {', '.join(expected)}"
    for objective, value in answer.objectives.items():
        if not _is_number(value) and value is not None:
            yield f"{value!r} for {objective!r}; allowed: a finite number, or None"
    for table, rows in answer.features.items():
        lengths = {len(row) for row in rows}
        if len(lengths) > 1 or not all(_is_number(value) for row in rows for value in row):
            yield f"the table {table!r} with rows that are not of one length and finite"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def _make_plugin_error(name: str, when: str, error: BaseException) -> PluginError:
    return PluginError(
        f"{_words(name)} raised {type(error).__name__} {when}: {error}{exception_place(error)}",
        cause="feedback_raised",
        log=_log(error),
    )


def _words(name: str) -> str:
    """Returns the words for a feedback, with its package."""
    return describe_plugin("feedback", name, FeedbackCatalogue(()).package(name))


def _log(error: BaseException) -> str:
    return "".join(traceback.format_exception(error))[-_LOG:]
