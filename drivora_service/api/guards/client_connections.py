"""Connections of clients, with a limit of their number and deadlines."""

from __future__ import annotations

import asyncio
import resource
import time
from collections.abc import Callable, Iterable
from http import HTTPStatus
from typing import Any, ClassVar

import h11
from uvicorn.protocols.http.flow_control import FlowControl
from uvicorn.protocols.http.h11_impl import H11Protocol

from drivora_service.api.guards.client_counts import ClientCounts, Reason
from drivora_service.api.guards.client_waits import ClientWaits, client_key
from drivora_service.api.guards.load_guard import EVENTS_PATH, refuse_overload
from drivora_service.api.guards.request_turns import Turns, urgent_requests
from drivora_service.api.problem_details import MEDIA_TYPE, ProblemDetails

HEAD_SECONDS = 20.0
"""From the opening of a connection, or the first byte of a further request, to the head's end."""
STALL_SECONDS = 60.0
"""For which a client may take nothing of an answer."""
MOST_CONNECTIONS = 8192
_SLICE_S = 0.002
"""Seconds for which what came of one connection is read before others get their turn."""
_LEAST_SLICE, _MOST_SLICE = 1 << 10, 8 << 10
"""Bytes that are read at once. Those of a large chunk are copied only; of chunks of one byte, each
takes as long as a hundred kilobytes do."""
_OWN_DESCRIPTORS = 512
"""Of the database, the workers and the files that answers are read from."""
_MOST_DESCRIPTORS = 65_536


