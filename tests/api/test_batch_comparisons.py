"""Two batches compared over HTTP, with results that were made up."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.runs.run_report import RunStatus
from tests.api.conftest import Offline
from tests.api.test_problem_details import is_problem
from tests.store.samples import claim, finish, finished, register

COMPARE = "/api/v1/batches:compare"


def batch(offline: Offline, name: str, agent: str, fails: list[str], **posted_with: str) -> str:
    """A batch of labelled scenarios, each violating an oracle at fault or "" none."""
    items = [
        {"label": f"s{n}", "scenario": {**copy.deepcopy(SCENARIO), "max_sim_time": 60.0 + n}}
        for n in range(len(fails))
    ]
    parameters = {"name": name, "agent": agent, **posted_with}
    posted = offline.client.post("/api/v1/batches", json=items, params=parameters)
    assert posted.status_code == 202, posted.text
    database = offline.context.database
    owner = register(database)
    claimed = claim(database, owner, len(fails))
    assert len(claimed) == len(fails)
    for run_id, oracle in zip(claimed, fails, strict=True):
        (report,) = finish(database, owner, finished(run_id, *filter(None, [oracle])))
        assert report.status is RunStatus.FINISHED
    batch_id: str = posted.json()["batch"]["id"]
    return batch_id


@pytest.fixture
def both(offline: Offline) -> tuple[str, str]:
    """Batches of eight scenarios; B repairs six failures of A."""
    a = batch(offline, "nightly", "idm", ["collision"] * 6 + ["red_light", ""])
    return a, batch(offline, "candidate", "sumo-krauss", [""] * 6 + ["red_light", ""])


def test_batches_are_compared_by_id_or_name(offline: Offline, both: tuple[str, str]) -> None:
    answer = offline.client.get(COMPARE, params={"a": both[0], "b": both[1]})
    assert answer.status_code == 200, answer.text
    found = answer.json()
    assert found["sentence"] == (
        "B (sumo-krauss) fails in none of 8 scenarios in which A (idm) does not, and A in 6 in "
        "which B does not (p 0.031, McNemar's exact test): B fails less."
    )
    table = found["failures"]
    assert (table["a_only"], table["b_only"], table["both"], table["neither"]) == (6, 0, 1, 1)
    assert [row["oracle"] for row in found["by_oracle"]] == ["collision", "red_light"]
    assert [pair["scenario"] for pair in found["pairs"]] == [f"s{n}" for n in range(8)]
    assert found["pairs"][0]["a"]["failures"][0]["sentence"].startswith("collision, on tee-town")
    assert (found["a"]["name"], found["b"]["agents"]) == ("nightly", ["sumo-krauss"])
    named = offline.client.get(COMPARE, params={"a": "nightly", "b": "candidate"})
    assert named.json() == found
    known = {"If-None-Match": answer.headers["ETag"]}
    again = offline.client.get(COMPARE, params={"a": both[0], "b": both[1]}, headers=known)
    assert again.status_code == 304


def test_the_newest_batch_of_a_name_is_compared(offline: Offline, both: tuple[str, str]) -> None:
    newer = batch(offline, "nightly", "idm", [""])
    found = offline.client.get(COMPARE, params={"a": "nightly", "b": both[1]}).json()
    assert found["a"]["batch"] == newer
    assert (found["scenarios"], len(found["left_out"])) == (1, 7)
    assert {one["reason"] for one in found["left_out"]} == {"only_b"}


def test_oracles_alone_leave_what_counts_of_the_runs(offline: Offline) -> None:
    a, b = (batch(offline, name, "idm", ["collision"], counts="any") for name in ("old", "new"))
    found = offline.client.get(COMPARE, params={"a": a, "b": b, "oracle": "collision"}).json()
    assert (found["definition"]["counts"], found["definition"]["oracles"]) == ("any", ["collision"])
    other = batch(offline, "other", "idm", ["collision"])
    mixed = offline.client.get(COMPARE, params={"a": a, "b": other, "oracle": "collision"}).json()
    assert mixed["definition"]["counts"] == "accountable"
    assert any("different `counts` (accountable, any)" in note for note in mixed["notes"])


def test_what_counts_is_chosen(offline: Offline, both: tuple[str, str]) -> None:
    wanted: dict[str, Any] = {"a": both[0], "b": both[1]}
    red = offline.client.get(COMPARE, params={**wanted, "oracle": "red_light"}).json()
    assert (red["failures"]["both"], red["failures"]["a_only"]) == (1, 0)
    assert red["definition"]["oracles"] == ["red_light"]
    assert red["definition"]["origin"] == "request"
    posted = offline.client.get(COMPARE, params=wanted).json()["definition"]
    assert (posted["counts"], posted["origin"]) == ("accountable", "default")
    metric = offline.client.get(COMPARE, params={**wanted, "metric": ["speed", "gap"]}).json()
    assert [row["metric"] for row in metric["metrics"]] == ["speed", "gap"]
    assert metric["pairs"][0]["a"]["metrics"] == {"speed": 3.0, "gap": None}
    assert metric["metrics"][1]["not_measurable"] == 8


def test_what_cannot_be_compared_is_refused(offline: Offline, both: tuple[str, str]) -> None:
    def refused(status: int, **changes: str) -> str:
        parameters = {"a": both[0], "b": both[1], **changes}
        detail: str = is_problem(offline.client.get(COMPARE, params=parameters), status)["detail"]
        return detail

    assert "unknown batch 'nobody'" in refused(404, b="nobody")
    assert "unknown batch ''" in refused(404, a="")
    # The runs that were posted singly are in a batch that is never shown.
    assert "unknown batch 'jobs'" in refused(404, a="jobs")
    assert "unknown metric 'beauty'" in refused(404, metric="beauty")
    assert "unknown oracle 'luck'" in refused(404, oracle="luck")
    refused(422, counts="some")
    is_problem(offline.client.get(COMPARE, params={"a": both[0]}), 422)


def test_runs_that_wait_are_left_out_and_named(offline: Offline, both: tuple[str, str]) -> None:
    items = [{"label": "s0", "scenario": {**copy.deepcopy(SCENARIO), "max_sim_time": 60.0}}]
    waits = offline.client.post("/api/v1/batches", json=items).json()["batch"]["id"]
    found = offline.client.get(COMPARE, params={"a": both[0], "b": waits}).json()
    assert found["pairs"] == []
    assert found["sentence"].startswith("Nothing is compared")
    assert found["left_out"][-1]["message"] == "B: queued"
    assert found["failures"]["difference"] is None
