"""Names that users give: what is refused, where, and what stays readable."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Annotated, Any

import pytest
from pydantic import BaseModel, Field, ValidationError

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.api.schemas.failure_groups import DecisionRequest, MergeRequest
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.errors import ConfigurationError, InvalidDocument
from drivora_service.given_names import CHECKED_NAME, CHECKED_NOTE, read_stored
from drivora_service.studies.study_reading import read_study
from drivora_service.suites.gate.baseline_files import read_baseline
from drivora_service.suites.suite_reading import read_suite
from tests.hostile_names import ACTING, FORMULAS, MARKUP
from tests.studies.computed_study import campaign_content
from tests.studies.example_study import study_content


class Given(BaseModel):
    name: Annotated[str, Field(max_length=200), CHECKED_NAME] = ""
    note: Annotated[str, Field(max_length=200), CHECKED_NOTE] = ""


@pytest.mark.parametrize("name", ACTING, ids=ascii)
def test_names_that_act_are_refused_and_stored_ones_read(name: str) -> None:
    with pytest.raises(ValidationError, match=r"found U\+[0-9A-F]{4,6} \(.*as character"):
        Given.model_validate({"name": name})
    assert read_stored(Given, {"name": name}).name == name


@pytest.mark.parametrize("name", [*MARKUP, *FORMULAS], ids=ascii)
def test_other_names_are_accepted(name: str) -> None:
    assert Given.model_validate({"name": name, "note": name}).name == name


def test_notes_have_lines() -> None:
    assert Given.model_validate({"note": "one\r\ntwo\n\tthree"}).note == "one\ntwo\n\tthree"
    with pytest.raises(ValidationError, match=r"found U\+001B \(escape\).*; line feeds"):
        Given.model_validate({"note": "\x1b"})


def test_long_names_are_too_long_as_before() -> None:
    with pytest.raises(ValidationError, match="String should have at most 200 characters"):
        Given.model_validate({"name": "x" * 201})
    assert Given.model_json_schema()["properties"]["name"]["maxLength"] == 200


EVIL = "a\u202eb"


def _problems(error: pytest.ExceptionInfo[InvalidDocument]) -> dict[str, str]:
    return {one.pointer: one.message for one in error.value.problems}


def test_campaigns_name_the_place(catalogues: Catalogues) -> None:
    content = campaign_content() | {"name": EVIL}
    scenario = content.pop("scenario")
    content["scenarios"] = [{"name": "x\x9b", "scenario": scenario}]
    with pytest.raises(InvalidDocument) as raised:
        read_campaign(content, catalogues)
    assert _problems(raised).keys() == {"/name", "/scenarios/0/name"}
    assert _problems(raised)["/name"].startswith(
        "found U+202E (right-to-left override) as character 2 of 3; a name is one line"
    )
    assert read_campaign(content, catalogues, is_stored=True).campaign.name == EVIL
    assert read_stored(CampaignDocument, content).name == EVIL


def test_studies_name_the_place(catalogues: Catalogues) -> None:
    content = study_content() | {"name": EVIL}
    content["methods"] = [{**content["methods"][0], "label": "two\nlines"}]
    with pytest.raises(InvalidDocument) as raised:
        read_study(content, catalogues)
    assert _problems(raised).keys() == {"/name", "/methods/0/label"}


def test_suites_name_the_place() -> None:
    content: dict[str, Any] = {
        "name": EVIL,
        "description": "lines\nare allowed, \x1b is not",
        "scenarios": [{"name": "bell\x07", "document": copy.deepcopy(SCENARIO)}],
    }
    with pytest.raises(InvalidDocument) as raised:
        read_suite(content, oracles=(), metrics=())
    assert _problems(raised).keys() == {"/name", "/description", "/scenarios/0/name"}


def test_baselines_name_the_place(tmp_path: Path) -> None:
    path = tmp_path / "baseline.json"
    path.write_text('{"version": "1.0", "suite": "a\\u001b", "agent": "", "scenarios": {}}')
    with pytest.raises(ConfigurationError, match=r"no baseline: suite: 'a\\x1b': found U\+001B"):
        read_baseline(path)


def test_tokens_have_names_that_can_be_shown(tmp_path: Path) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    with pytest.raises(ConfigurationError, match=r"the name of a token: found U\+202E"):
        tokens.create(EVIL, Scope.READ)
    tokens.create("a name", Scope.READ)


@pytest.mark.parametrize("field", ["label", "assignee", "by", "note"])
def test_decisions_on_groups_are_checked(field: str) -> None:
    with pytest.raises(ValidationError, match=r"found U\+202E"):
        DecisionRequest.model_validate({field: EVIL})
    assert DecisionRequest.model_validate({"note": "two\nlines"}).note == "two\nlines"
    with pytest.raises(ValidationError, match=r"found U\+202E"):
        MergeRequest.model_validate({"into": "g", "groups": ["h"], "by": EVIL})
