"""Measuring a run for a tester: by its own feedback, and by objectives that a campaign chose."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace

from drivora_service.errors import PluginError
from drivora_service.feedback.measurement import Feedback, FeedbackChoice, Measurement
from drivora_service.feedback.objective_choice import (
    ObjectiveChoice,
    ObjectiveKind,
    combine_objectives,
)
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.laws.law import Law
from drivora_service.oracles.laws.law_judging import law_robustness
from drivora_service.runs.run_report import RunReport
from drivora_service.worker.measuring import is_built_in, make_feedback, measure_run


@dataclass(frozen=True, slots=True, kw_only=True)
class Measuring:
    """Measures runs for a tester.

    Attributes:
        choice: The tester's feedback, with the objectives that a campaign chose.
        feedback: That feedback.
        others: Further feedbacks, which measure chosen objectives; by their owner and parameters.
        laws: Laws that judge runs, by name.
    """

    choice: FeedbackChoice
    feedback: Feedback
    others: Mapping[str, Feedback]
    laws: Mapping[str, Law]

    @property
    def is_built_in(self) -> bool:
        """Whether no code of other packages measures."""
        return all(map(is_built_in, (self.feedback, *self.others.values())))

    def measure(self, report: RunReport, run: RunView) -> Measurement:
        """Measures a judged run.

        Args:
            report: Its report, with all metrics and scores.
            run: The run.

        Returns:
            The chosen objectives first, then those of the tester's own feedback.

        Raises:
            PluginError: A feedback raised, or an objective is not measured by this installation.
        """
        own = measure_run(self.choice.name, self.feedback, run)
        if not self.choice.objectives:
            return own
        measured: dict[str, Measurement] = {}
        values: dict[str, float | None] = {}
        for one in self.choice.objectives:
            if one.kind is ObjectiveKind.FEEDBACK:
                key = _key(one)
                if key not in measured:
                    measured[key] = measure_run(one.owner, self.others[key], run)
                value = measured[key].objectives[one.member]
            elif one.kind is ObjectiveKind.LAW:
                value = _measure_law(self.laws, one.owner, run)
            else:
                known = report.metrics if one.kind is ObjectiveKind.METRIC else report.scores
                if one.member not in known:
                    raise _refuse_unknown(one)
                value = known[one.member]
            values[one.name] = -value if one.negated and value is not None else value
        chosen = combine_objectives(self.choice.objectives, values)
        rest = {name: value for name, value in own.objectives.items() if name not in chosen}
        return replace(own, objectives={**chosen, **rest})


def make_measuring(choice: FeedbackChoice, laws: tuple[Law, ...]) -> Measuring:
    """Returns what measures runs for a tester.

    Args:
        choice: The tester's feedback, with the objectives that a campaign chose.
        laws: The traffic laws that judge runs.

    Raises:
        UnknownName: There is no such feedback.
        SearchError: It does not accept its parameters, or has no such objective.
        PluginError: A plug-in cannot be loaded, or raises.
    """
    others = {
        _key(one): make_feedback(FeedbackChoice(name=one.owner, parameters=one.parameters), laws)
        for one in choice.objectives
        if one.kind is ObjectiveKind.FEEDBACK
    }
    return Measuring(
        choice=choice,
        feedback=make_feedback(choice, laws),
        others=others,
        laws={law.name: law for law in laws},
    )


def _key(one: ObjectiveChoice) -> str:
    return json.dumps([one.owner, dict(one.parameters)], sort_keys=True)


def _measure_law(laws: Mapping[str, Law], name: str, run: RunView) -> float | None:
    """Returns the least robustness of a law of all egos; ``None`` if none has started."""
    if name not in laws:
        raise PluginError(
            f"the objective is the law {name!r}, which this installation does not have; put its "
            "file into the folder of laws",
            cause="feedback_plugin",
        )
    return min((law_robustness(ego, laws[name]) for ego in run.egos if ego.count), default=None)


def _refuse_unknown(one: ObjectiveChoice) -> PluginError:
    of = f"the {one.kind.value} {one.owner or one.member!r}"
    return PluginError(
        f"the objective {one.member!r} is not measured here: {of} is not installed, or another "
        "version of it; install the package that the campaign's versions name",
        cause="feedback_plugin",
    )
