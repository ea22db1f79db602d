"""Listening to the events of a service, and connecting again where their stream breaks off."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from http import HTTPStatus
from typing import TYPE_CHECKING, Any

from drivora_service.client.call import Call
from drivora_service.client.flows import (
    Emit,
    Items,
    Listen,
    Patience,
    Receive,
    Sleep,
    Terms,
    may_pass,
)
from drivora_service.client.replies import Reply, Service, no_answer, read_reply
from drivora_service.errors import ServiceError, ServiceUnavailable

if TYPE_CHECKING:
    from drivora_service.api.schemas.events import Begin, Changes, Reset
    from drivora_service.api.schemas.workers import Workers

    EventData = Begin | Changes | Reset | Workers


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """What a service has told.

    Attributes:
        id: Position in the stream: one that begins ``after`` it misses nothing.
        data: ``Begin`` of a stream, ``Changes``, ``Workers``, or ``Reset`` where what has changed
            is not known, so that everything is to be asked for anew.
    """

    id: str
    data: EventData


class EventReader:
    """Reads server-sent events from the parts of a body.

    Attributes:
        last_id: The last position that the service sent, with an event or without.
    """

    def __init__(self, last_id: str, service: Service) -> None:
        """Creates a reader that has read nothing.

        Args:
            last_id: Position after which the stream begins; "": none.
            service: The service whose events they are, for messages of errors.
        """
        self.last_id = last_id
        self._service = service
        self.restart()

    def restart(self) -> None:
        """Forgets what of an event has come; a new stream begins."""
        self._rest = b""
        self._name, self._data = "", ""

    def read(self, part: bytes) -> Iterator[Event]:
        """Yields the events that a part of the body completes; those of unknown names are left out.

        Raises:
            ServiceError: An event cannot be read.
        """
        *lines, self._rest = (self._rest + part).split(b"\n")
        for line in lines:
            name, _, value = line.decode(errors="replace").removesuffix("\r").partition(":")
            match name:
                case "id":
                    self.last_id = value.strip()
                case "event":
                    self._name = value.strip()
                case "data":
                    self._data += value
                case "" if not value:
                    event, text, self._name, self._data = self._name, self._data, "", ""
                    if text and (data := self._value(event, text)) is not None:
                        yield Event(id=self.last_id, data=data)

    def _value(self, event: str, text: str) -> EventData | None:
        from drivora_service.api.schemas.events import Begin, Changes, Reset
        from drivora_service.api.schemas.workers import Workers
        from drivora_service.shapes import adapter

        kinds: dict[str, Any] = {
            "begin": Begin,
            "changes": Changes,
            "reset": Reset,
            "workers": Workers,
        }
        if event not in kinds:
            return None
        try:
            value: EventData = adapter(kinds[event]).validate_json(text, extra="ignore")
        except ValueError as error:
            raise ServiceError(
                f"{self._service.name} told an event that cannot be read: {error}; "
                "use a client of the service's own version"
            ) from error
        return value


def receive_events(call: Call[bytes], terms: Terms) -> Items[Event]:
    """Hands out events, and connects again with the last position where a stream breaks off.

    Raises:
        ServiceError: The service refused, or did not answer for as long as it was tried.
    """
    reader = EventReader("", terms.service)
    patience = Patience(terms.retry_s)
    while True:
        headers = dict(call.headers)
        if reader.last_id:
            headers["Last-Event-ID"] = reader.last_id
        retry_after_s: float | None = None
        outcome = yield Listen(call=call, headers=headers)
        if isinstance(outcome, Reply) and outcome.status == HTTPStatus.OK:
            reader.restart()
            ended: ServiceError | None = None
            while ended is None:
                part = yield Receive()
                if isinstance(part, bytes):
                    patience = Patience(terms.retry_s)
                    for event in reader.read(part):
                        yield Emit(event)
                else:
                    ended = _make_stream_error(part, terms.service)
            fault = ended
        elif isinstance(outcome, Reply):
            fault, retry_after_s = (
                _make_refusal_error(call, outcome, terms.service),
                outcome.retry_after_s,
            )
            if not may_pass(outcome):
                raise fault
        elif isinstance(outcome, Exception):
            fault = no_answer(outcome, terms.service)
        else:
            raise TypeError("a request has an outcome")
        wait = None if terms.service.is_local else patience.wait_s(retry_after_s)
        if wait is None:
            raise fault
        terms.on_retry(fault, wait)
        yield Sleep(wait)


def _make_stream_error(outcome: object, service: Service) -> ServiceError:
    if isinstance(outcome, Exception):
        return no_answer(outcome, service)  # type: ignore[arg-type] # of a request
    return ServiceUnavailable(f"{service.name} has ended its stream of events")


def _make_refusal_error(call: Call[bytes], reply: Reply, service: Service) -> ServiceError:
    try:
        read_reply(replace(call, accepted=frozenset()), reply, service)
    except ServiceError as error:
        return error
    return ServiceError(f"{service.name} answered {reply.status} in place of a stream")
