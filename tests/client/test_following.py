"""Following a batch or a campaign, against a model of a service that answers in no time."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any
from urllib.parse import parse_qs, urlencode

import httpx
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.api.documentation.recorded_examples import FINISHED_CAMPAIGN, read_recorded
from drivora_service.api.schemas.batches import Batch
from drivora_service.api.schemas.campaigns import Campaign
from drivora_service.client.connecting import ignore_retry
from drivora_service.client.flows import Emit, Listen, Receive, Request, Sleep, Terms
from drivora_service.client.following import watch_batch, watch_campaign
from drivora_service.client.replies import Reply, Service
from drivora_service.store.campaigns.campaign_records import CampaignState
from tests.client.examples import BATCH, JOB

TERMS = Terms(
    service=Service(url="http://127.0.0.1", is_local=False), retry_s=0.0, on_retry=ignore_retry
)
READY = {"ready": True, "checks": [{"name": "workers", "ok": True, "detail": ""}]}


class Model:
    """A service with one batch, whose runs end in any order.

    Attributes:
        requests: Paths that were asked for.
    """

    def __init__(self, size: int, page: int, ends: Iterator[int], rng: random.Random) -> None:
        self.statuses = ["queued"] * size
        self.page, self.ends, self.rng = page, ends, rng
        self.requests: list[str] = []

    def go_on(self) -> None:
        """Ends some runs; at last one at a time."""
        waiting = [n for n, status in enumerate(self.statuses) if status == "queued"]
        for number in self.rng.sample(waiting, min(len(waiting), next(self.ends, 1))):
            self.statuses[number] = self.rng.choice(["finished", "cancelled", "timed_out"])

    def answer(self, path: str, query: dict[str, list[str]]) -> Any:
        self.requests.append(path)
        last = path.rpartition("/")[2]
        if path == "/readyz":
            return READY
        if path == "/api/v1/batches/b":
            self.go_on()
            counts = {status: self.statuses.count(status) for status in set(self.statuses)}
            return {**BATCH, "size": len(self.statuses), "counts": counts}
        if path == "/api/v1/jobs":
            self.go_on()
            assert query["batch"] == ["b"]
            ended = [n for n, s in enumerate(self.statuses) if s in query["status"]][::-1]
            place = int(query.get("page_token", ["0"])[0])
            token = str(place + self.page) if place + self.page < len(ended) else ""
            items = [self.job(number) for number in ended[place : place + self.page]]
            return {"items": items, "next_page_token": token}
        assert path == f"/api/v1/runs/{last}"
        return {**self.job(int(last)), "observations_url": "", "scenario_url": ""}

    def job(self, number: int) -> dict[str, Any]:
        return {**JOB, "id": str(number), "item": number, "status": self.statuses[number]}


def performed(
    flow: Any, answer: Callable[[str, dict[str, list[str]]], Any], *, most: int = 10_000
) -> tuple[list[Any], list[float], Any]:
    """Performs a flow; returns what it handed out, how long it would have slept, its result."""
    emitted: list[Any] = []
    slept: list[float] = []
    outcome = None
    for _ in range(most):
        try:
            step = flow.send(outcome)
        except StopIteration as end:
            return emitted, slept, end.value
        outcome = None
        if isinstance(step, Emit):
            emitted.append(step.value)
        elif isinstance(step, Request):
            query = parse_qs(urlencode(step.call.parameters))
            value = answer(step.call.path, query)
            content = value if isinstance(value, bytes) else json.dumps(value).encode()
            headers = httpx.Headers({"Retry-After": "2"})
            outcome = Reply(status=200, headers=headers, content=content)
        elif isinstance(step, Listen):
            # An older service: there are no events.
            outcome = Reply(status=404, headers=httpx.Headers(), content=b"")
        else:
            slept.append(step.seconds)
    raise AssertionError("it did not end")


@given(
    size=st.integers(0, 30),
    page=st.integers(1, 7),
    ends=st.lists(st.integers(0, 8), max_size=40),
    seed=st.integers(0, 1000),
)
def test_every_run_of_a_batch_comes_once(size: int, page: int, ends: list[int], seed: int) -> None:
    model = Model(size, page, iter(ends), random.Random(seed))
    seen: list[Batch] = []
    runs, slept, _ = performed(watch_batch("b", TERMS, seen.append), model.answer)
    assert sorted(run.item for run in runs) == list(range(size))
    assert "queued" not in {run.status for run in runs}
    assert seen[-1].done
    assert all(0.1 <= seconds <= 2.0 for seconds in slept)
    assert len(slept) == len(seen) - 1


def test_what_has_ended_before_is_not_listed_again() -> None:
    """Runs end in the order of their items, one between two looks."""
    size, page = 100, 5
    model = Model(size, page, iter(()), random.Random(0))

    def end_the_next() -> None:
        if "queued" in model.statuses:
            model.statuses[model.statuses.index("queued")] = "finished"

    model.go_on = end_the_next  # type: ignore[method-assign] # another order
    runs, _, _ = performed(watch_batch("b", TERMS, lambda _: None), model.answer)
    assert len(runs) == size
    assert model.requests.count("/api/v1/jobs") <= model.requests.count("/api/v1/batches/b")


def test_looks_become_rare_while_nothing_happens_and_frequent_again() -> None:
    batch: dict[str, Any] = {**BATCH, "size": 2, "counts": {"queued": 2}}
    looks = 0

    def answer(path: str, _: dict[str, list[str]]) -> Any:
        nonlocal looks
        if path == "/readyz":
            return READY
        if path == "/api/v1/batches/b":
            looks += 1
            if looks == 15:
                batch["counts"] = {"queued": 1, "running": 1}
            if looks == 17:
                batch["counts"] = {}
                batch["size"] = 0
            return batch
        raise AssertionError(path)

    _, slept, _ = performed(watch_batch("b", TERMS, lambda _: None), answer)
    assert slept[0] < 0.2
    assert slept[13] == 2.0
    assert slept[14] < 0.2


def test_an_application_in_this_process_is_looked_at_more_often() -> None:
    batch: dict[str, Any] = {**BATCH, "size": 1, "counts": {"running": 1}}
    looks = 0

    def answer(path: str, _: dict[str, list[str]]) -> Any:
        nonlocal looks
        if path == "/readyz":
            return READY
        looks += 1
        if looks == 20:
            batch["counts"], batch["size"] = {}, 0
        return batch

    terms = replace(TERMS, service=replace(TERMS.service, is_local=True))
    _, slept, _ = performed(watch_batch("b", terms, lambda _: None), answer)
    assert len(slept) == 19
    # Hardly any time passes here between two looks.
    assert all(0.05 <= seconds < 0.1 for seconds in slept)


def test_a_campaign_is_followed_until_it_rests() -> None:
    states = iter(
        [CampaignState.QUEUED, *[CampaignState.RUNNING] * 3, CampaignState.FAILED],
    )
    asked: list[str] = []

    def answer(path: str, _: dict[str, list[str]]) -> Any:
        asked.append(path)
        if path == "/readyz":
            return READY
        value = read_recorded(FINISHED_CAMPAIGN)
        return {**value, "state": next(states)}

    seen: list[Campaign] = []
    _, slept, ended = performed(watch_campaign("c", TERMS, seen.append), answer)
    assert ended.state is CampaignState.FAILED
    assert [one.state.value for one in seen] == ["queued", *["running"] * 3, "failed"]
    assert asked.count("/readyz") == 2
    assert len(slept) == 4


def followed(*parts: bytes | None) -> tuple[list[Any], list[str]]:
    """Follows a batch of a service that tells these parts of events; it is done at the last look.

    Returns the steps by their names, and the positions after which the client listened.
    """
    steps: list[Any] = []
    positions: list[str] = []
    coming = iter(parts)
    batch: dict[str, Any] = {**BATCH, "size": 1, "counts": {"running": 1}}
    flow: Any = watch_batch("b", TERMS, lambda _: None)
    outcome: Any = None
    left = len(parts)
    while True:
        try:
            step = flow.send(outcome)
        except StopIteration:
            return steps, positions
        outcome = None
        if isinstance(step, Listen):
            steps.append("listen")
            assert ("of", "b") in step.call.parameters
            positions.append(step.headers.get("Last-Event-ID", ""))
            outcome = Reply(status=200, headers=httpx.Headers(), content=b"")
        elif isinstance(step, Receive):
            steps.append("receive")
            outcome = next(coming)
            left -= 1
            if not left:
                batch |= {"size": 0, "counts": {}}
        elif isinstance(step, Sleep):
            steps.append("sleep")
            assert step.seconds <= 2.0
        else:
            steps.append(step.call.path.rpartition("/")[2])
            value = READY if step.call.path == "/readyz" else batch
            outcome = Reply(status=200, headers=httpx.Headers(), content=json.dumps(value).encode())


CHANGE = (
    b'event: changes\nid: ab.2\ndata: {"revision":2,"changes":[{"kind":"batch","id":"b",'
    b'"status":"open","revision":2,"batch_id":"b","campaign_id":"","study_id":""}]}\n\n'
)


def workers(*faults: str) -> bytes:
    told = {
        "slots": [],
        "queue": [],
        "ended_last_minute": 0,
        "ended_last_hour": 0,
        "faults": [{"name": name, "detail": "?"} for name in faults],
    }
    return b"event: workers\nid: ab.1\ndata: " + json.dumps(told).encode() + b"\n\n"


def test_a_batch_is_looked_at_when_it_changes_and_not_before() -> None:
    begin = b'event: begin\nid: ab.1\ndata: {"revision":1}\n\n'
    steps, _ = followed(begin, workers(), workers("campaigns"), CHANGE[:9], CHANGE[9:])
    # It listens before it looks, so that no change is between the two.
    assert [step for step in steps if step != "sleep"] == [
        "listen",
        "b",
        *["receive"] * 5,
        "b",
    ]


def test_silence_a_reset_and_workers_that_cannot_begin_are_reasons_to_look() -> None:
    reset = b'event: reset\nid: ab.9\ndata: {"revision":9}\n\n'
    for part in (b": heartbeat\nid: ab.7\n\n", reset, workers("workers")):
        steps, _ = followed(part, CHANGE)
        looks = [step for step in steps if step not in ("sleep", "readyz")]
        assert looks == ["listen", "b", "receive", "b", "receive", "b"]
        # Nothing has changed, so that a fault may be the reason.
        assert steps.count("readyz") == 1


def test_a_stream_that_breaks_off_is_listened_to_again_after_its_last_position() -> None:
    steps, positions = followed(CHANGE, None, CHANGE)
    assert [step for step in steps if step not in ("sleep", "readyz")] == [
        "listen",
        "b",
        "receive",
        "b",
        "receive",
        "b",
        "listen",
        "b",
        "receive",
        "b",
    ]
    assert positions == ["", "ab.2"]
