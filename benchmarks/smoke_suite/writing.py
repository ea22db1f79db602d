"""The files of the suite."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.smoke_suite.choosing import Candidate
from benchmarks.smoke_suite.panel import PANEL, SLOW
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.entities import AgentDocument
from drivora_service.suites.suite_documents import EXTENSION

_DRIVER = "idm"
"""Drives the scenarios of the suite if no other ADS is named."""


def write_suite(folder: Path, chosen: Sequence[Candidate]) -> None:
    """Writes the scenarios with their difficulty, in place of those that are there."""
    inside = folder / "scenarios"
    inside.mkdir(parents=True, exist_ok=True)
    for path in inside.glob("*.json"):
        path.unlink()
    for one in chosen:
        carried = one.document.extensions.get(EXTENSION)
        found: dict[str, Any] = dict(carried) if isinstance(carried, dict) else {}
        found_by = [tag for tag in found.get("tags", ()) if tag.startswith("found-by-")]
        expected = {
            "tags": sorted({one.town, *one.oracles, *found_by}),
            "difficulty": {
                "failed_by": list(one.ads_failing),
                "passed_by": [
                    driver.label
                    for driver in PANEL
                    if driver.label not in one.failed_by and driver is not SLOW
                ],
            },
            "comment": f"Found as: {found.get('comment', '')}",
        }
        egos = tuple(
            ego.model_copy(update={"agent": AgentDocument(name=_DRIVER), "config_path": None})
            for ego in one.document.ego_vehicles
        )
        document = one.document.model_copy(
            update={"ego_vehicles": egos, "extensions": {EXTENSION: expected}}
        )
        (inside / f"{one.name}.json").write_text(document_text(document))
