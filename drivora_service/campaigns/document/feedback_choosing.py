"""What a campaign's choice of objectives means: names looked up, and checked for its tester."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.feedback_documents import (
    Direction,
    FeedbackDocument,
    ObjectiveDocument,
)
from drivora_service.campaigns.document.known_objectives import (
    KnownObjective,
    describe_known,
    known_objectives,
    objectives_of_feedback,
)
from drivora_service.errors import DrivoraError, Problem, closest_name
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.feedback.objective_choice import ObjectiveChoice, ObjectiveKind
from drivora_service.oracles.oracle_descriptions import Better
from drivora_service.search.aims import Guidance
from drivora_service.search.plugin import TesterPlugin

_POINTER = "/feedback"


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedbackReading:
    """A campaign's choice of objectives, read.

    Attributes:
        objectives: The chosen objectives; empty if there are problems.
        problems: What is wrong with the choice.
    """

    objectives: tuple[ObjectiveChoice, ...] = ()
    problems: tuple[Problem, ...] = ()


def read_feedback(
    document: FeedbackDocument, tester: TesterPlugin[Any] | None, catalogues: Catalogues
) -> FeedbackReading:
    """Reads a choice of objectives.

    Args:
        document: The choice.
        tester: The tester that it is for; ``None``: not known.
        catalogues: Catalogues for the names.
    """
    chosen: list[ObjectiveChoice] = []
    problems: list[Problem] = []
    known = known_objectives(catalogues)
    if document.name in catalogues.feedbacks.names():
        chosen, problems = _whole_feedback(document, catalogues)
    else:
        if document.parameters:
            problems.append(
                _problem(
                    "/parameters",
                    "feedback_parameters",
                    f"{document.name!r} is an objective, which has no parameters; leave them out, "
                    f"or name a feedback: {', '.join(catalogues.feedbacks.names())}",
                )
            )
        for place, one in enumerate(document.chosen):
            pointer = "" if document.objectives is None else f"/objectives/{place}"
            found, wrong = _read_objective(one, pointer, known, catalogues)
            chosen += [] if found is None else [found]
            problems += wrong
    if any(one.weight is not None for one in chosen):
        chosen = [replace(one, weight=1.0 if one.weight is None else one.weight) for one in chosen]
    if tester is not None and not problems:
        problems += _tester_problems(document, tester, chosen)
    if problems:
        return FeedbackReading(problems=tuple(problems))
    return FeedbackReading(objectives=tuple(chosen))


def feedback_notes(
    objectives: Sequence[ObjectiveChoice], tester: TesterPlugin[Any]
) -> Iterator[str]:
    """Yields how a choice of objectives was interpreted."""
    if not objectives:
        return
    names = ", ".join(one.name for one in objectives)
    if tester.guidance is Guidance.NONE:
        yield f"tester {tester.name!r} goes by no objectives: {names} is measured only"
        return
    weighed = objectives[0].weight is not None
    what = f"the weighted sum of {names}" if weighed else names
    yield f"tester {tester.name!r} minimises {what} in place of its own objectives"


def _whole_feedback(
    document: FeedbackDocument, catalogues: Catalogues
) -> tuple[list[ObjectiveChoice], list[Problem]]:
    """Returns all objectives of a feedback that is chosen by its name."""
    name = document.name or ""
    odd = [key for key in ("direction", "target") if getattr(document, key) is not None]
    if odd:
        text = (
            f"{name!r} is a feedback, whose objectives are minimised as they are; leave out "
            f"{', '.join(odd)}, or name one of its objectives"
        )
        return [], [_problem(f"/{odd[0]}", "feedback_choice", text)]
    try:
        feedback = catalogues.feedbacks.create(
            FeedbackChoice(name=name, parameters=document.parameters)
        )
    except DrivoraError as error:
        return [], [_problem("/parameters", "feedback_parameters", str(error))]
    except (Exception, SystemExit) as error:
        text = f"feedback {name!r} raised {type(error).__name__} when it was made: {error}"
        return [], [_problem("/name", "plugin", text)]
    return [
        replace(one.choice(one.member), parameters=document.parameters, scale=document.scale)
        for one in objectives_of_feedback(name, feedback.objectives)
    ], []


def _read_objective(
    one: ObjectiveDocument,
    pointer: str,
    known: Sequence[KnownObjective],
    catalogues: Catalogues,
) -> tuple[ObjectiveChoice | None, list[Problem]]:
    found = [each for each in known if one.name in (each.name, each.qualified)]
    if not found:
        return None, [_unknown(one.name, f"{pointer}/name", known, catalogues)]
    if len(found) > 1:
        choices = " or ".join(repr(each.qualified) for each in found)
        text = f"{one.name!r} is the name of several objectives; give {choices}"
        return None, [_problem(f"{pointer}/name", "ambiguous_objective", text)]
    (objective,) = found
    if one.direction is None and objective.better is Better.NEITHER:
        text = (
            f"{one.name!r} is neither better nor worse for the ADS if it is greater; give the "
            "`direction`: minimise or maximise"
        )
        return None, [_problem(f"{pointer}/direction", "direction", text)]
    negated = (
        objective.better is Better.LOWER
        if one.direction is None
        else one.direction is Direction.MAXIMISE
    )
    name = one.name if objective.name != one.name else objective.name
    target = objective.target if one.target is None else one.target
    if negated and target is not None:
        target = -target
    return replace(
        objective.choice(f"negated_{name}" if negated else name),
        negated=negated,
        target=target,
        scale=one.scale,
        weight=one.weight,
    ), []


def _tester_problems(
    document: FeedbackDocument, tester: TesterPlugin[Any], chosen: Sequence[ObjectiveChoice]
) -> Iterator[Problem]:
    if tester.guidance is Guidance.OWN:
        yield _problem(
            "",
            "feedback_not_chosen",
            f"tester {tester.name!r} goes by what its own feedback measures, and cannot be given "
            "other objectives; leave `feedback` out, or choose another tester",
        )
    weighed = any(one.weight is not None for one in chosen)
    if tester.guidance is Guidance.ONE and len(chosen) > 1 and not weighed:
        pointer = "/name" if document.objectives is None else "/objectives"
        names = ", ".join(one.name for one in chosen)
        yield _problem(
            pointer,
            "several_objectives",
            f"tester {tester.name!r} minimises one objective; found {names}. Name one, or give "
            "each a `weight` under `objectives`",
        )


def _unknown(
    name: str, pointer: str, known: Sequence[KnownObjective], catalogues: Catalogues
) -> Problem:
    reason = catalogues.metrics.reason(name)
    if reason:
        return _problem(pointer, "plugin", reason)
    names = [each.name for each in known] + list(catalogues.feedbacks.names())
    close = closest_name(name, names)
    meant = f"; did you mean {close!r}? Known" if close else "; known"
    listing = describe_known(known, catalogues.feedbacks.names())
    return _problem(pointer, "unknown_objective", f"unknown objective {name!r}{meant}: {listing}")


def _problem(pointer: str, code: str, message: str) -> Problem:
    return Problem(pointer=f"{_POINTER}{pointer}", code=code, message=message)


def versions_of_objectives(
    objectives: Sequence[ObjectiveChoice], catalogues: Catalogues
) -> dict[str, str]:
    """Returns the packages that measure chosen objectives, with their versions."""
    found: dict[str, str] = {}
    for one in objectives:
        if one.kind is ObjectiveKind.METRIC:
            found |= catalogues.metrics.versions(one.member)
        elif one.kind is ObjectiveKind.FEEDBACK:
            found |= catalogues.feedbacks.versions(one.owner)
        else:
            found |= catalogues.oracles.versions(one.owner)
    return found
