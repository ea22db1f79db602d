"""Groups of failures and what people have decided about them, as values."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum

from drivora_service.shapes import Shape
from drivora_service.store.failures.failure_records import FoundFailure, FoundFilter

LONGEST_LABEL, LONGEST_PERSON, LONGEST_NOTE = 200, 100, 10_000
"""Characters of a label, of the name of a person, and of a note."""


class GroupStatus(StrEnum):
    """What people have decided about a group of failures."""

    NEW = "new"
    """No user has decided anything."""
    KNOWN = "known"
    FIXED = "fixed"
    WILL_NOT_FIX = "will_not_fix"


class SinceBaseline(StrEnum):
    """How a group stands to a baseline."""

    NEW = "new"
    """It has failures, and none in the baseline."""
    SAME = "same"
    """It has failures, in the baseline as well."""
    GONE = "gone"
    """It has failures in the baseline only."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupDecision(Shape):
    """What has been decided about a group.

    Attributes:
        id: Of the group.
        label: Its name; empty: it is told by its `names`.
        assignee: Who takes care of it; empty: no one.
        status_at: When the status was set; null if nobody has.
        changed_at: When anything was decided about it; null if nothing was.
        changed_by: Who did so; empty if that is not known.
        revision: Count of all changes at its newest one; 0 if nothing was decided.
    """

    id: str
    label: str = ""
    status: GroupStatus = GroupStatus.NEW
    assignee: str = ""
    note: str = ""
    status_at: datetime | None = None
    changed_at: datetime | None = None
    changed_by: str = ""
    revision: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureGroup(GroupDecision):
    """The failures of one group that pass a filter.

    Attributes:
        names: What its failures have in common: oracle, relation of the other actor to the ego, and
            manoeuvre. Several if groups were merged.
        failures: Number of failures.
        avoidable: Those that are the fault of an ego and avoidable.
        preventable: Those at the fault of others that a careful driver of the ego avoids.
        others: All but the avoidable ones.
        campaigns: Number of campaigns that found some.
        towns: Number of road networks.
        first_seen: When the first was found.
        last_seen: When the last was found.
        is_back: Whether it was found again after it was declared fixed.
        baseline_failures: Number of failures in the baseline; null without one.
        since_baseline: How it stands to the baseline; null without one.
        example: One with a recording, if it has one, and of those the last that is the fault of an
            ego and avoidable, else the last. Of a group that is gone, one of the baseline.
        sentence: The facts of the example.
    """

    names: tuple[str, ...]
    failures: int
    avoidable: int
    preventable: int
    others: int
    campaigns: int
    towns: int
    first_seen: datetime
    last_seen: datetime
    is_back: bool
    baseline_failures: int | None = None
    since_baseline: SinceBaseline | None = None
    example: FoundFailure
    sentence: str


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupFilter:
    """A filter of groups; defaults do not restrict.

    Attributes:
        failures: Which failures count.
        baseline: Which failures they are compared with; ``None``: none.
        statuses: Groups of these statuses; empty: of all.
        assignee: Groups that this person takes care of.
        since_baseline: Groups that stand so to the baseline.
    """

    failures: FoundFilter = field(default_factory=FoundFilter)
    baseline: FoundFilter | None = None
    statuses: frozenset[GroupStatus] = frozenset()
    assignee: str = ""
    since_baseline: SinceBaseline | None = None


class ChangedPart(StrEnum):
    """What a change of a group has changed."""

    STATUS = "status"
    LABEL = "label"
    ASSIGNEE = "assignee"
    NOTE = "note"
    MERGED = "merged"
    """Another group was merged into it."""
    SPLIT = "split"
    """Failures were split off, or it began as those of another group."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupChange(Shape):
    """One decision about a group.

    Attributes:
        by: Who; empty if that is not known.
        before: As it was; empty for what was not there.
        after: As it is since; of a merged group, its label or names.
    """

    at: datetime
    by: str
    what: ChangedPart
    before: str
    after: str


@dataclass(frozen=True, slots=True, kw_only=True)
class NewDecision:
    """A user's new decision about a group; ``None`` leaves a part as it is."""

    status: GroupStatus | None = None
    label: str | None = None
    assignee: str | None = None
    note: str | None = None


def group_id(name: str) -> str:
    """Returns the id of the group of a name: the same in all databases."""
    return hashlib.sha256(name.encode()).hexdigest()[:24]
