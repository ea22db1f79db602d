"""Plug-ins: named testers, mutations and selections."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

from drivora_service.errors import Problem
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.search.aims import Guidance
from drivora_service.search.components import Components, Mutation, Selection
from drivora_service.search.tester import Tester, TesterContext

P = TypeVar("P")


def _find_nothing(_parameters: object, _budget: int) -> tuple[Problem, ...]:
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class TesterPlugin(Generic[P]):
    """The object of an entry point of the group ``drivora_service.testers``.

    Attributes:
        name: Name in campaign files; letters, digits, dashes.
        title: Name of the method in its publication.
        description: One sentence.
        source: Paper or package that it follows.
        parameters: A frozen dataclass with a default for every field; a campaign's parameters are
            checked against its types.
        feedback: Feedback that measures its evaluations.
        create: Makes a tester. Raises ``SearchError`` if it cannot search the space.
        is_generational: Whether it waits for a whole generation before it proposes the next.
        oracle: Oracle whose violations it searches; "": whatever oracles the campaign names.
        compares_paths: Whether its candidates have reference paths; then the motion of all actors
            must be planned, and is not left to SUMO.
        packages: Packages of an extra that it needs; a campaign records their versions.
        guidance: Which objectives a campaign may choose in place of its feedback's. A tester that
            can be directed reads ``TesterContext.aims``, or its one objective by
            ``TesterContext.objective``.
        check: Returns what is wrong with parameters that are valid one by one, given the number of
            simulations of each seed scenario; pointers begin at the parameters: ``/islands``. The
            bound of a single field is declared, see ``budget_bounds.within_budget``.
    """

    name: str
    title: str
    description: str
    source: str
    parameters: type[P]
    feedback: FeedbackChoice
    create: Callable[[TesterContext, P, Components], Tester]
    is_generational: bool
    oracle: str = ""
    compares_paths: bool = False
    packages: tuple[str, ...] = ()
    guidance: Guidance = Guidance.OWN
    check: Callable[[P, int], Iterable[Problem]] = _find_nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class MutationPlugin:
    """The object of an entry point of the group ``drivora_service.mutations``."""

    name: str
    description: str
    create: Callable[[], Mutation]


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectionPlugin:
    """The object of an entry point of the group ``drivora_service.selections``."""

    name: str
    description: str
    create: Callable[[], Selection]
