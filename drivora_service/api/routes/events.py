"""Events: what changes, told as it happens."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Header, Query, Request, Response

from drivora_service.api.answers.change_feed import feed_of
from drivora_service.api.answers.event_stream import HEADERS, EventStream, Wanted
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import EVENTS, event_answers
from drivora_service.api.guards.authorization import is_valid, reader
from drivora_service.api.guards.method_table import is_head
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.events import EventKind
from drivora_service.errors import UnknownName
from drivora_service.store.changes.change_lists import ChangedKind
from drivora_service.store.changes.revisions import read_position

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction

_CHANGES = tuple(EventKind(kind.value) for kind in ChangedKind)

router = resource_router("events", Depends(reader))


@router.get(
    "/events",
    response_class=Response,
    responses=event_answers(recorded_examples.EVENTS, 401, 403, 404, 422),
)
async def get_events(
    request: Request,
    kind: Annotated[
        list[EventKind] | None, Query(description="Only of these kinds; may be repeated.")
    ] = None,
    of: Annotated[
        str,
        Query(
            max_length=40,
            description="Only this batch, campaign, study, minimisation or run, and what belongs "
            "to it.",
        ),
    ] = "",
    after: Annotated[
        str,
        Query(
            max_length=40,
            pattern=r"^(([0-9a-f]{12}\.)?[0-9]{1,15})?$",
            description="`id` of an event, or a `revision`: what has changed since comes first. "
            "Empty: only what changes from now on.",
        ),
    ] = "",
    last_event_id: Annotated[
        str, Header(description="The same, as clients send it that connect again; it counts.")
    ] = "",
) -> Response:
    """Tells what changes, as server-sent events, until the client goes.

    `begin` comes first. `changes` has the objects that changed, as they are now: a client that
    connects again with the last `id` misses nothing, also where the service was killed meanwhile.
    `reset` says that what changed since that `id` cannot be told, as after a restored backup: ask
    for everything anew. `workers` has what `GET /workers` answers, at first and then whenever that
    differs, at most once a second. A comment comes after 15 s of silence. What retention removes
    is not told.
    """
    if is_head(request.scope):
        return Response(headers=HEADERS, media_type=EVENTS)
    feed = feed_of(request.app)
    # The workers are of no object.
    kinds = frozenset(kind or (EventKind if not of else _CHANGES))
    # Counted before it reads: what is refused costs no look at the database.
    feed.join()
    try:
        wanted = await feed.read(
            partial(_read_wanted, kinds=kinds, of=of, after=last_event_id or after)
        )
    except BaseException:
        feed.leave()
        raise
    return EventStream(feed, wanted, partial(is_valid, request))


def _read_wanted(
    transaction: Transaction, *, kinds: frozenset[EventKind], of: str, after: str
) -> Wanted:
    if of and not transaction.changes.has(of):
        raise UnknownName("batch, campaign, study, minimisation or run", of, ())
    latest = transaction.changes.latest()
    position = read_position(after)
    is_known = position is not None and transaction.changes.is_known(position)
    return Wanted(
        kinds=frozenset(ChangedKind(wanted.value) for wanted in kinds if wanted in _CHANGES),
        tells_workers=EventKind.WORKERS in kinds,
        of=of,
        begin=position if position is not None and is_known else latest,
        is_reset=bool(after) and not is_known,
    )
