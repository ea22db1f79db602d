"""Groups of failures, and what people decide about them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated
from urllib.parse import urlencode

from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers.failure_filter import FoundFailures, check_oracle
from drivora_service.api.answers.query_parameters import Limit, PageToken
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers
from drivora_service.api.guards.authorization import client_name, reader, submitter
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.failure_groups import (
    DecisionRequest,
    FailureGroup,
    GroupChangeList,
    MergeRequest,
    SplitRequest,
    failure_group_of,
)
from drivora_service.store.failures.group_records import (
    GroupFilter,
    GroupStatus,
    NewDecision,
    SinceBaseline,
    group_id,
)
from drivora_service.store.runs.run_records import Page

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction

router = resource_router("failures")

_GROUP = "/failures/groups/{group_id:id}"
_OF_GROUPS = frozenset({"limit", "page_token", "status", "assignee", "baseline", "since_baseline"})
"""Parameters that filter groups, not failures."""
_DECISION = {"status": "known", "note": "Issue 12.", "assignee": "Ada", "by": "Ada"}
_MERGER = {"into": group_id("collision|npc_vehicle, front|following"), "by": "Ada"} | {
    "groups": [group_id("collision|npc_vehicle, front|cut_in")]
}
_PART = {"failures": [4, 7], "label": "at the bend", "by": "Ada"}


@router.get(
    "/failures/groups",
    response_model=Page[FailureGroup],
    responses=answers(recorded_examples.FAILURE_GROUPS, 401, 403, 404, 422),
    dependencies=[Depends(reader)],
)
def list_groups(
    request: Request,
    context: Context,
    wanted: FoundFailures,
    status: Annotated[list[GroupStatus] | None, Query(description="With any of these.")] = None,
    assignee: Annotated[
        str, Query(max_length=100, description="Of which this person takes care.")
    ] = "",
    baseline: Annotated[
        str,
        Query(
            max_length=40,
            description="Compares with this baseline: the failures of a batch, a campaign or a "
            "study by its id, or those found before a time (RFC 3339). A failure of the baseline "
            "is not counted a second time.",
        ),
    ] = "",
    since_baseline: Annotated[
        SinceBaseline | None, Query(description="That stand so to the baseline.")
    ] = None,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists the groups of the failures that pass the filters, the last seen first."""
    with context.database.read() as transaction:
        check_oracle(context, transaction, wanted)
        page = transaction.groups.page(
            GroupFilter(
                failures=wanted,
                baseline=transaction.groups.baseline(wanted, baseline) if baseline else None,
                statuses=frozenset(status or ()),
                assignee=assignee,
                since_baseline=since_baseline,
            ),
            limit=limit,
            page_token=page_token,
        )
    # The filters of the request stay: the counts are those of its failures.
    kept = [
        (name, value)
        for name, value in request.query_params.multi_items()
        if name not in _OF_GROUPS and name != "group"
    ]
    items = tuple(
        failure_group_of(
            group,
            context.base,
            f"{context.base}/failures?{urlencode([*kept, ('group', group.id)])}",
        )
        for group in page.items
    )
    body = Page(items=items, next_page_token=page.next_page_token)
    return json_answer(request, Page[FailureGroup], body)


@router.get(
    _GROUP,
    response_model=FailureGroup,
    responses=answers(recorded_examples.FAILURE_GROUP, 401, 403, 404),
    dependencies=[Depends(reader)],
)
def get_group(request: Request, context: Context, group_id: str) -> Response:
    """Returns a group with all its failures."""
    with context.database.read() as transaction:
        group = _group(context.base, transaction, group_id)
    return json_answer(request, FailureGroup, group)


@router.get(
    _GROUP + "/changes",
    response_model=GroupChangeList,
    responses=answers(recorded_examples.GROUP_CHANGES, 401, 403, 404),
    dependencies=[Depends(reader)],
)
def list_changes(request: Request, context: Context, group_id: str) -> Response:
    """Lists what was decided about a group, the last first."""
    with context.database.read() as transaction:
        changes = transaction.groups.changes(group_id)
    return json_answer(request, GroupChangeList, GroupChangeList(items=changes))


@router.post(
    _GROUP + ":decide",
    response_model=FailureGroup,
    responses=answers(recorded_examples.FAILURE_GROUP, 401, 403, 404, 409, 413, 422),
    openapi_extra={"requestBody": {"content": {"application/json": {"example": _DECISION}}}},
    dependencies=[Depends(submitter)],
)
def decide(
    request: Request, context: Context, group_id: str, given: DecisionRequest
) -> FailureGroup:
    """Sets the status, label, assignee or note of a group."""
    new = NewDecision(
        status=given.status, label=given.label, assignee=given.assignee, note=given.note
    )
    with context.database.write() as transaction:
        decided = transaction.decisions.decide(
            group_id, new, by=_person(request, given.by), revision=given.revision
        )
        return _group(context.base, transaction, decided)


@router.post(
    "/failures/groups:merge",
    response_model=FailureGroup,
    responses=answers(recorded_examples.FAILURE_GROUP, 401, 403, 404, 409, 413, 422),
    openapi_extra={"requestBody": {"content": {"application/json": {"example": _MERGER}}}},
    dependencies=[Depends(submitter)],
)
def merge(request: Request, context: Context, given: MergeRequest) -> FailureGroup:
    """Puts the failures of groups into another one, also those found later."""
    with context.database.write() as transaction:
        merged = transaction.decisions.merge(
            given.into, given.groups, by=_person(request, given.by)
        )
        return _group(context.base, transaction, merged)


@router.post(
    _GROUP + ":split",
    response_model=FailureGroup,
    responses=answers(recorded_examples.FAILURE_GROUP, 401, 403, 404, 409, 413, 422),
    openapi_extra={"requestBody": {"content": {"application/json": {"example": _PART}}}},
    dependencies=[Depends(submitter)],
)
def split(request: Request, context: Context, group_id: str, given: SplitRequest) -> FailureGroup:
    """Makes a group of a part of another one, and returns the new group."""
    with context.database.write() as transaction:
        new = transaction.decisions.split(
            group_id,
            failures=given.failures,
            names=given.names,
            label=given.label,
            by=_person(request, given.by),
        )
        return _group(context.base, transaction, new)


def _group(base: str, transaction: Transaction, group_id: str) -> FailureGroup:
    group = transaction.groups.get(group_id)
    return failure_group_of(group, base, f"{base}/failures?{urlencode({'group': group.id})}")


def _person(request: Request, given: str) -> str:
    """Returns the name of the user that decides: the given one, and that of the token."""
    token = client_name(request)
    return f"{given} ({token})" if given and token else given or token
