"""Waiting for the next change of what is followed: by events, or by looks without them."""

from __future__ import annotations

import time
from http import HTTPStatus
from typing import TYPE_CHECKING

from drivora_service.client.calls import events
from drivora_service.client.flows import Flow, Listen, Receive, Sleep, Terms, may_pass
from drivora_service.client.listening import EventReader
from drivora_service.client.replies import Reply

if TYPE_CHECKING:
    from drivora_service.client.listening import Event
    from drivora_service.store.changes.change_lists import ChangedKind

_SHORTEST_S, _LONGEST_S = 0.1, 2.0
"""Bounds of the seconds between two looks, of which a look shall take half at most."""
_WORKERS = "workers"


class Waiting:
    """Waits for changes of one object.

    An application in this process is looked at again and again, as is a service of a version
    without events.
    """

    def __init__(self, kind: ChangedKind, object_id: str, terms: Terms) -> None:
        """Asks for nothing yet.

        Args:
            kind: Kind of the object.
            object_id: Its id.
            terms: How the service is asked.
        """
        from drivora_service.api.schemas.events import EventKind

        self._call = events.events([kind, EventKind.WORKERS], of=object_id)
        self._reader = EventReader("", terms.service)
        self._has_events, self._is_open = not terms.service.is_local, False

    def begin(self) -> Flow[None]:
        """Opens the stream of events, before the first look, so that no change is missed."""
        if not self._has_events or self._is_open:
            return
        headers = dict(self._call.headers)
        if self._reader.last_id:
            headers["Last-Event-ID"] = self._reader.last_id
        outcome = yield Listen(call=self._call, headers=headers)
        if isinstance(outcome, Reply):
            self._is_open = outcome.status == HTTPStatus.OK
            # What a service has refused for another reason, it will say of a look, too.
            self._has_events = self._is_open or may_pass(outcome)
        self._reader.restart()

    def change(self, otherwise: Sleep, *, looked_s: float) -> Flow[None]:
        """Waits until it is worth looking: something has changed, or nothing for a while.

        Args:
            otherwise: The wait where there are no events.
            looked_s: Seconds that the last look took.
        """
        if not self._is_open:
            yield otherwise
            # A stream begins with what has changed meanwhile.
            yield from self.begin()
            return
        earliest = time.monotonic() + min(max(looked_s, _SHORTEST_S), _LONGEST_S)
        while True:
            part = yield Receive()
            if not isinstance(part, bytes):
                # The look tells whether the service is gone, and waits for its return.
                self._is_open = False
                break
            told = list(self._reader.read(part))
            if any(_matters(event) for event in told) or (not told and b"heartbeat" in part):
                break
        left = earliest - time.monotonic()
        if left > 0.0:
            yield Sleep(left)


def _matters(event: Event) -> bool:
    """Returns whether an event is a reason to look."""
    from drivora_service.api.schemas.events import Begin
    from drivora_service.api.schemas.workers import Workers

    if isinstance(event.data, Workers):
        return any(fault.name == _WORKERS for fault in event.data.faults)
    return not isinstance(event.data, Begin)
