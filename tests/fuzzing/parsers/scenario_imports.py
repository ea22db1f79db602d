"""Scenario files of other tools, as the command line reads them."""

from __future__ import annotations

import json
from collections.abc import Mapping

from drivora_service.errors import InvalidDocument
from drivora_service.scenario.documents import document_text, parse_document
from drivora_service.scenario.importers.reading import read_scenarios
from tests.fuzzing.harness import Harness, by_name, check_refusal
from tests.scenario.importers.test_leaderboard import FLAT, NESTED
from tests.scenario.importers.test_original_tool import original_file


def _parse_file(data: bytes) -> bool:
    try:
        read = read_scenarios(data, name="fuzzed")
    except InvalidDocument as error:
        check_refusal(error)
        return False
    for one in read:
        assert one.name
        text = document_text(one.document)
        assert parse_document(text) == one.document
    return True


def _leaderboard_seeds() -> Mapping[str, bytes]:
    return {"flat": FLAT.encode(), "nested": NESTED.encode()}


def _original_seeds() -> Mapping[str, bytes]:
    small = {key: original_file()[key] for key in ("id", "ego_vehicles", "map_region")}
    return {"whole": json.dumps(original_file()).encode(), "small": json.dumps(small).encode()}


LEADERBOARD = Harness(
    name="leaderboard",
    parse=_parse_file,
    seeds=_leaderboard_seeds,
    words=("route_percentage", "waypoint", "waypoints", "position", "weathers"),
)
ORIGINAL_TOOL = Harness(name="original-tool", parse=_parse_file, seeds=_original_seeds)
HARNESSES = by_name(LEADERBOARD, ORIGINAL_TOOL)
