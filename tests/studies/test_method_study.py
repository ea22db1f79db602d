"""The files of the method study stand for the campaigns that its results came from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks.method_study import ARMS, SCENES, TWINS, campaign_document
from drivora_service.campaigns.catalogues import Catalogues
from drivora_service.campaigns.documents import campaign_text
from drivora_service.campaigns.reading import read_campaign
from drivora_service.cli.study_files import read_study_file
from drivora_service.studies.reading import read_study


@pytest.mark.parametrize(
    ("name", "egos"), [("one-ego", "one ego"), ("several-egos", "several egos")]
)
def test_each_campaign_is_the_one_that_the_study_had(
    name: str, egos: str, repository: Path, catalogues: Catalogues
) -> None:
    file = read_study_file(repository / "benchmarks" / "studies" / f"{name}.yaml")
    study = read_study({**file.content, "repetitions": 2}, catalogues)
    found = {
        (c.cell.scenario, c.cell.method, c.cell.repetition): json.loads(c.document)
        for c in study.campaigns
        if c.cell is not None
    }
    wanted: dict[tuple[str, str, int], dict[str, Any]] = {}
    for scene in (scene for scene in SCENES if scene.egos == egos):
        for arm in (arm for arm in (*ARMS, *TWINS) if arm.egos == egos):
            for repetition in (1, 2):
                document = campaign_document(scene, arm, repetition, 300)
                valid = read_campaign(json.dumps(document), catalogues)
                wanted[scene.name, arm.name, repetition] = json.loads(campaign_text(valid.document))
    assert found.keys() == wanted.keys()
    for key, document in wanted.items():
        # The name is for display only.
        assert {**found[key], "name": ""} == {**document, "name": ""}
