"""The example scenarios that come with the package."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from drivora_service.scenario.scenario_schema import schema_directory


@cache
def shipped_scenarios() -> Mapping[str, Mapping[str, Any]]:
    """Returns the documents of the examples by name, those that searches begin from first."""
    folder = schema_directory() / "examples"
    paths = [*sorted((folder / "campaigns").glob("*.json")), *sorted(folder.glob("*.json"))]
    return MappingProxyType(
        {path.stem.replace("-", " "): json.loads(path.read_text("utf-8")) for path in paths}
    )
