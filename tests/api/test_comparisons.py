from __future__ import annotations

import copy
import hashlib
from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import CAMPAIGN
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.campaigns.search.conducting import conduct
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.feedback.measurement import Measurement
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignState
from tests.api.conftest import Offline
from tests.api.test_problem_details import is_problem
from tests.campaigns.analytic import Computed

COMPARE = "/api/v1/campaigns:compare"


def found_by(share: int) -> Computed:
    """An evaluator in whose world one run of ``share`` fails, without simulating it."""

    def work(spec: RunSpec) -> RunReport:
        digest = hashlib.sha256(spec.document.encode()).digest()
        fails = digest[0] % share == 0
        verdict = Verdict(
            oracle="collision",
            ego="ego",
            outcome=Outcome.VIOLATED if fails else Outcome.PASSED,
            message="",
            at_fault=True,
            time=float(digest[1]) / 20.0,
            location=(10.0, 20.0),
        )
        return RunReport(
            run_id=spec.run_id,
            status=RunStatus.FINISHED,
            verdicts=(verdict,),
            measurement=Measurement(objectives={"safety_margin": float(digest[2])}),
            wall_time_s=0.1,
        )

    return Computed(work=work)


def campaign(offline: Offline, tester: str, seed: int, *, share: int) -> str:
    """A finished campaign whose runs were made up."""
    document: dict[str, Any] = {
        **copy.deepcopy(CAMPAIGN),
        "name": f"study-{tester}-{seed}",
        "tester": {"name": tester},
        "budget": {"simulations": 20},
        "seed": seed,
    }
    campaign_id: str = offline.client.post("/api/v1/campaigns", json=document).json()["id"]
    catalogues, database = offline.context.catalogues, offline.context.database
    search = prepare_search(read_campaign(document, catalogues), catalogues, run_prefix="made-up")
    with database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
    conduct(search, found_by(share), StoreJournal(database, campaign_id), confirm=False)
    with database.write() as transaction:
        transaction.campaigns.end(campaign_id, CampaignState.FINISHED)
    return campaign_id


@pytest.fixture
def study(offline: Offline) -> list[str]:
    """Three repetitions of two methods, of which one finds more."""
    return [
        campaign(offline, tester, seed, share=share)
        for tester, share in (("random", 10), ("avfuzzer", 2))
        for seed in range(3)
    ]


def test_methods_are_compared_with_the_baseline(offline: Offline, study: list[str]) -> None:
    answer = offline.client.get(COMPARE, params={"campaign": "study-*"})
    assert answer.status_code == 200, answer.text
    comparison = answer.json()
    assert (comparison["baseline"], comparison["budgets"]) == ("random", {"tee-town": 20})
    assert [figures["campaign"] for figures in comparison["campaigns"]] == study
    by_measure = {row["measure"]: row for row in comparison["differences"]}
    failing = by_measure["failing"]
    assert (failing["method"], failing["repetitions"]) == ("avfuzzer", 3)
    assert failing["median"] > failing["baseline_median"]
    assert failing["a12"] == 1.0
    assert 0.0 <= failing["low"] <= failing["high"] <= 1.0
    counts = [figures["failing"] for figures in comparison["campaigns"]]
    assert failing["median"] == sorted(counts[3:])[1]
    known = {"If-None-Match": answer.headers["ETag"]}
    again = offline.client.get(COMPARE, params={"campaign": "study-*"}, headers=known)
    assert again.status_code == 304


def test_a_campaign_is_told_in_the_same_figures(offline: Offline, study: list[str]) -> None:
    compared = offline.client.get(COMPARE, params={"campaign": "study-*"}).json()["campaigns"]
    for campaign_id, theirs in zip(study, compared, strict=True):
        answer = offline.client.get(f"/api/v1/campaigns/{campaign_id}/figures").json()
        assert answer["note"] == ""
        # Groups of failures are made over all that are compared, and here for the one.
        apart = {"groups": None, "situations": None, "scenario": "", "network_coverage": None}
        assert {**answer["figures"], **apart} == {**theirs, **apart}
    is_problem(offline.client.get("/api/v1/campaigns/nobody/figures"), 404)


def test_measures_and_campaigns_are_chosen(offline: Offline, study: list[str]) -> None:
    wanted = {"campaign": study[1:], "measure": ["kinds", "failing"], "baseline": "avfuzzer"}
    comparison = offline.client.get(COMPARE, params=wanted).json()
    assert [row["measure"] for row in comparison["differences"]] == ["kinds", "failing"]
    assert len(comparison["campaigns"]) == 5
    timed = offline.client.get(COMPARE, params={**wanted, "equal_time": True}).json()
    assert list(timed["time_limits_s"]) == ["tee-town"]


def test_what_cannot_be_compared_is_refused_with_the_reason(
    offline: Offline, study: list[str]
) -> None:
    def refused(status: int, **parameters: Any) -> str:
        body = is_problem(offline.client.get(COMPARE, params=parameters), status)
        detail: str = body["detail"]
        return detail

    assert "nothing to compare" in refused(422, campaign=study[:3])
    assert "no campaign of 'samota'" in refused(422, campaign="study-*", baseline="samota")
    assert "unknown campaign 'nobody'" in refused(404, campaign="nobody")
    assert "unknown measure 'luck'" in refused(404, campaign="study-*", measure="luck")
    refused(422)
    document = {**copy.deepcopy(CAMPAIGN), "name": "study-unfinished"}
    assert offline.client.post("/api/v1/campaigns", json=document).status_code == 202
    assert "only finished campaigns" in refused(422, campaign="study-*")