def raise_descriptor_limit() -> int:
    """Raises the limit of open files to the greatest that the system allows.

    Returns:
        How many connections of clients leave enough descriptors for everything else.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _MOST_DESCRIPTORS if hard == resource.RLIM_INFINITY else min(hard, _MOST_DESCRIPTORS)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
        soft = wanted
    descriptors = _MOST_DESCRIPTORS if soft == resource.RLIM_INFINITY else soft
    return min(MOST_CONNECTIONS, max(descriptors // 4, descriptors - _OWN_DESCRIPTORS))


class HeldFlow(FlowControl):
    """Takes no more bytes of a connection while those that have come wait to be read.

    The application asks for more whenever it waits for a body, and each time a quarter of a
    megabyte would be added to what waits.
    """

    def __init__(self, transport: asyncio.Transport) -> None:
        super().__init__(transport)
        self._is_held = False

    def hold(self) -> None:
        """Takes nothing until the release."""
        self._is_held = True
        self.pause_reading()

    def release(self) -> None:
        """Takes bytes again."""
        self._is_held = False
        self.resume_reading()

    def resume_reading(self) -> None:
        """Takes bytes again, unless they are held back."""
        if not self._is_held:
            super().resume_reading()


class BoundedConnection(H11Protocol):
    """One connection, with deadlines; one beyond ``most`` gets the answer of an overload.

    The server itself would wait for ever for the head of a request, and for a client that takes
    nothing of its answer. One client may have ``most_of_a_client`` connections: another one ends
    that of its oldest which has no request, and is refused if all have one.

    Attributes:
        most: Connections that are served; set, as all of these, before the server starts.
        most_of_a_client: The same of one address; ``None``: half of them.
        head_s: Seconds for the head of a request; ``None``: ``HEAD_SECONDS``.
        turns: In which order requests are begun.
        urgent: How requests start that are begun before others.
        counts: What happens to connections.
    """

    most = MOST_CONNECTIONS
    most_of_a_client: int | None = None
    head_s: float | None = None
    turns = Turns()
    urgent = urgent_requests()
    counts = ClientCounts()
    _stalled = ClientWaits()
    _of_client: ClassVar[dict[str, dict[BoundedConnection, None]]] = {}

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._deadline: asyncio.TimerHandle | None = None
        self._stall: asyncio.TimerHandle | None = None
        self._end_stall: Callable[[], None] | None = None
        self._unread = b""
        self._key = ""
        self._ended_here = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override] # as the base class
        """Accepts a connection, or refuses it if there are too many."""
        super().connection_made(transport)
        self.flow = self._flow = HeldFlow(transport)
        self._key = client_key(self.client)
        own = self._of_client.setdefault(self._key, {})
        own[self] = None
        most_own = self.most_of_a_client or max(1, self.most // 2)
        if len(own) > most_own and not self._replace_idle(own):
            if len(own) > most_own + max(1, most_own // 8):
                self._cut_off("connections")
                return
            self.counts.cut_off("connections")
            self.app = refuse_overload
        elif len(self.connections) > self.most + self.most // 8:
            self._cut_off("connections")
            return
        elif len(self.connections) > self.most:
            self.counts.cut_off("connections")
            self.app = refuse_overload
        self._await_head()

    def _replace_idle(self, own: Iterable[BoundedConnection]) -> bool:
        """Ends the oldest of a client's connections without a request; returns whether any was."""
        for one in own:
            if one is not self and one._is_idle and not one.transport.is_closing():
                one._cut_off("connections")
                return True
        return False

    @property
    def _is_idle(self) -> bool:
        return self.conn.their_state is h11.IDLE and not self._unread

    def _cut_off(self, reason: Reason) -> None:
        self.counts.cut_off(reason)
        self._ended_here = True
        self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forgets a connection."""
        self._stop_waiting()
        self.resume_writing()
        self._count_leaving()
        own = self._of_client.get(self._key)
        if own is not None:
            own.pop(self, None)
            if not own:
                del self._of_client[self._key]
        super().connection_lost(exc)

    def _count_leaving(self) -> None:
        """Counts a client that closed the connection before its answer was complete."""
        cycle = self.cycle
        if cycle is None or cycle.response_complete or self._ended_here:
            return
        if cycle.more_body:
            self.counts.leave("request")
        else:
            self.counts.leave("events" if cycle.scope["path"].endswith(EVENTS_PATH) else "answer")

    def data_received(self, data: bytes) -> None:
        """Reads a part of a request; one that begins may have to wait for its turn."""
        if self._unread:
            self._unread += data
            self._flow.hold()
        elif self.conn.their_state is not h11.IDLE or data.startswith(self.urgent):
            self._read(data)
        else:
            # A request that waits for its turn is not an idle connection.
            self._unset_keepalive_if_required()
            self._unread = data
            self.turns.begin(self._read_what_has_come)

    def _read_what_has_come(self) -> None:
        data, self._unread = self._unread, b""
        if not data or self.transport.is_closing():
            return
        self._flow.release()
        try:
            self._read(data)
        except BaseException:
            self.transport.abort()
            raise

    def shutdown(self) -> None:
        """Ends the connection once a request that has come is answered."""
        self._read_what_has_come()
        super().shutdown()

    def _read(self, data: bytes) -> None:
        rest = self._read_for_a_moment(data)
        if rest:
            self._unread = rest
            self._flow.hold()
            self.loop.call_soon(self.turns.begin, self._read_what_has_come)
        if self.conn.their_state is h11.IDLE and not self.transport.is_closing():
            # A few bytes of the next head would end the waiting of the server for an idle client.
            if self.timeout_keep_alive_task is None and self._deadline is None:
                self._await_head()
        else:
            self._stop_waiting()

    def _read_for_a_moment(self, data: bytes) -> bytes:
        """Reads data in small slices, for a limited time; returns what is left.

        Else a client that sends chunks of one byte stops the event loop for seconds, as often as
        it sends a quarter of a megabyte of them.
        """
        begun = last = time.perf_counter()
        at, size = 0, _LEAST_SLICE
        while at < len(data) and not self.transport.is_closing():
            super().data_received(data[at : at + size])
            at += size
            now = time.perf_counter()
            if now - begun > _SLICE_S:
                return b"" if self.transport.is_closing() else data[at:]
            size = _LEAST_SLICE if now - last > _SLICE_S / 4 else min(2 * size, _MOST_SLICE)
            last = now
        return b""

    def pause_writing(self) -> None:
        """Sets the deadline of a client that does not read its answer."""
        super().pause_writing()
        if self._stall is None:
            self._stall = self.loop.call_later(STALL_SECONDS, self._cut_off, "answer")
            # Of a proxy's request, the client that the proxy names.
            client = client_key(self.scope["client"]) if self.scope else self._key
            self._end_stall = self._stalled.begin(client, lambda: self._cut_off("answers"))

    def resume_writing(self) -> None:
        """Continues when the client reads again."""
        if self._stall is not None:
            self._stall.cancel()
            self._stall = None
        if self._end_stall is not None:
            self._end_stall()
            self._end_stall = None
        super().resume_writing()

    def send_400_response(self, msg: str) -> None:
        """Refuses input that is not HTTP."""
        self._refuse(HTTPStatus.BAD_REQUEST, f"{msg.rstrip('.')}: this is no HTTP/1.1")

    def _await_head(self) -> None:
        self._deadline = self.loop.call_later(self._head_s, self._give_up)

    @property
    def _head_s(self) -> float:
        return HEAD_SECONDS if self.head_s is None else self.head_s

    def _stop_waiting(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _give_up(self) -> None:
        self._deadline = None
        if self._unread:
            # What has come waits for its turn; the time begins anew when it is read.
            return
        if self.transport.is_closing() or self.conn.their_state is not h11.IDLE:
            return
        self.counts.cut_off("head")
        self._refuse(
            HTTPStatus.REQUEST_TIMEOUT, f"no request was complete within {self._head_s:g} s"
        )

    def _refuse(self, status: HTTPStatus, detail: str) -> None:
        """Answers outside of any request, and closes the connection."""
        details = ProblemDetails(title=status.phrase, status=status.value, detail=detail)
        body = details.model_dump_json().encode()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            head = h11.Response(
                status_code=status.value,
                reason=status.phrase.encode(),
                headers=[
                    (b"content-type", MEDIA_TYPE.encode()),
                    (b"content-length", str(len(body)).encode()),
                    (b"connection", b"close"),
                    (b"x-content-type-options", b"nosniff"),
                ],
            )
            for event in (head, h11.Data(data=body), h11.EndOfMessage()):
                self.transport.write(self.conn.send(event))
        self.transport.close()
