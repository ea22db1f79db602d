"""Scenario documents, as the command line and the API read them, also in batches."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Mapping
from typing import Literal

import yaml
from pydantic_core import from_json

from drivora_service.api.answers.batch_scenarios import read_batch_scenario
from drivora_service.errors import InvalidDocument
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.scenario.validation import validate_data
from drivora_service.store.runs.run_records import LONGEST_LABEL
from tests.fuzzing.harness import Harness, by_name
from tests.fuzzing.parsers.shared import agents, check_problems, example_scenarios, networks
from tests.scenario.conftest import GOOD


def _validate(data: bytes, language: Literal["json", "yaml"]) -> bool:
    try:
        valid = validate_data(data, networks(), agents().availability(), language)
    except InvalidDocument as error:
        check_problems(error, data, language)
        return False
    text = canonical_json(valid.scenario)
    assert canonical_json(from_canonical(text)) == text
    return True


def _parse_json(data: bytes) -> bool:
    return _validate(data, "json")


def _parse_yaml(data: bytes) -> bool:
    return _validate(data, "yaml")


def _parse_line(data: bytes) -> bool:
    """Reads a line of a batch, and the same as an item of a list."""
    read = _check_item(data, data)
    with contextlib.suppress(ValueError):
        _check_item(from_json(data), data)
    return read


def _check_item(item: object, data: bytes) -> bool:
    known = agents().availability()
    try:
        scenario = read_batch_scenario(item)
        scenario.check_document(lambda document: validate_data(document, networks(), known))
    except InvalidDocument as error:
        check_problems(error, data, "json")
        return False
    assert len(scenario.label) <= LONGEST_LABEL
    return True


_FULL = {
    **GOOD,
    "npc_vehicles": [
        {
            "id": "npc",
            "model": "audi.tt",
            "behavior": "reactive",
            "route": [{"x": 60.0, "y": 152.7, "speed": 5}, {"x": 30.0, "y": 153.2, "yaw": 180}],
        }
    ],
    "npc_walkers": [
        {"id": "w", "model": "0001", "start_time": 1, "route": [{"x": 60.0, "y": 160.0}]}
    ],
    "npc_obstacles": [
        {"id": "cone", "model": "trafficcone01", "location": {"x": 20.0, "y": 157.0}, "length": 1}
    ],
    "friction_patches": [
        {"id": "ice", "location": {"x": 40.0, "y": 153.0}, "length": 9, "width": 3, "friction": 0.1}
    ],
    "weather": {"wetness": 5, "fog_density": 10},
    "traffic_lights": {"green_time": 9, "junctions": {}},
    "background_traffic": {"count": 2},
    "map_region": {
        "town": "tee-town",
        "region_segment": {"min_x": 0, "max_x": 400, "min_y": 0, "max_y": 400},
    },
    "seed": 7,
    "max_sim_time": 30,
    "extensions": {"a:b": [1, {"c": None}]},
}


def _json_seeds() -> Mapping[str, bytes]:
    small = {
        name: json.dumps(json.loads(data)).encode() for name, data in example_scenarios().items()
    }
    return {
        "good": json.dumps(GOOD).encode(),
        "full": json.dumps(_FULL).encode(),
        **{name: data for name, data in small.items() if len(data) < SCENARIO_JSON.max_length},
    }


def _line_seeds() -> Mapping[str, bytes]:
    return {
        "bare": json.dumps(GOOD).encode(),
        "labelled": json.dumps({"label": "Town01_route_07", "scenario": GOOD}).encode(),
        "full": json.dumps({"scenario": _FULL, "label": "\u00fc"}).encode(),
    }


def _yaml_seeds() -> Mapping[str, bytes]:
    return {
        "good": yaml.safe_dump(GOOD, sort_keys=False).encode(),
        "full": yaml.safe_dump(_FULL, sort_keys=False).encode(),
        "flow": yaml.safe_dump(_FULL, default_flow_style=True).encode(),
    }


SCENARIO_JSON = Harness(
    name="scenario-json",
    parse=_parse_json,
    seeds=_json_seeds,
    words=(
        '"replay"',
        '"sumo"',
        '"carla"',
        '"config_path"',
        '"density"',
        '"stuck_after"',
        '"joins"',
        '"weather_changes"',
        '"time"',
    ),
)
SCENARIO_YAML = Harness(name="scenario-yaml", parse=_parse_yaml, seeds=_yaml_seeds)
BATCH_LINE = Harness(name="batch-line", parse=_parse_line, seeds=_line_seeds)
HARNESSES = by_name(SCENARIO_JSON, SCENARIO_YAML, BATCH_LINE)
