"""Groups of failures with their addresses, and what people decide about them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.api.schemas.failures import FoundFailure, found_failure_of
from drivora_service.given_names import CHECKED_NAME, CHECKED_NOTE
from drivora_service.shapes import Shape, combine
from drivora_service.store.failures import group_records
from drivora_service.store.failures.group_records import (
    LONGEST_LABEL,
    LONGEST_NOTE,
    LONGEST_PERSON,
    GroupStatus,
)

_MOST_GROUPS, _MOST_FAILURES, _MOST_NAMES = 100, 10_000, 100

Person = Annotated[
    str,
    Field(
        max_length=LONGEST_PERSON,
        description="Who decides; the name of the token, if there is one, is noted as well.",
    ),
    CHECKED_NAME,
]
GroupId = Annotated[str, Field(min_length=1, max_length=40)]
GroupLabel = Annotated[str, Field(max_length=LONGEST_LABEL), CHECKED_NAME]


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureGroup(group_records.FailureGroup):
    """Failures of one group that pass a filter, with what was decided about the group.

    Attributes:
        failures_url: Address of its failures.
        changes_url: Address of what was decided about it.
    """

    example: FoundFailure
    failures_url: str
    changes_url: str


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupChangeList(Shape):
    """What was decided about a group.

    Attributes:
        items: The last first.
    """

    items: tuple[group_records.GroupChange, ...]


class DecisionRequest(Schema):
    """A decision about a group; what is left out stays."""

    status: GroupStatus | None = Field(None, description="Its status.")
    label: GroupLabel | None = Field(None, description="Its name; empty: told by its `names`.")
    assignee: Annotated[str, Field(max_length=LONGEST_PERSON), CHECKED_NAME] | None = Field(
        None, description="Who takes care of it; empty: no one."
    )
    note: Annotated[str, Field(max_length=LONGEST_NOTE), CHECKED_NOTE] | None = Field(
        None, description="A note."
    )
    by: Person = ""
    revision: int | None = Field(
        None,
        ge=0,
        le=2**53,
        description="That of the group as it was seen: refused with 409 if it has changed since. "
        "Without it, whatever it is.",
    )


class MergeRequest(Schema):
    """Which groups are one."""

    into: GroupId = Field(description="Id of the group that stays.")
    groups: tuple[GroupId, ...] = Field(
        min_length=1,
        max_length=_MOST_GROUPS,
        description="Ids of the groups whose failures come to it, also those found later.",
    )
    by: Person = ""


class SplitRequest(Schema):
    """Which part of a group is a group of its own."""

    failures: tuple[int, ...] = Field(
        (), max_length=_MOST_FAILURES, description="Ids of failures; no later ones follow them."
    )
    names: tuple[Annotated[str, Field(max_length=400)], ...] = Field(
        (),
        max_length=_MOST_NAMES,
        description="Names of the group, whose failures are split off, also those found later.",
    )
    label: GroupLabel = Field("", description="Name of the new group.")
    by: Person = ""


def failure_group_of(
    group: group_records.FailureGroup, base: str, failures_url: str
) -> FailureGroup:
    """Returns a group with its addresses; ``base`` is the address of the API."""
    return combine(
        FailureGroup,
        group,
        example=found_failure_of(group.example, base),
        failures_url=failures_url,
        changes_url=f"{base}/failures/groups/{group.id}/changes",
    )
