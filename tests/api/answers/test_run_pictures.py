"""Pictures of runs over HTTP."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import httpx
import pytest

from drivora_service.api.answers.recorded_frames import PARQUET
from drivora_service.api.answers.run_pictures import Pictures
from drivora_service.api.problem_details import ApiError
from drivora_service.errors import TraceDamaged
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace_files.stored_trace import StoredTrace
from tests.api.conftest import Offline
from tests.api.test_campaigns import finished as finished  # a fixture
from tests.api.test_found_failures import crashed as crashed  # a fixture
from tests.api.test_problem_details import is_problem

Json = dict[str, Any]


def test_a_run_is_drawn_as_its_moments(http: httpx.Client, crashed: Json) -> None:
    url = f"/api/v1/runs/{crashed['id']}/picture"
    answer = http.get(url)
    assert answer.status_code == 200, answer.text
    assert answer.headers["Content-Type"] == "image/svg+xml"
    root = ElementTree.fromstring(answer.text)
    assert root.tag.endswith("svg")
    few = http.get(url, params={"moments": 2})
    assert width(few.text) < width(answer.text)
    assert few.headers["ETag"] != answer.headers["ETag"]
    known = {"If-None-Match": answer.headers["ETag"]}
    assert http.get(url, headers=known).status_code == 304
    assert http.get(url).content == answer.content
    is_problem(http.get(url, params={"moments": 1}), 422)


def width(svg: str) -> float:
    root = ElementTree.fromstring(svg)
    return float(root.attrib["width"].removesuffix("pt"))


def test_a_failure_names_the_address_of_its_picture(
    http: httpx.Client, crashed: Json, finished: Json
) -> None:
    wanted = {"oracle": "collision", "since": crashed["created_at"], "agent": "scripted"}
    (failure, *_) = http.get("/api/v1/failures", params=wanted).json()["items"]
    verdict = failure["verdict"]
    assert failure["picture_url"] == (
        f"/api/v1/runs/{crashed['id']}/picture?oracle=collision&ego={verdict['ego']}"
        f"&step={verdict['step']}"
    )
    assert http.get(failure["picture_url"]).status_code == 200
    found = http.get("/api/v1/failures", params={"campaign": finished["id"]}).json()["items"]
    recorded = next(one for one in found if one["is_recorded"])
    answer = http.get(recorded["picture_url"])
    assert answer.status_code == 200, answer.text
    assert width(answer.text) > 0.0


def test_a_picture_leads_to_the_violation_that_is_asked_for(
    http: httpx.Client, crashed: Json
) -> None:
    url = f"/api/v1/runs/{crashed['id']}/picture"
    gravest = http.get(url)
    shown = {}
    for verdict in crashed["verdicts"]:
        if verdict["outcome"] == "violated":
            asked = {name: verdict[name] for name in ("oracle", "ego", "step")}
            answer = http.get(url, params=asked)
            assert answer.status_code == 200, answer.text
            shown[verdict["oracle"]] = answer
            assert answer.headers["ETag"] != gravest.headers["ETag"]
    assert shown["collision"].text == gravest.text
    assert any(answer.text != gravest.text for answer in shown.values())
    problem = http.get(url, params={"oracle": "red_light"})
    is_problem(problem, 404)
    assert "red_light" in problem.json()["detail"]


def test_without_a_recording_there_is_no_picture(
    offline: Offline, http: httpx.Client, finished: Json, scenario: Json
) -> None:
    waiting = offline.client.post("/api/v1/jobs", json=scenario).json()["id"]
    is_problem(offline.client.get(f"/api/v1/runs/{waiting}/picture"), 404)
    is_problem(offline.client.get("/api/v1/runs/none/picture"), 404)
    evaluations = http.get(f"{finished['evaluations_url']}?violating=false").json()["items"]
    passed = next(one for one in evaluations if one["status"] == "judged")
    url = f"/api/v1/campaigns/{finished['id']}/evaluations/{passed['number']}/picture"
    is_problem(http.get(url), 404)


def test_few_requests_wait_and_pictures_are_kept_within_bounds(
    http: httpx.Client, crashed: Json, tmp_path: Path
) -> None:
    network = NetworkCatalogue(shipped_networks()).get("tee-town")
    recorded = http.get(
        f"/api/v1/runs/{crashed['id']}/observations", headers={"Accept": PARQUET}
    ).content
    path = tmp_path / "run.trace.parquet"
    path.write_bytes(recorded)
    run = http.get(f"/api/v1/runs/{crashed['id']}").json()
    stored = StoredTrace(run_id=run["id"], path=path, sha256=run["trace_sha256"])

    async def scenario() -> None:
        pictures = Pictures(most_bytes=1 << 20, most_waiting=1)
        draw = partial(pictures.strip, "a", stored, network, (), moments=2)
        drawn, again = await asyncio.gather(draw(), draw())
        assert drawn is again, "drawn once for equal requests"
        none = replace(stored, path=tmp_path / "none")
        assert await pictures.strip("a", none, network, (), moments=2) is drawn
        forgetful = Pictures(most_bytes=len(drawn) - 1, most_waiting=1)
        outcomes = await asyncio.gather(
            *(forgetful.strip(name, stored, network, (), moments=2) for name in "abc"),
            return_exceptions=True,
        )
        assert outcomes[0] == drawn
        refused = [one.status for one in outcomes[1:] if isinstance(one, ApiError)]
        assert refused == [503, 503]
        path.unlink()
        with pytest.raises(TraceDamaged):
            await forgetful.strip("a", stored, network, (), moments=2)

    asyncio.run(scenario())
