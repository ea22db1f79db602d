"""The reference of the document says what the document is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from drivora_service.scenario import plain_data
from drivora_service.scenario.models.actor_models import ActorKind, model_names
from drivora_service.scenario.scenario_schema import document_schema

SECTIONS = {
    "ScenarioDocument": "The document",
    "MapRegionDocument": "map_region",
    "RegionDocument": "region_segment",
    "EgoDocument": "ego_vehicles",
    "ReferencePoseDocument": "Reference poses",
    "AgentDocument": "agent",
    "NpcVehicleDocument": "npc_vehicles",
    "NpcWalkerDocument": "npc_walkers",
    "NpcObstacleDocument": "npc_obstacles",
    "FrictionPatchDocument": "friction_patches",
    "WaypointDocument": "Waypoints of vehicles",
    "NpcWaypointDocument": "Waypoints of NPC vehicles",
    "WalkerWaypointDocument": "Waypoints of walkers",
    "LocationDocument": "location",
    "WeatherDocument": "weather",
    "WeatherChangeDocument": "weather_changes",
    "TrafficLightsDocument": "traffic_lights",
    "LightTimesDocument": "junctions",
    "BackgroundTrafficDocument": "background_traffic",
}


@pytest.fixture(scope="module")
def reference(repository: Path) -> str:
    return (repository / "docs" / "reference" / "openscenario.md").read_text()


def definitions() -> dict[str, Any]:
    schema = document_schema()
    objects = {
        name: entry for name, entry in schema["$defs"].items() if entry.get("type") == "object"
    }
    return {"ScenarioDocument": schema, **objects}


def row(name: str, entry: dict[str, Any], required: bool) -> str:
    """The row of a field in its table."""
    kinds = [kind for kind in entry.get("anyOf", [entry]) if kind.get("type") != "null"]
    if required:
        default = "required"
    elif entry.get("default") is not None and entry.get("default") != []:
        default = f"{entry['default']}"
    else:
        default = "none"
    return f"| `{name}` | {kind_of(kinds[0])} | {default} | {entry['description']} |"


def kind_of(entry: dict[str, Any]) -> str:
    """Type, unit and bounds of a value."""
    if "$ref" in entry:
        return kind_of_reference(entry["$ref"].rpartition("/")[2])
    if "const" in entry:
        return f'`"{entry["const"]}"`'
    kind = entry["type"]
    if kind in ("number", "integer"):
        unit = "" if entry["x-unit"] == "1" else f" {entry['x-unit']}"
        return f"{kind}, {entry['minimum']:,.10g} to {entry['maximum']:,.10g}{unit}"
    if kind == "array":
        section = kind_of_reference(entry["items"]["$ref"].rpartition("/")[2])
        return f"{entry.get('minItems', 0):,} to {entry['maxItems']:,} {section}"
    return "text" if kind == "string" else kind


def kind_of_reference(name: str) -> str:
    entry = document_schema()["$defs"][name]
    if "enum" in entry:
        return " or ".join(f"`{value}`" for value in entry["enum"])
    return f"[{SECTIONS[name]}](#{SECTIONS[name].lower().replace(' ', '-')})"


def test_every_part_of_the_document_has_a_section() -> None:
    assert set(SECTIONS) == set(definitions())


@pytest.mark.parametrize("name", SECTIONS)
def test_every_field_stands_in_its_section(name: str, reference: str) -> None:
    _, _, rest = reference.partition(f"## {SECTIONS[name]}\n")
    section = rest.partition("\n## ")[0]
    entry = definitions()[name]
    for field, content in entry["properties"].items():
        expected = row(field, content, field in entry.get("required", ()))
        assert expected in section, f"missing in section {SECTIONS[name]!r}: {expected}"


@pytest.mark.parametrize("kind", ActorKind)
def test_every_model_is_listed(kind: ActorKind, reference: str) -> None:
    names = [name for name in model_names(kind) if not name.startswith("walker.")]
    assert [name for name in names if f"`{name}`" not in reference] == []
    assert "`walker.pedestrian.0001` to `walker.pedestrian.0052`" in reference


def test_limits_of_the_whole_document_are_named(reference: str) -> None:
    for limit in (
        f"{plain_data.MAX_DOCUMENT_BYTES // 2**20} MiB",
        f"{plain_data.MAX_YAML_BYTES // 2**10} KiB",
        f"{plain_data.MAX_DEPTH} levels",
        f"{plain_data.MAX_VALUES:,} values",
    ):
        assert limit in reference
