"""No document that is shipped or generated is far from what its place allows."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_data, validate_document


def scenarios(folder: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    for path in sorted(folder.rglob("*.json")):
        content = json.loads(path.read_text("utf-8"))
        if isinstance(content, dict) and "ego_vehicles" in content:
            yield path.name, content


@pytest.mark.parametrize("step", [10, pytest.param(1, marks=pytest.mark.slow)])
def test_no_shipped_scenario_has_a_note_with_a_place(
    repository: Path, networks: NetworkCatalogue, step: int
) -> None:
    found = [*scenarios(repository / "openscenario_schemas")][::step]
    assert len(found) > 300 / step
    noted = [
        f"{name} {note}"
        for name, content in found
        for note in validate_data(content, networks, None).notes
        if note.startswith("/")
    ]
    assert not noted


def test_no_generated_seed_has_a_note_with_a_place(networks: NetworkCatalogue) -> None:
    for town in networks.names():
        seeds = generate_seeds(
            networks.get(town), count=10, min_length=80.0, max_length=300.0, seed=2, agent="idm"
        )
        for document in seeds:
            notes = validate_document(document, networks, None).notes
            assert not [note for note in notes if note.startswith("/")], town
