"""Events in the client: reading them, and going on where a stream breaks off."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import pytest

from drivora_service.api.schemas.events import Begin, Changes, Reset
from drivora_service.client import Client
from drivora_service.client.listening import EventReader
from drivora_service.client.replies import Service
from drivora_service.errors import NotFound, ServiceError
from drivora_service.store.changes.change_lists import ChangedKind
from drivora_service.store.runs.run_records import JobFilter

SERVICE = Service(url="http://service", is_local=False)
STREAM = (
    b': a comment\n\nevent: begin\nid: ab.1\ndata: {"revision":1}\n\n'
    b"event: unknown\nid: ab.2\ndata: {}\n\n: heartbeat\nid: ab.3\n\n"
    b'event: reset\r\nid: ab.4\r\ndata: {"revision":4,\r\ndata: "more": 1}\r\n\r\n'
)


@pytest.mark.parametrize("size", [1, 7, 1000])
def test_events_are_read_from_parts_of_any_size(size: int) -> None:
    reader = EventReader("", SERVICE)
    events = [
        event
        for start in range(0, len(STREAM), size)
        for event in reader.read(STREAM[start : start + size])
    ]
    assert [(event.id, event.data) for event in events] == [
        ("ab.1", Begin(revision=1)),
        ("ab.4", Reset(revision=4)),
    ]
    assert reader.last_id == "ab.4"
    list(reader.read(b"event: begin\nda"))
    reader.restart()
    assert list(reader.read(b"\n")) == []


def test_the_position_is_that_of_the_last_heartbeat() -> None:
    reader = EventReader("ab.1", SERVICE)
    assert list(reader.read(b": heartbeat\nid: ab.9\n\n")) == []
    assert reader.last_id == "ab.9"


def test_an_event_of_another_form_is_an_error() -> None:
    with pytest.raises(ServiceError, match="cannot be read"):
        list(EventReader("", SERVICE).read(b'event: begin\ndata: {"revision":"x"}\n\n'))


def test_a_client_is_told_what_changes(client: Client, scenario: dict[str, Any]) -> None:
    batch = client.post_batch([scenario] * 2).batch
    events = client.events([ChangedKind.RUN], of=batch.id, after="0")
    first = next(events)
    assert first.data == Begin(revision=0)
    statuses: dict[str, list[str]] = {}
    last = first
    while len([1 for seen in statuses.values() if seen[-1] == "finished"]) < 2:
        last = next(events)
        assert isinstance(last.data, Changes)
        for change in last.data.changes:
            assert (change.kind, change.batch_id) == (ChangedKind.RUN, batch.id)
            statuses.setdefault(change.id, []).append(change.status)
    with pytest.raises(NotFound, match="nothing"):
        next(client.events(of="nothing"))
    # From there on, nothing has changed.
    other = client.events(of=batch.id, after=last.id)
    assert next(other).id == last.id
    for stream in (events, other):
        assert isinstance(stream, Generator)
        stream.close()
    assert len(tuple(client.jobs(JobFilter(batch_id=batch.id)))) == 2
