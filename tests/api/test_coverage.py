"""What the scenarios of a campaign cover, over HTTP."""

from __future__ import annotations

from typing import Any

import httpx
import numpy as np
import pytest

from drivora_service.studies.coverage.campaign_coverage import CoverageCounts
from drivora_service.studies.coverage.coverage_memory import CoverageMemory
from tests.api.conftest import Offline
from tests.api.test_campaigns import finished as finished  # a fixture
from tests.api.test_campaigns import post, small_campaign
from tests.api.test_discoveries import study as study  # a fixture
from tests.api.test_problem_details import is_problem

Json = dict[str, Any]


@pytest.fixture(scope="module")
def evaluations(service_url: str, finished: Json) -> list[Json]:
    """The simulated evaluations of the campaign at length."""
    with httpx.Client(base_url=service_url, timeout=60) as client:
        listed = client.get(f"{finished['evaluations_url']}?limit=500").json()["items"]
        return [
            client.get(f"{finished['evaluations_url']}/{one['number']}").json()
            for one in listed
            if one["status"] != "invalid"
        ]


def test_the_genes_that_were_tried_are_counted_by_bins(
    http: httpx.Client, finished: Json, evaluations: list[Json]
) -> None:
    answer = http.get(f"/api/v1/campaigns/{finished['id']}/coverage")
    found = answer.json()
    assert found["counted"] == found["evaluations"] == finished["counts"]["evaluations"]
    assert found["simulations"] == len(evaluations)
    genes = {(gene["block"], gene["name"]): gene for gene in found["genes"]}
    assert len(genes) > 10
    for (block, name), gene in genes.items():
        edges = np.linspace(gene["low"], gene["high"], len(gene["simulations"]) + 1)
        if gene["kind"] != "continuous":
            edges = np.linspace(gene["low"], gene["high"] + 1.0, len(gene["simulations"]) + 1)
        for counted, wanted in (
            ("simulations", evaluations),
            ("failing", [one for one in evaluations if one["violations"]]),
            ("avoidable", [one for one in evaluations if one["accountability"] == "avoidable"]),
        ):
            values = [value_of(one, block, name) for one in wanted]
            assert sum(gene[counted]) == len(wanted)
            if gene["kind"] == "continuous":
                # A value on an edge may be rounded to either side.
                near = np.histogram(values, bins=edges)[0]
                assert np.abs(np.array(gene[counted]) - near).sum() <= 2
    known = {"If-None-Match": answer.headers["ETag"]}
    url = f"/api/v1/campaigns/{finished['id']}/coverage"
    assert http.get(url, headers=known).status_code == 304


def value_of(evaluation: Json, block: str, name: str) -> float:
    (value,) = (
        gene["value"]
        for one in evaluation["genes"]
        if one["name"] == block
        for gene in one["genes"]
        if gene["name"] == name
    )
    return float(value)


def test_the_roads_are_those_of_the_figures(
    http: httpx.Client, finished: Json, evaluations: list[Json]
) -> None:
    found = http.get(f"/api/v1/campaigns/{finished['id']}/coverage").json()
    figures = http.get(f"/api/v1/campaigns/{finished['id']}/figures").json()["figures"]
    (network,) = found["networks"]
    assert network["network"] == finished["town"]
    assert network["share"] == pytest.approx(figures["network_coverage"])
    assert 0.0 < network["ego_share"] <= network["share"]
    lanes = {
        lane["id"]: lane
        for lane in http.get(f"/api/v1/networks/{finished['town']}/geometry").json()["lanes"]
    }
    for lane in network["lanes"]:
        assert lanes[lane["lane"]]["drivable"]
        assert len(lane["egos"]) == len(lane["actors"])
        assert all(
            egos <= actors for egos, actors in zip(lane["egos"], lane["actors"], strict=True)
        )
    # The one ego has the same way in all of them.
    assert {count for lane in network["lanes"] for count in lane["egos"]} == {0, len(evaluations)}


def test_kinds_of_scenarios_are_counted(
    http: httpx.Client, finished: Json, evaluations: list[Json]
) -> None:
    found = http.get(f"/api/v1/campaigns/{finished['id']}/coverage").json()
    kinds = {(kind["turn"], kind["others"]): kind for kind in found["kinds"]}
    for others, part in (("vehicles", "npc_vehicles"), ("walkers", "npc_walkers")):
        with_part = [one for one in evaluations if http.get(one["scenario_url"]).json().get(part)]
        own = [kind for (_, name), kind in kinds.items() if name == others]
        assert sum(kind["simulations"] for kind in own) == len(with_part)
        assert sum(kind["failing"] for kind in own) == sum(
            one["violations"] > 0 for one in with_part
        )
    assert {turn for turn, _ in kinds} == {"straight"}
    assert [kind["simulations"] for kind in found["kinds"]] == sorted(
        (kind["simulations"] for kind in found["kinds"]), reverse=True
    )


def test_a_request_counts_only_so_many_and_goes_on_where_it_ended(
    offline: Offline, study: Json
) -> None:
    context = offline.context
    (campaign, *_) = offline.client.get(study["campaigns_url"]).json()["items"]
    with context.database.read() as transaction:
        record = transaction.campaigns.get(campaign["id"])

    def made() -> CoverageCounts:
        return CoverageCounts(context.networks, lambda place: context.gene_spaces.of(record, place))

    whole = CoverageMemory().coverage(context.database, record.id, made)
    assert whole.counted == record.counts.evaluations > 3
    memory = CoverageMemory(most_at_once=3)
    counted: list[int] = []
    while not counted or counted[-1] < whole.counted:
        part = memory.coverage(context.database, record.id, made)
        counted.append(part.counted)
    assert counted[0] == 3
    assert counted == sorted(set(counted))
    assert part == whole
    assert offline.client.get(f"/api/v1/campaigns/{record.id}/coverage").json()["simulations"] == (
        whole.simulations
    )


def test_what_is_not_there_and_what_has_not_begun(offline: Offline) -> None:
    is_problem(offline.client.get("/api/v1/campaigns/none/coverage"), 404)
    waiting = post(offline, small_campaign("random"))
    found = offline.client.get(f"/api/v1/campaigns/{waiting['id']}/coverage").json()
    assert (found["evaluations"], found["networks"], found["genes"]) == (0, [], [])
