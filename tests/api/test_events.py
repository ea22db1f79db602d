"""The stream of events, from the application over HTTP."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import anyio
import httpx
import pytest
from sqlalchemy import event as events_of
from starlette.types import Message

from drivora_service.api.answers import event_stream
from drivora_service.api.answers.change_feed import ChangeFeed, feed_of
from drivora_service.api.answers.event_stream import EventStream, Wanted
from drivora_service.api.answers.worker_view import workers_now
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.api.guards.load_guard import MOST_REQUESTS
from drivora_service.store.changes.change_lists import ChangedKind
from drivora_service.store.changes.revisions import Position
from drivora_service.store.runs.run_records import Priority
from tests.api.conftest import MakeOffline, Offline
from tests.api.guards.test_api_tokens import bearer
from tests.api.test_problem_details import is_problem
from tests.store.campaigns.test_campaign_repository import create
from tests.store.samples import claim, finish, finished, new_run, register, submit

EVENTS = "/api/v1/events"
CHANGES = "kind=run&kind=batch&kind=campaign&kind=study"


@dataclass(frozen=True)
class Told:
    """One event, as a browser would see it; a comment has no name."""

    name: str
    id: str
    data: Any


class Reader:
    """Reads a stream event by event."""

    def __init__(self, answer: httpx.Response) -> None:
        self.answer = answer
        self._lines = answer.iter_lines()

    def next(self) -> Told:
        """The next event, or comment."""
        name = position = ""
        data = None
        for line in self._lines:
            key, _, value = line.partition(": ")
            match key:
                case "event":
                    name = value
                case "id":
                    position = value
                case "data":
                    data = json.loads(value)
                case "" if not line:
                    return Told(name, position, data)
        raise EOFError

    def changed(self) -> dict[str, dict[str, Any]]:
        """The objects of the next event, by id."""
        told = self.next()
        assert told.name == "changes", told
        assert told.data["revision"] >= max(change["revision"] for change in told.data["changes"])
        assert told.id.endswith(f".{told.data['revision']}")
        return {change["id"]: change for change in told.data["changes"]}


@contextmanager
def many(offline: Offline) -> Iterator[httpx.Client]:
    """A client that holds hundreds of connections."""
    limits = httpx.Limits(max_connections=1000)
    with httpx.Client(base_url=offline.client.base_url, timeout=30, limits=limits) as client:
        yield client


@contextmanager
def listening(
    offline: Offline, query: str = "", headers: dict[str, str] | None = None
) -> Iterator[Reader]:
    """Opens a stream of changes."""
    if "kind=" not in query and "of=" not in query:
        query = f"{CHANGES}&{query}"
    url = f"{EVENTS}?{query.rstrip('&')}"
    with offline.client.stream("GET", url, headers=headers or {}) as answer:
        assert answer.status_code == 200, answer.read()
        yield Reader(answer)


def test_changes_are_told_as_they_happen_each_object_once_as_it_is_now(offline: Offline) -> None:
    database = offline.context.database
    with listening(offline) as reader:
        head = reader.answer.headers
        assert head["Content-Type"].startswith("text/event-stream")
        assert head["Cache-Control"] == "no-store"
        begin = reader.next()
        assert begin.name == "begin"
        assert begin.id.endswith(f".{begin.data['revision']}")
        runs = submit(database, 3, priority=Priority.CI)
        told = reader.changed()
        assert set(runs) < set(told)
        assert {told[run_id]["status"] for run_id in runs} == {"queued"}
        (batch_id,) = set(told) - set(runs)
        assert (told[batch_id]["kind"], told[batch_id]["status"]) == ("batch", "open")
        assert {told[run_id]["batch_id"] for run_id in runs} == {batch_id}
        claim(database, register(database), 1)
        told = reader.changed()
        assert {told[key]["status"] for key in told if key != batch_id} == {"running"}
        assert len(told) == 2


def test_only_what_is_wanted_is_told(offline: Offline) -> None:
    database = offline.context.database
    with database.write() as transaction:
        wanted = transaction.batches.create(name="a", priority=Priority.CI).id
        study = transaction.studies.create(name="s", document="{}")
    with listening(offline, f"kind=batch&kind=study&of={wanted}") as reader:
        assert reader.next().name == "begin"
        submit(database, 2, priority=Priority.CI)
        create(database)
        with database.write() as transaction:
            transaction.jobs.submit([new_run("{}")], batch_id=wanted)
        assert set(reader.changed()) == {wanted}
    with listening(offline, f"of={study}&after=0") as reader:
        assert reader.next().name == "begin"
        (told,) = reader.changed().values()
        # The same state as that of the study itself.
        assert told["status"] == offline.client.get(f"/api/v1/studies/{study}").json()["state"]


def test_a_client_that_comes_again_is_told_what_it_has_missed(offline: Offline) -> None:
    database = offline.context.database
    owner = register(database)
    with listening(offline) as reader:
        reader.next()
        runs = submit(database, 2, priority=Priority.CI)
        seen = reader.next()
    claim(database, owner, 2)
    finish(database, owner, finished(runs[0]))
    for headers, query in (
        ({"Last-Event-ID": seen.id}, ""),
        ({}, f"after={seen.id}"),
        ({}, f"after={seen.data['revision']}"),
        # A browser repeats its first address.
        ({"Last-Event-ID": seen.id}, "after=0"),
    ):
        with listening(offline, query, headers) as reader:
            begin = reader.next()
            assert (begin.name, begin.data) == ("begin", {"revision": seen.data["revision"]})
            told = reader.changed()
        assert {run_id: told[run_id]["status"] for run_id in runs} == {
            runs[0]: "finished",
            runs[1]: "running",
        }


@pytest.mark.parametrize("last", ["0123456789ab.3", "999999", "what is this?"])
def test_a_position_that_is_not_known_is_said_to_be(offline: Offline, last: str) -> None:
    submit(offline.context.database, 2)
    with listening(offline, headers={"Last-Event-ID": last}) as reader:
        begin, reset = reader.next(), reader.next()
        assert (begin.name, reset.name) == ("begin", "reset")
        assert begin.data == reset.data
        assert begin.id == reset.id != last
        (run_id,) = submit(offline.context.database, 1)
        assert set(reader.changed()) == {run_id}


def test_long_backlogs_come_in_parts_of_500(offline: Offline) -> None:
    database = offline.context.database
    with database.write() as transaction:
        runs = transaction.jobs.submit([new_run("{}")] * 1200)
    with listening(offline, "after=0") as reader:
        reader.next()
        parts = [reader.changed() for _ in range(3)]
    assert [len(part) for part in parts] == [500, 500, 200]
    assert {run_id for part in parts for run_id in part} == set(runs)


def test_silence_is_broken_by_a_comment_with_the_position(
    offline: Offline, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(event_stream, "HEARTBEAT_S", 0.2)
    (run_id,) = submit(offline.context.database, 1)
    with listening(offline, f"of={run_id}") as reader:
        begin = reader.next()
        # What is not told counts for the position, too.
        submit(offline.context.database, 3)
        silent = [reader.next() for _ in range(3)]
    assert {(comment.name, comment.data) for comment in silent} == {("", None)}
    with offline.context.database.read() as transaction:
        assert silent[-1].id == str(transaction.changes.latest()) != begin.id


def test_refusals(offline: Offline) -> None:
    is_problem(offline.client.get(f"{EVENTS}?of=nothing"), 404)
    is_problem(offline.client.get(f"{EVENTS}?of=jobs"), 404)
    is_problem(offline.client.get(f"{EVENTS}?kind=car"), 422)
    is_problem(offline.client.get(f"{EVENTS}?after=yesterday"), 422)
    is_problem(offline.client.get(f"{EVENTS}?since=1"), 422)
    is_problem(offline.client.post(EVENTS), 405)


def test_head_ends(offline: Offline) -> None:
    answer = offline.client.head(EVENTS)
    assert answer.status_code == 200
    assert answer.headers["Content-Type"].startswith("text/event-stream")


@pytest.mark.parametrize("is_silent", [True, False])
def test_a_stream_ends_with_its_token(
    make_offline: MakeOffline, tmp_path: Path, *, is_silent: bool
) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    secret = tokens.create("reader", Scope.READ)
    tokens.create("other", Scope.READ)
    offline = make_offline(tokens=tokens)
    is_problem(offline.client.get(EVENTS), 401)
    with listening(offline, headers=bearer(secret)) as reader:
        assert reader.next().name == "begin"
        (run_id,) = submit(offline.context.database, 1, priority=Priority.CI)
        assert run_id in reader.changed()
        # As another process does it.
        TokenFile(tmp_path / "tokens.json").revoke("reader")
        revoked_at = time.monotonic()
        if not is_silent:
            submit(offline.context.database, 1, priority=Priority.CI)
        with pytest.raises(EOFError):
            reader.next()
        assert time.monotonic() - revoked_at < event_stream.HEARTBEAT_S / 3


def test_streams_are_bounded_and_their_places_are_given_back(offline: Offline) -> None:
    context = offline.context
    offline.app.state.changes = ChangeFeed(
        lambda: context.database,
        context.revision,
        lambda *_: "",
        partial(workers_now, context),
        most=2,
    )
    with listening(offline), listening(offline):
        details = is_problem(refused := offline.client.get(EVENTS), 503)
        assert "2 streams of events are open" in details["detail"]
        assert int(refused.headers["Retry-After"]) > 0
    until = time.monotonic() + 10.0
    while (answer := offline.client.head(EVENTS)).is_error or feed_of(offline.app)._streams:
        assert time.monotonic() < until, answer
    with listening(offline), listening(offline):
        pass


def test_streams_are_not_counted_as_requests(offline: Offline) -> None:
    """Else many readers would keep others from asking."""
    assert MOST_REQUESTS == 256
    with ExitStack() as stack:
        client = stack.enter_context(many(offline))
        for _ in range(MOST_REQUESTS):
            stack.enter_context(client.stream("GET", EVENTS))
        assert offline.client.get("/api/v1/jobs").status_code == 200
        is_problem(client.get(EVENTS), 503)


def test_a_hundred_readers_are_served_by_one_look_at_the_database(offline: Offline) -> None:
    database = offline.context.database
    looks: list[str] = []

    def note(_: object, __: object, statement: str, *___: object) -> None:
        is_query = statement.startswith("SELECT")
        if is_query and threading.current_thread().name.startswith("events"):
            looks.append(statement)

    with ExitStack() as stack:
        client = stack.enter_context(many(offline))
        readers = [
            Reader(stack.enter_context(client.stream("GET", f"{EVENTS}?{CHANGES}")))
            for _ in range(100)
        ]
        for reader in readers:
            assert reader.next().name == "begin"
        events_of.listen(database.engine, "before_cursor_execute", note)
        for number in range(5):
            runs = submit(database, 40)
            assert all(set(reader.changed()) == set(runs) for reader in readers), number
        # One query for the count, and one for each kind of objects.
        assert 0 < len(looks) <= 5 * 5
        looks.clear()
        time.sleep(0.5)
        assert looks == [], "nothing changes, and nothing is read"
        events_of.remove(database.engine, "before_cursor_execute", note)


def test_a_reader_that_is_slow_gets_what_is_then_and_nothing_is_kept_for_it(
    offline: Offline,
) -> None:
    database = offline.context.database
    sent: list[bytes] = []

    async def scenario() -> None:
        feed = feed_of(offline.app)
        feed.join()
        begin = await feed.read(lambda transaction: transaction.changes.latest())
        wanted = Wanted(
            kinds=frozenset(ChangedKind),
            tells_workers=False,
            of="",
            begin=begin,
            is_reset=False,
        )
        stream = EventStream(feed, wanted, lambda: True)
        is_reading = anyio.Event()

        async def send(message: Message) -> None:
            if message["type"] == "http.response.body":
                sent.append(message["body"])
                await is_reading.wait()

        async def receive() -> Message:
            await anyio.sleep_forever()
            raise AssertionError

        async with anyio.create_task_group() as tasks:
            scope = {"type": "http", "asgi": {"spec_version": "2.3"}}
            tasks.start_soon(stream, scope, receive, send)
            run_ids = await anyio.to_thread.run_sync(submit, database, 1)
            owner = await anyio.to_thread.run_sync(register, database)
            for _ in range(50):
                # The run is taken, and given back.
                await anyio.to_thread.run_sync(claim, database, owner, 1)
                await anyio.to_thread.run_sync(give_back, owner, run_ids[0])
                await anyio.sleep(0.02)
            assert len(sent) == 1, "only the beginning, which it has not taken"
            is_reading.set()
            while len(sent) < 2:
                await anyio.sleep(0.01)
            tasks.cancel_scope.cancel()

    def give_back(owner: str, run_id: str) -> None:
        with database.write() as transaction:
            transaction.queue.release(owner, [run_id])

    anyio.run(scenario)
    assert sent[0].startswith(b"event: begin")
    assert sent[1].count(b'"kind":"run"') == 1
    assert b'"status":"queued"' in sent[1]


def test_streams_go_on_after_the_database_could_not_be_read(
    offline: Offline, monkeypatch: pytest.MonkeyPatch
) -> None:
    database = offline.context.database
    with listening(offline) as reader:
        reader.next()
        file = Path(database.engine.url.database or "")
        hidden = file.with_suffix(".hidden")
        database.engine.dispose()
        file.rename(hidden)
        file.mkdir()
        time.sleep(0.5)
        file.rmdir()
        hidden.rename(file)
        (run_id,) = submit(database, 1)
        assert set(reader.changed()) == {run_id}


def test_the_documentation_names_the_schemas_of_the_events(offline: Offline) -> None:
    document = offline.client.get("/api/v1/openapi.json").json()
    content = document["paths"][EVENTS]["get"]["responses"]["200"]["content"]["text/event-stream"]
    for name, reference in content["x-events"].items():
        schema = document["components"]["schemas"][reference["$ref"].rpartition("/")[2]]
        assert all(part["description"] for part in schema["properties"].values()), name
    assert set(content["x-events"]) == {"begin", "changes", "reset", "workers"}


def test_no_position_is_told_twice_in_one_epoch(offline: Offline) -> None:
    with listening(offline, "kind=run") as reader:
        ids = [reader.next().id]
        for _ in range(3):
            submit(offline.context.database, 1)
            ids.append(reader.next().id)
    assert len(set(ids)) == 4
    assert all(Position(epoch=i.split(".")[0], revision=int(i.split(".")[1])) for i in ids)
