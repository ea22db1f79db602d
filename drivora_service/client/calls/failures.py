"""Failures of all campaigns and batches, and their groups."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, Listing, Query, get, listing

if TYPE_CHECKING:
    from drivora_service.api.schemas.failures import FailureGroup, FoundFailure
    from drivora_service.store.found_records import FoundFilter


def found_failures(
    wanted: FoundFilter | None = None, *, limit: int | None = None
) -> Listing[FoundFailure]:
    """Returns failures of all campaigns and batches, the last found first; at most ``limit``."""
    from drivora_service.api.schemas.failures import FoundFailure

    return listing(f"{PREFIX}/failures", FoundFailure, limit, query=_query(wanted))


def found_failure(failure_id: int) -> Call[FoundFailure]:
    """Returns one of them."""
    from drivora_service.api.schemas.failures import FoundFailure

    return get(f"{PREFIX}/failures/{{number}}", FoundFailure, number=failure_id)


def failure_groups(
    wanted: FoundFilter | None = None, *, limit: int | None = None
) -> Listing[FailureGroup]:
    """Returns the groups of failures that pass a filter, the last seen first; at most ``limit``."""
    from drivora_service.api.schemas.failures import FailureGroup

    return listing(f"{PREFIX}/failures/groups", FailureGroup, limit, query=_query(wanted))


def _query(wanted: FoundFilter | None) -> Query:
    from drivora_service.store.found_records import FoundFilter

    wanted = wanted or FoundFilter()
    return {
        "oracle": wanted.oracle,
        "group": wanted.group,
        "at_fault": wanted.at_fault,
        "accountability": wanted.accountability,
        "agent": wanted.agent,
        "town": wanted.town,
        "campaign": wanted.campaign_id,
        "batch": wanted.batch_id,
        "confirmation": wanted.confirmation,
        "since": None if wanted.since is None else wanted.since.isoformat(),
        "until": None if wanted.until is None else wanted.until.isoformat(),
    }
