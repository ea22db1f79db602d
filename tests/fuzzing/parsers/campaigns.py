"""Campaign files, as the command line and the API read them."""

from __future__ import annotations

import json
from collections.abc import Mapping

import yaml

from drivora_service.campaigns.document.campaign_documents import campaign_text
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.cli.campaigns.campaign_files import read_campaign_file
from drivora_service.errors import InvalidDocument
from tests.fuzzing.harness import Harness, by_name, check_refusal
from tests.fuzzing.parsers.shared import catalogues, check_problems, folder
from tests.scenario.conftest import GOOD


def _parse_file(data: bytes) -> bool:
    path = folder() / "campaign.yaml"
    (folder() / "scenario.json").write_text(json.dumps(GOOD))
    path.write_bytes(data)
    try:
        content = read_campaign_file(path)
    except InvalidDocument as error:
        check_refusal(error)
        return False
    try:
        read_campaign(content, catalogues())
    except InvalidDocument as error:
        check_refusal(error, content)
        return False
    return True


def _parse_body(data: bytes) -> bool:
    try:
        valid = read_campaign(data, catalogues())
    except InvalidDocument as error:
        check_problems(error, data, "json")
        return False
    text = campaign_text(valid.document)
    assert read_campaign(text, catalogues()).document == valid.document
    return True


_CAMPAIGN = {
    "name": "late braking",
    "tester": {"name": "samota", "parameters": {}, "mutation": None, "feedback": "shuffled"},
    "agent": {"name": "idm", "parameters": {"speed_factor": 1.1}},
    "scenario": GOOD,
    "space": {"vehicles": 2, "walkers": 0, "reach": 100.0, "weather": False, "behavior": "replay"},
    "budget": {"simulations": 100},
    "oracles": ["collision", "red_light"],
    "seed": 1,
    "workers": 2,
    "lookahead": 8,
}


def _file_seeds() -> Mapping[str, bytes]:
    by_file = {**_CAMPAIGN, "scenario": {"file": "scenario.json"}}
    return {
        "by-file": yaml.safe_dump(by_file, sort_keys=False).encode(),
        "whole": yaml.safe_dump(_CAMPAIGN, sort_keys=False).encode(),
    }


def _body_seeds() -> Mapping[str, bytes]:
    parts = ("name", "tester", "scenario", "budget")
    small = {key: value for key, value in _CAMPAIGN.items() if key in parts}
    return {"whole": json.dumps(_CAMPAIGN).encode(), "small": json.dumps(small).encode()}


_WORDS = ("random", "avfuzzer", "behavexplor", "doppeltest", "population", "egos", "slices")
CAMPAIGN_FILE = Harness(name="campaign-file", parse=_parse_file, seeds=_file_seeds, words=_WORDS)
CAMPAIGN_BODY = Harness(
    name="campaign-body",
    parse=_parse_body,
    seeds=_body_seeds,
    words=tuple(f'"{word}"' for word in _WORDS),
)
HARNESSES = by_name(CAMPAIGN_FILE, CAMPAIGN_BODY)
