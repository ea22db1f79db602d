"""Minimisations over HTTP."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.client import Client
from drivora_service.store.changes.change_lists import ChangedKind
from tests.api.conftest import MakeOffline, Offline, wait_until_final
from tests.api.guards.test_api_tokens import bearer
from tests.store.samples import claim, finish, finished, register
from tests.suites.minimization.crowded_crash import ONLY_NEEDED, crowded_crash

MINIMIZATIONS = "/api/v1/minimizations"


def failed_run(
    offline: Offline,
    *violated: str,
    town: str = "tee-town",
    headers: dict[str, str] | None = None,
) -> str:
    """A run with violations, as a worker would have judged it."""
    scenario = {**SCENARIO, "map_region": {"town": town}}
    posted = offline.client.post("/api/v1/jobs", json=scenario, headers=headers)
    run: str = posted.json()["id"]
    database = offline.context.database
    owner = register(database)
    assert claim(database, owner, 1) == (run,)
    finish(database, owner, finished(run, *violated))
    return run


def address(run: str) -> str:
    return f"/api/v1/runs/{run}:minimize"


def test_a_minimisation_is_queued_with_what_is_followed(offline: Offline) -> None:
    run = failed_run(offline, "red_light", "collision")
    offline.woken.clear()
    answer = offline.client.post(address(run))
    assert answer.status_code == 202, answer.text
    one = answer.json()
    assert answer.headers["Location"] == f"{MINIMIZATIONS}/{one['id']}"
    assert float(answer.headers["Retry-After"]) > 0
    assert (one["state"], one["run_id"], one["budget"]) == ("queued", run, 500)
    assert one["failure"] == {
        "oracle": "collision",
        "ego": "ego",
        "accountability": "avoidable",
        "counterpart_role": "",
        "location": None,
        "radius_m": 10.0,
    }
    assert offline.woken
    again = offline.client.get(answer.headers["Location"])
    assert again.json() == one
    assert "Retry-After" in again.headers
    (listed,) = offline.client.get(MINIMIZATIONS, params={"run": run}).json()["items"]
    assert listed["id"] == one["id"]
    assert offline.client.get(MINIMIZATIONS, params={"run": "0"}).json()["items"] == []
    batch = offline.client.get(one["batch_url"]).json()
    assert (batch["size"], batch["priority"]) == (0, "ci")


def test_the_user_names_what_is_followed(offline: Offline) -> None:
    run = failed_run(offline, "red_light", "collision")
    wanted = {"oracle": "red_light", "radius_m": 2.5, "budget": 7}
    one = offline.client.post(address(run), json=wanted).json()
    assert (one["failure"]["oracle"], one["failure"]["radius_m"]) == ("red_light", 2.5)
    assert one["budget"] == 7


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({"budget": 0}, "/budget"),
        ({"radius_m": -1.0}, "/radius_m"),
        ({"radius": 3.0}, "/radius"),
        ([], ""),
    ],
)
def test_a_wrong_request_is_refused(offline: Offline, body: Any, pointer: str) -> None:
    run = failed_run(offline, "collision")
    answer = offline.client.post(address(run), json=body)
    assert answer.status_code == 422, answer.text
    assert [problem["pointer"] for problem in answer.json()["problems"]] == [pointer]
    assert offline.client.get(MINIMIZATIONS).json()["items"] == []


def test_what_cannot_be_minimised(offline: Offline) -> None:
    clean = failed_run(offline)
    failing = failed_run(offline, "collision")
    queued = offline.client.post("/api/v1/jobs", json=SCENARIO).json()["id"]
    for run, body, said in (
        (clean, {}, "no violation to follow"),
        (failing, {"oracle": "red_light"}, "does not violate red_light; it violates collision"),
        (queued, {}, "is queued and has no verdicts"),
    ):
        answer = offline.client.post(address(run), json=body)
        assert answer.status_code == 409
        assert said in answer.json()["detail"]
    assert offline.client.post(address("0" * 24)).status_code == 404
    assert offline.client.get(f"{MINIMIZATIONS}/{'0' * 24}").status_code == 404


def test_one_is_started_once_for_each_key(offline: Offline) -> None:
    run = failed_run(offline, "collision")
    headers = {"Idempotency-Key": "one"}
    answers = [offline.client.post(address(run), headers=headers) for _ in range(2)]
    assert answers[0].json() == answers[1].json()
    assert answers[1].headers["Idempotency-Replayed"] == "true"
    other = offline.client.post(address(run), json={"budget": 3}, headers=headers)
    assert other.status_code == 422
    assert len(offline.client.get(MINIMIZATIONS).json()["items"]) == 1


def test_a_cancelled_one_stays_so(offline: Offline) -> None:
    run = failed_run(offline, "collision")
    one = offline.client.post(address(run)).json()
    for _ in range(2):
        answer = offline.client.post(f"{MINIMIZATIONS}/{one['id']}:cancel")
        assert (answer.status_code, answer.json()["state"]) == (202, "cancelled")
    found = offline.client.get(f"{MINIMIZATIONS}/{one['id']}")
    assert found.json()["ended_at"] is not None
    assert "Retry-After" not in found.headers


def test_scopes(make_offline: MakeOffline, tmp_path: Path) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    viewer = bearer(tokens.create("viewer", Scope.READ))
    sender = bearer(tokens.create("sender", Scope.SUBMIT))
    offline = make_offline(tokens=tokens)
    run = failed_run(offline, "collision", headers=sender)
    assert offline.client.post(address(run)).status_code == 401
    assert offline.client.post(address(run), headers=viewer).status_code == 403
    one = offline.client.post(address(run), headers=sender).json()
    assert offline.client.get(MINIMIZATIONS, headers=viewer).status_code == 200
    cancel = f"{MINIMIZATIONS}/{one['id']}:cancel"
    assert offline.client.post(cancel, headers=viewer).status_code == 403
    assert offline.client.post(cancel, headers=sender).status_code == 202


@pytest.mark.slow(seconds=20)
def test_a_service_minimises_a_run(http: httpx.Client, service_url: str) -> None:
    """From the posted scenario to the smallest one, with events on the way."""
    posted = http.post("/api/v1/jobs", json=crowded_crash()).json()
    job = wait_until_final(http, posted["id"])
    assert job["status"] == "finished"
    begin = http.get(f"/api/v1/runs/{job['id']}").json()["revision"]
    with Client(service_url) as client:
        one = client.minimize(job["id"], oracle="collision")
        seen: list[int] = []
        done = client.wait_for_minimization(
            one.id, on_progress=lambda now: seen.append(now.decided)
        )
        assert (done.state, done.message, done.one_minimal) == ("finished", "", True)
        assert seen == sorted(seen)
        assert len(set(seen)) > 2
        assert done.document is not None
        actors = {
            actor["id"]
            for key in ("ego_vehicles", "npc_vehicles", "npc_walkers", "npc_obstacles")
            for actor in done.document.get(key, ())
        }
        assert actors == ONLY_NEEDED
        assert done.before is not None
        assert done.after is not None
        assert (done.before.actors, done.after.actors) == (4, 2)
        assert done.after.route_m < done.before.route_m
        minimal = client.run(done.minimal_run_id)
        assert done.failure.find_in(minimal.verdicts)
        assert minimal.observations_url
        assert client.run(done.reproduction_run_id).observations_url
        batch = client.batch(done.batch_id)
        assert batch.size == done.simulations == sum(batch.counts.values())
        for event in client.events([ChangedKind.MINIMIZATION], of=one.id, after=str(begin)):
            changes = getattr(event.data, "changes", ())
            if changes:
                assert {change.id for change in changes} == {one.id}
                assert changes[0].status == "finished"
                assert changes[0].batch_id == done.batch_id
                break
