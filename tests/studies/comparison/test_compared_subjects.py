"""Which campaigns are repetitions of one another, and which must not be compared."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import CampaignDocument, campaign_text
from drivora_service.errors import CampaignError
from drivora_service.store.campaigns.campaign_records import (
    CampaignCounts,
    CampaignRecord,
    CampaignRequest,
    CampaignState,
)
from drivora_service.studies.comparison.compared_subjects import make_compared_campaigns
from drivora_service.studies.comparison.start_notes import start_notes
from tests.studies.computed_study import campaign_content


def record(seed: int, **changes: Any) -> CampaignRecord:
    content = campaign_content() | {"seed": seed} | changes
    document = CampaignDocument.model_validate(content)
    now = datetime(2026, 3, 2, tzinfo=UTC)
    return CampaignRecord(
        id=f"id-{seed}",
        name=f"study-{seed}",
        document=json.loads(campaign_text(document)),
        tester=document.tester.name,
        agent="idm",
        configuration="idm",
        configuration_id="",
        town=", ".join(one.map_region.town for one in document.seeds.values()),
        network_sha256="0" * 64,
        budget=document.budget.simulations,
        versions={},
        state=CampaignState.FINISHED,
        message="",
        request=CampaignRequest.NONE,
        created_at=now,
        started_at=now,
        ended_at=now,
        updated_at=now,
        active_s=1.0,
        counts=CampaignCounts(evaluations=12, judged=12),
    )


def methods(catalogues: Catalogues, *records: CampaignRecord) -> list[str]:
    compared = make_compared_campaigns(records, catalogues.testers)
    return [campaign.subject.method for campaign in compared]


def method(name: str = "avfuzzer", **changes: Any) -> dict[str, Any]:
    return {"name": name, **changes}


def started(kind: str = "failures", source: str = "campaign a") -> dict[str, Any]:
    return {"source": source, "kind": kind, "candidates": [{"values": [0.0]}]}


def test_searches_from_known_candidates_are_methods_of_their_own(catalogues: Catalogues) -> None:
    records = (
        record(1, tester=method()),
        record(2, tester=method(start_from=started())),
        record(3, tester=method(start_from=started(source="campaign b"))),
        record(4, tester=method(start_from=started("elites"))),
    )
    assert methods(catalogues, *records) == [
        "avfuzzer",
        "avfuzzer from failures",
        "avfuzzer from failures",
        "avfuzzer from elites",
    ]
    (note,) = start_notes(make_compared_campaigns(records, catalogues.testers))
    assert "avfuzzer from failures: 1 failure of campaign a, 1 failure of campaign b" in note
    assert "not for avfuzzer, which started from nothing" in note
    compared = make_compared_campaigns(records[1:], catalogues.testers)
    assert "all methods did" in "".join(start_notes(compared))
    assert not list(start_notes(make_compared_campaigns(records[:1], catalogues.testers)))


def test_methods_are_named_after_their_testers(catalogues: Catalogues) -> None:
    found = methods(
        catalogues,
        record(1),
        record(2, tester=method()),
        record(3, tester=method(feedback="shuffled")),
    )
    assert found == ["random", "avfuzzer", "avfuzzer without feedback"]


def test_only_parameters_that_differ_are_named(catalogues: Catalogues) -> None:
    parameters = {"population": 6, "crossover_rate": 0.5}
    found = methods(
        catalogues,
        record(1),
        record(2, tester=method(parameters=parameters)),
        record(3, tester=method(parameters=parameters | {"population": 8}, feedback="shuffled")),
    )
    assert found == [
        "random",
        "avfuzzer (population 6)",
        "avfuzzer without feedback (population 8)",
    ]


def test_a_default_that_is_written_down_is_no_difference(catalogues: Catalogues) -> None:
    found = methods(
        catalogues,
        record(1, tester=method()),
        record(2, tester=method(parameters={"population": 4})),
    )
    assert found == ["avfuzzer", "avfuzzer"]


def test_parameters_of_a_tester_that_is_not_here_are_told_apart(catalogues: Catalogues) -> None:
    found = methods(
        catalogues,
        record(1, tester=method("gone")),
        record(2, tester=method("gone", parameters={"speed": 2})),
    )
    assert found == ["gone (speed default)", "gone (speed 2)"]


def test_components_and_lookahead_make_different_methods(catalogues: Catalogues) -> None:
    found = methods(
        catalogues,
        record(1, tester=method()),
        record(2, tester=method(mutation="gaussian")),
        record(3, tester=method(), lookahead=2),
    )
    assert found == [
        "avfuzzer (mutation its own, lookahead 8)",
        "avfuzzer (mutation gaussian, lookahead 8)",
        "avfuzzer (mutation its own, lookahead 2)",
    ]


def test_scenarios_of_one_town_are_told_apart_by_what_is_in_them(catalogues: Catalogues) -> None:
    other = copy.deepcopy(campaign_content()["scenario"])
    other["seed"] = 2
    driven = copy.deepcopy(campaign_content()["scenario"])
    driven["ego_vehicles"][0]["agent"] = {"name": "sumo-idm"}
    compared = make_compared_campaigns(
        [record(1), record(2, scenario=other), record(3, scenario=driven)], catalogues.testers
    )
    names = [campaign.subject.scenario for campaign in compared]
    # The agent is the campaign's choice, and no part of the scenario.
    assert names[0] == names[2] != names[1]
    assert all(name.startswith("tee-town (") for name in names)
    assert (
        make_compared_campaigns([record(1)], catalogues.testers)[0].subject.scenario == "tee-town"
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"budget": {"simulations": 13}}, "budget: 12 and 13"),
        (
            {"oracles": ["collision", "blocked"]},
            r"failures: .* of collision and .* of blocked, col",
        ),
        ({"space": {"vehicles": 3, "walkers": 2}}, r"space.vehicles: 2 and 3\. "),
        ({"agent": {"name": "idm", "parameters": {"time_gap": 2}}}, "agent parameters: .*time_gap"),
    ],
)
def test_campaigns_that_differ_in_more_than_the_method_are_refused(
    catalogues: Catalogues, changes: dict[str, Any], message: str
) -> None:
    with pytest.raises(CampaignError, match=f"id-1 .* and id-2 .* the method: {message}"):
        make_compared_campaigns([record(1), record(2, **changes)], catalogues.testers)


def test_other_drivers_and_other_roads_are_refused(catalogues: Catalogues) -> None:
    with pytest.raises(CampaignError, match="agent: idm and sumo-idm"):
        make_compared_campaigns(
            [record(1), replace(record(2), agent="sumo-idm")], catalogues.testers
        )
    with pytest.raises(CampaignError, match="road network: 00000000 and 11111111"):
        make_compared_campaigns(
            [record(1), replace(record(2), network_sha256="1" * 64)], catalogues.testers
        )


@pytest.mark.parametrize(
    ("state", "hint"),
    [
        (CampaignState.PAUSED, "drivora campaign resume id-2"),
        (CampaignState.CANCELLED, "leave it out"),
    ],
)
def test_campaigns_that_have_not_finished_are_refused(
    catalogues: Catalogues, state: CampaignState, hint: str
) -> None:
    begun = replace(record(2), state=state, counts=CampaignCounts(evaluations=5, judged=5))
    with pytest.raises(CampaignError, match=f"{state} after 5 of 12 simulations.*{hint}"):
        make_compared_campaigns([record(1), begun], catalogues.testers)
