"""Failures of all campaigns and batches, and their groups."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, Listing, Query, act, get, make_listing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from drivora_service.api.schemas.failure_groups import FailureGroup, GroupChangeList
    from drivora_service.api.schemas.failures import FoundFailure
    from drivora_service.store.failures.failure_records import FoundFilter
    from drivora_service.store.failures.found_counting import FoundCounts
    from drivora_service.store.failures.group_records import GroupStatus, SinceBaseline

_GROUPS = f"{PREFIX}/failures/groups"
_GROUP = f"{_GROUPS}/{{group_id}}"


def found_failures(
    wanted: FoundFilter | None = None, *, limit: int | None = None
) -> Listing[FoundFailure]:
    """Returns failures of all campaigns and batches, the last found first; at most ``limit``."""
    from drivora_service.api.schemas.failures import FoundFailure

    return make_listing(f"{PREFIX}/failures", FoundFailure, limit, query=_query(wanted))


def found_counts(wanted: FoundFilter | None = None) -> Call[FoundCounts]:
    """Returns the numbers of the failures that pass a filter, and what they count."""
    from drivora_service.store.failures.found_counting import FoundCounts

    return get(f"{PREFIX}/failures:counts", FoundCounts, query=_query(wanted))


def found_failure(failure_id: int) -> Call[FoundFailure]:
    """Returns one of them."""
    from drivora_service.api.schemas.failures import FoundFailure

    return get(f"{PREFIX}/failures/{{number}}", FoundFailure, number=failure_id)


def failure_groups(
    wanted: FoundFilter | None = None,
    *,
    statuses: Sequence[GroupStatus] = (),
    assignee: str = "",
    baseline: str = "",
    since_baseline: SinceBaseline | None = None,
    limit: int | None = None,
) -> Listing[FailureGroup]:
    """Returns groups of failures, the last seen first.

    Args:
        wanted: Which failures count.
        statuses: Groups of these statuses; empty: of all.
        assignee: Groups that this person takes care of; "": all.
        baseline: What they are compared with: a batch, campaign or study by its id, or a time with
            its zone, before which failures were found; "": nothing.
        since_baseline: Groups that stand so to the baseline; ``None``: all.
        limit: How many at most; ``None``: all.
    """
    from drivora_service.api.schemas.failure_groups import FailureGroup

    query = {
        **_query(wanted),
        "status": tuple(statuses),
        "assignee": assignee,
        "baseline": baseline,
        "since_baseline": since_baseline,
    }
    return make_listing(_GROUPS, FailureGroup, limit, query=query)


def failure_group(group_id: str) -> Call[FailureGroup]:
    """Returns a group with all its failures."""
    from drivora_service.api.schemas.failure_groups import FailureGroup

    return get(_GROUP, FailureGroup, group_id=group_id)


def failure_group_changes(group_id: str) -> Call[GroupChangeList]:
    """Returns what was decided about a group, the last first."""
    from drivora_service.api.schemas.failure_groups import GroupChangeList

    return get(f"{_GROUP}/changes", GroupChangeList, group_id=group_id)


def decide_group(
    group_id: str,
    *,
    status: GroupStatus | None = None,
    label: str | None = None,
    assignee: str | None = None,
    note: str | None = None,
    by: str = "",
    revision: int | None = None,
) -> Call[FailureGroup]:
    """Sets the status, label, assignee or note of a group; ``None`` leaves a part as it is.

    Args:
        group_id: Id of the group.
        status: What is decided about it.
        label: Its name; "": its names stand for it.
        assignee: User that takes care of it; "": unassigned.
        note: A note.
        by: Name of the user that decides.
        revision: That of the group as it was seen; ``None``: whatever it is.

    Raises:
        RequestConflict: The group was changed after it was seen.
    """
    from drivora_service.api.schemas.failure_groups import FailureGroup

    given = {
        "status": status,
        "label": label,
        "assignee": assignee,
        "note": note,
        "by": by,
        "revision": revision,
    }
    body = {name: value for name, value in given.items() if value is not None}
    return act(f"{_GROUP}:decide", FailureGroup, given=body, group_id=group_id)


def merge_groups(into: str, groups: Sequence[str], *, by: str = "") -> Call[FailureGroup]:
    """Puts the failures of groups into another one, also those found later."""
    from drivora_service.api.schemas.failure_groups import FailureGroup

    body = {"into": into, "groups": list(groups), "by": by}
    return act(f"{_GROUPS}:merge", FailureGroup, given=body)


def split_group(
    group_id: str,
    *,
    failures: Sequence[int] = (),
    names: Sequence[str] = (),
    label: str = "",
    by: str = "",
) -> Call[FailureGroup]:
    """Creates a group of a part of another one, and returns the new group.

    Args:
        group_id: Id of the group.
        failures: Ids of failures in it; those found later are not among them.
        names: Names of the group whose failures are split off, also those found later.
        label: Name of the new group.
        by: Name of the user that decides.
    """
    from drivora_service.api.schemas.failure_groups import FailureGroup

    body = {"failures": list(failures), "names": list(names), "label": label, "by": by}
    return act(f"{_GROUP}:split", FailureGroup, given=body, group_id=group_id)


def _query(wanted: FoundFilter | None) -> Query:
    from drivora_service.store.failures.failure_records import FoundFilter

    wanted = wanted or FoundFilter()
    return {
        "oracle": wanted.oracle,
        "group": wanted.group,
        "at_fault": wanted.at_fault,
        "accountability": wanted.accountability,
        "agent": wanted.agent,
        "configuration": wanted.configuration_id,
        "town": wanted.town,
        "campaign": wanted.campaign_id,
        "study": wanted.study_id,
        "batch": wanted.batch_id,
        "confirmation": wanted.confirmation,
        "counts": wanted.counts,
        "since": None if wanted.since is None else wanted.since.isoformat(),
        "until": None if wanted.until is None else wanted.until.isoformat(),
    }
