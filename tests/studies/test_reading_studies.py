"""Study documents: the campaigns that they stand for, and problems at their places."""

from __future__ import annotations

import itertools
import json
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.errors import InvalidDocument
from drivora_service.studies.study_documents import AS_IN_SCENARIO
from drivora_service.studies.study_reading import read_study
from tests.studies.example_study import study_content


def test_a_study_is_every_combination_repetition_by_repetition(catalogues: Catalogues) -> None:
    study = read_study(study_content(), catalogues)
    cells = [c.cell for c in study.campaigns if c.cell is not None]
    assert [(c.repetition, c.scenario, c.agent, c.method) for c in cells] == list(
        itertools.product((1, 2), ("first", "second"), ("idm", "idm-mobil"), ("random", "fuzzer"))
    )
    for campaign in study.campaigns:
        assert campaign.cell is not None
        cell, document = campaign.cell, json.loads(campaign.document)
        assert document["seed"] == 2 + cell.repetition
        assert document["agent"]["name"] == cell.agent
        assert document["tester"]["name"] == {"random": "random", "fuzzer": "avfuzzer"}[cell.method]
        assert document["space"]["vehicles"] == {"first": 2, "second": 1}[cell.scenario]
        assert document["budget"] == {"simulations": 8}
        assert campaign.agent == cell.agent
        # A campaign of a study is one that can be posted by itself.
        assert read_campaign(document, catalogues).campaign.seed == document["seed"]
    assert len({campaign.name for campaign in study.campaigns}) == len(study.campaigns) == 16


def test_without_agents_the_scenarios_have_theirs(catalogues: Catalogues) -> None:
    content = study_content()
    del content["agents"]
    study = read_study(content, catalogues)
    assert len(study.campaigns) == 8
    assert {c.cell.agent for c in study.campaigns if c.cell is not None} == {AS_IN_SCENARIO}
    assert all("agent" not in json.loads(c.document) for c in study.campaigns)


def test_notes_on_figures_have_their_places_in_the_study(catalogues: Catalogues) -> None:
    content = study_content()
    content["scenarios"][1]["document"]["ego_vehicles"][0]["initial_speed"] = 50.0
    content["agents"][0]["parameters"] = {"speed_factor": 1.0}
    content["space"] = {"vehicles": 2, "max_speed_factor": 3.0}
    places = [note.partition(":")[0] for note in read_study(content, catalogues).notes]
    own = [place for place in places if place.startswith("/")]
    assert own == [
        "/space/max_speed_factor",
        "/scenarios/1/document/ego_vehicles/0/initial_speed",
    ]


def test_a_method_without_feedback_is_named_so(catalogues: Catalogues) -> None:
    content = study_content()
    content["methods"] = [{"name": "avfuzzer"}, {"name": "avfuzzer", "feedback": "shuffled"}]
    assert read_study(content, catalogues).document.method_labels == (
        "avfuzzer",
        "avfuzzer without feedback",
    )


def _unknown_method(content: dict[str, Any]) -> None:
    content["methods"][1]["name"] = "avfuzzr"


def _method_parameter(content: dict[str, Any]) -> None:
    content["methods"][1]["parameters"] = {"population": 0}


def _beyond_budget(content: dict[str, Any]) -> None:
    content["methods"][1]["parameters"] = {"population": 5000}


def _unknown_agent(content: dict[str, Any]) -> None:
    content["agents"][1]["name"] = "idm-mobile"


def _unknown_town(content: dict[str, Any]) -> None:
    content["scenarios"][1]["document"]["map_region"]["town"] = "nowhere"


def _unknown_oracle(content: dict[str, Any]) -> None:
    content["oracles"] = ["colision"]


def _repeated_label(content: dict[str, Any]) -> None:
    content["methods"][1] = {"name": "avfuzzer", "label": "random"}


def _unknown_key(content: dict[str, Any]) -> None:
    content["repetition"] = 3


def _many_campaigns(content: dict[str, Any]) -> None:
    content["methods"] = [{"name": "random", "label": str(n)} for n in range(50)]
    content["repetitions"] = 1000


def _last_seed(content: dict[str, Any]) -> None:
    content["seed"] = 2**31 - 1


def _no_place(content: dict[str, Any]) -> None:
    content["scenarios"][1]["space"] = {"egos": 1, "vehicles": 0, "walkers": 0, "weather": False}


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        (_unknown_method, "/methods/1/name"),
        (_method_parameter, "/methods/1/parameters/population"),
        (_beyond_budget, "/methods/1/parameters/population"),
        (_unknown_agent, "/agents/1/name"),
        (_unknown_town, "/scenarios/1/document/map_region/town"),
        (_unknown_oracle, "/oracles/0"),
        (_repeated_label, "/methods/1/label"),
        (_unknown_key, "/repetition"),
        (_many_campaigns, ""),
        (_last_seed, "/seed"),
        (_no_place, "/scenarios/1/space"),
    ],
)
def test_problems_are_named_once_at_their_places(
    change: Any, pointer: str, catalogues: Catalogues
) -> None:
    content = study_content()
    change(content)
    with pytest.raises(InvalidDocument) as refused:
        read_study(content, catalogues)
    assert [problem.pointer for problem in refused.value.problems] == [pointer]


def test_methods_minimise_what_the_study_or_they_themselves_say(catalogues: Catalogues) -> None:
    content = study_content()
    content["feedback"] = {"name": "min_gap"}
    own = {"name": "max_drac_mps2", "target": 6.0}
    content["methods"] = [{"name": "avfuzzer"}, {"name": "avfuzzer", "minimises": own}]
    study = read_study(content, catalogues)
    other = "avfuzzer by max_drac_mps2 (target 6)"
    assert study.document.method_labels == ("avfuzzer", other)
    for campaign in study.campaigns:
        assert campaign.cell is not None
        document = json.loads(campaign.document)
        (one,) = read_campaign(document, catalogues).campaign.objectives
        assert (
            one.name
            == {"avfuzzer": "min_gap", other: "negated_max_drac_mps2"}[campaign.cell.method]
        )
        assert "minimises" not in document["tester"]


@pytest.mark.parametrize(
    ("own", "pointer"), [(True, "/methods/0/minimises/name"), (False, "/feedback/name")]
)
def test_an_unknown_objective_is_named_at_its_place(
    own: bool, pointer: str, catalogues: Catalogues
) -> None:
    content = study_content()
    content["methods"] = [
        {"name": "avfuzzer", **({"minimises": {"name": "min_gop"}} if own else {})}
    ]
    if not own:
        content["feedback"] = {"name": "min_gop"}
    with pytest.raises(InvalidDocument, match="did you mean 'min_gap'") as refused:
        read_study(content, catalogues)
    assert {problem.pointer for problem in refused.value.problems} == {pointer}
