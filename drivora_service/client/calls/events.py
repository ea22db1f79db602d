"""Events: what changes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import Call, get

if TYPE_CHECKING:
    from drivora_service.api.schemas.events import EventKind
    from drivora_service.store.changes.change_lists import ChangedKind


def events(
    kinds: Sequence[EventKind | ChangedKind] = (), *, of: str = "", after: str = ""
) -> Call[bytes]:
    """Tells what changes, for as long as the caller listens.

    Where the stream breaks off, as with a restart of the service, it goes on without a gap.

    Args:
        kinds: Kinds of objects, and the workers; none: all.
        of: Id of a batch, campaign, study, minimisation or run: only it, and what belongs to it;
            "": all.
        after: ``id`` of an event: what has changed since comes first; "": only what changes from
            now on.
    """
    query = {"kind": tuple(kinds), "of": of, "after": after}
    return get(f"{PREFIX}/events", bytes, query=query, accept="text/event-stream")
