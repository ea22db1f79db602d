"""What makes a tester, a mutation or a selection known by a name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.search.components import Components, Mutation, Selection
from drivora_service.search.tester import Tester, TesterContext

P = TypeVar("P")


@dataclass(frozen=True, slots=True, kw_only=True)
class TesterPlugin(Generic[P]):
    """What an entry point of the group ``drivora_service.testers`` gives.

    Attributes:
        name: In campaign files; letters, digits, dashes.
        title: The method's own name.
        description: One sentence.
        source: Paper or package that it follows.
        parameters: A frozen dataclass with a default for every field; a campaign's parameters are
            checked against its types.
        feedback: What its evaluations must be measured by.
        create: Makes a tester. Raises ``SearchError`` if it cannot work in the space.
        is_generational: Whether it waits for a whole generation before it proposes the next.
    """

    name: str
    title: str
    description: str
    source: str
    parameters: type[P]
    feedback: FeedbackChoice
    create: Callable[[TesterContext, P, Components], Tester]
    is_generational: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class MutationPlugin:
    """What an entry point of the group ``drivora_service.mutations`` gives."""

    name: str
    description: str
    create: Callable[[], Mutation]


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectionPlugin:
    """What an entry point of the group ``drivora_service.selections`` gives."""

    name: str
    description: str
    create: Callable[[], Selection]
