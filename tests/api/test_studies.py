"""Studies over HTTP."""

from __future__ import annotations

from typing import Any

import pytest

from tests.api.conftest import Offline
from tests.studies.example_study import study_content

STUDIES = "/api/v1/studies"


@pytest.fixture
def posted(offline: Offline) -> dict[str, Any]:
    """A study whose campaigns wait."""
    answer = offline.client.post(STUDIES, json=study_content())
    assert answer.status_code == 202, answer.text
    study: dict[str, Any] = answer.json()
    assert answer.headers["Location"] == f"{STUDIES}/{study['id']}"
    return study


def test_a_posted_study_queues_its_campaigns(offline: Offline, posted: dict[str, Any]) -> None:
    assert (posted["state"], posted["campaigns"]) == ("queued", {"queued": 16})
    assert posted["is_on_service"]
    assert offline.woken
    listed = offline.client.get(posted["campaigns_url"], params={"limit": 100}).json()["items"]
    assert len(listed) == 16
    assert {one["study_id"] for one in listed} == {posted["id"]}
    assert listed[-1]["cell"] == {
        "scenario": "first",
        "agent": "idm",
        "method": "random",
        "repetition": 1,
    }
    assert all(one["batch_id"] for one in listed)
    one = offline.client.get(f"/api/v1/campaigns/{listed[0]['id']}").json()
    assert one["cell"] == listed[0]["cell"]
    (summary,) = offline.client.get(STUDIES).json()["items"]
    assert (summary["id"], summary["state"]) == (posted["id"], "queued")
    again = offline.client.post(STUDIES, json=posted["document"]).json()
    assert again["document"] == posted["document"]


def test_a_study_is_posted_once_for_each_key(offline: Offline) -> None:
    headers = {"Idempotency-Key": "one"}
    first, second = (
        offline.client.post(STUDIES, json=study_content(), headers=headers).json()["id"]
        for _ in range(2)
    )
    assert first == second
    assert len(offline.client.get("/api/v1/campaigns", params={"limit": 100}).json()["items"]) == 16


def test_a_wrong_study_stores_nothing(offline: Offline) -> None:
    content = study_content()
    content["methods"][1]["name"] = "avfuzzr"
    content["agents"][0]["name"] = "idn"
    answer = offline.client.post(STUDIES, json=content)
    assert answer.status_code == 422
    assert [p["pointer"] for p in answer.json()["problems"]] == [
        "/agents/0/name",
        "/methods/1/name",
    ]
    assert offline.client.get(STUDIES).json()["items"] == []
    assert offline.client.get("/api/v1/campaigns").json()["items"] == []


def test_a_dry_run_counts_and_stores_nothing(offline: Offline) -> None:
    checked = offline.client.post(f"{STUDIES}:validate", json=study_content()).json()
    assert checked["valid"] is True
    parts = ("scenarios", "agents", "methods", "repetitions")
    assert [checked[part] for part in parts] == [2, 2, 2, 2]
    assert (checked["campaigns"], checked["simulations"]) == (16, 16 * 8)
    assert checked["genes"] > 20
    content = study_content()
    content["methods"][1]["name"] = "avfuzzr"
    refused = offline.client.post(f"{STUDIES}:validate", json=content)
    assert refused.status_code == 422
    assert [p["pointer"] for p in refused.json()["problems"]] == ["/methods/1/name"]
    assert offline.client.get(STUDIES).json()["items"] == []


def test_a_study_is_paused_and_resumed(offline: Offline, posted: dict[str, Any]) -> None:
    one = f"{STUDIES}/{posted['id']}"
    paused = offline.client.post(f"{one}:pause").json()
    assert (paused["state"], paused["campaigns"]) == ("paused", {"paused": 16})
    resumed = offline.client.post(f"{one}:resume").json()
    assert (resumed["state"], resumed["campaigns"]) == ("queued", {"queued": 16})
    assert resumed["request"] == ""


def test_a_study_is_cancelled_permanently(offline: Offline, posted: dict[str, Any]) -> None:
    one = f"{STUDIES}/{posted['id']}"
    for _ in range(2):
        answer = offline.client.post(f"{one}:cancel")
        assert answer.status_code == 202
        cancelled = answer.json()
        assert (cancelled["state"], cancelled["campaigns"]) == ("cancelled", {"cancelled": 16})
    for act in ("pause", "resume"):
        refused = offline.client.post(f"{one}:{act}")
        assert refused.status_code == 409
        assert "are over" in refused.json()["detail"]
    assert offline.client.post(f"{STUDIES}/0123:cancel").status_code == 404


def test_what_is_not_there_or_cannot_be_compared_is_refused(
    offline: Offline, posted: dict[str, Any]
) -> None:
    client = offline.client
    assert client.get(f"{STUDIES}/0123").status_code == 404
    assert client.post(f"{STUDIES}/0123:pause").status_code == 404
    assert client.get(f"{STUDIES}/0123/tables/failures").status_code == 404
    refused = client.get(f"{STUDIES}/{posted['id']}/comparison")
    assert refused.status_code == 409
    assert "0 of 16 campaigns have finished" in refused.json()["detail"]
    table = f"{STUDIES}/{posted['id']}/tables/campaigns"
    assert client.get(table, headers={"Accept": "image/png"}).status_code == 406
    answer = client.get(table)
    assert answer.headers["content-type"].startswith("text/csv")
    assert len(answer.text.splitlines()) == 17
    parquet = client.get(table, headers={"Accept": "application/vnd.apache.parquet"})
    assert parquet.content[:4] == parquet.content[-4:] == b"PAR1"
