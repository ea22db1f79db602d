"""The reference page of the trace file lists what a real file has: no more, and no less."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace import EgoCol, Light, Role, TerminalEvent
from drivora_service.observations.trace_files.trace_file import SCHEMA_VERSION
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.validation import validate_data
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup

_ROOT = Path(__file__).resolve().parents[2]
_PAGE = (_ROOT / "docs" / "reference" / "trace.md").read_text()


@pytest.fixture(scope="module")
def trace_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with signals, agents' logs, background, an ego that drives into an obstacle, and one
    with a reference path."""
    example = _ROOT / "openscenario_schemas" / "examples" / "three-drivers.json"
    document = json.loads(example.read_text())
    document["max_sim_time"] = 8.0
    document["weather_changes"] = [{"time": 4.0, "weather": {"wetness": 50.0}}]
    crashing = document["ego_vehicles"][2]
    crashing["initial_speed"] = 12.0
    start = crashing["route"][0]
    crashing["reference_path"] = [
        {"time": time, "x": start["x"], "y": start["y"], "yaw": 0.0, "speed": 0.0}
        for time in (0.0, 5.0)
    ]
    document["npc_obstacles"] = [
        {
            "id": "bin",
            "model": "static.prop.container",
            "location": {"x": start["x"], "y": start["y"] - 8.0},
        }
    ]
    document["friction_patches"] = [
        {"id": "ice", "location": start, "length": 4.0, "width": 2.0, "friction": 0.9}
    ]
    path = tmp_path_factory.mktemp("trace") / "first.trace.parquet"
    networks = NetworkCatalogue(shipped_networks())
    report = perform(
        RunSpec(
            run_id="first",
            document=canonical_json(validate_data(document, networks, None).scenario),
            trace_path=str(path),
        ),
        WorkerSetup(shipped_networks=shipped_networks()),
    )
    assert report.status is RunStatus.FINISHED
    return path


def _listed(heading: str) -> list[tuple[str, ...]]:
    """Returns the rows of the first table below a heading, cells without code marks."""
    section = _PAGE.split(f"{heading}\n", 1)[1]
    table = re.search(r"^\|.*?(?=\n\n|\Z)", section, re.DOTALL | re.MULTILINE)
    assert table is not None
    return [
        tuple(cell.strip().strip("`") for cell in line.strip("|").split("|"))
        for line in table.group().splitlines()[2:]
    ]


def test_the_columns_are_those_of_a_real_file(trace_file: Path) -> None:
    schema = pq.read_schema(trace_file)
    written = [(f.name, str(f.type)) for f in schema if not f.name.startswith("log:")]
    logged = {str(f.type) for f in schema if f.name.startswith("log:")}
    *columns, log = [row[:2] for row in _listed("## Columns")]
    assert columns == written
    assert {log} == {("log:NAME", type_) for type_ in logged}


def test_the_metadata_are_those_of_a_real_file(trace_file: Path) -> None:
    header = json.loads(pq.read_schema(trace_file).metadata[b"drivora_trace"])
    assert {row[0] for row in _listed("## Metadata")} == set(_entries(header, ""))


def _entries(value: Any, name: str) -> Iterator[str]:
    """Yields the places of all values, as the page writes them."""
    if isinstance(value, dict):
        named = name in (
            "lights.changes",
            "meta.agents",
            "meta.agents.NAME.parameters",
            "meta.versions",
            "lane_ids",
        )
        for key, inner in value.items():
            part = "NAME" if named else key
            yield from _entries(inner, f"{name}.{part}" if name else part)
    elif isinstance(value, list):
        for inner in value:
            yield from _entries(inner, f"{name}[]")
    else:
        yield name


@pytest.mark.parametrize(
    ("heading", "names"),
    [
        ("### Roles", [str(role) for role in Role]),
        ("### Ends", [str(end) for end in TerminalEvent]),
        ("### Lights", [str(int(light)) for light in Light]),
    ],
)
def test_the_values_are_all_that_there_are(heading: str, names: list[str]) -> None:
    assert [row[0] for row in _listed(heading)] == names


def test_the_version_is_the_one_that_is_written(trace_file: Path) -> None:
    header = json.loads(pq.read_schema(trace_file).metadata[b"drivora_trace"])
    assert header["schema_version"] == SCHEMA_VERSION
    assert f"`schema_version` is {SCHEMA_VERSION}." in _PAGE


def test_the_example_reads_the_route(
    trace_file: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "results").symlink_to(trace_file.parent)
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", _PAGE, re.DOTALL)
    names: dict[str, Any] = {}
    exec(code, names)
    line, route = names["line"], names["route"]
    assert line[-1].tolist() == route["goal"]
    lengths = np.hypot(*np.diff(line, axis=0).T)
    assert lengths.sum() == pytest.approx(route["length"])


def test_rows_are_as_the_page_says(trace_file: Path) -> None:
    table = pq.read_table(trace_file)
    header = json.loads(table.schema.metadata[b"drivora_trace"])
    step, actor = (table.column(name).to_numpy() for name in ("step", "actor"))
    order = step.astype(np.int64) * len(header["actors"]) + actor
    assert (np.diff(order) > 0).all()
    assert np.allclose(table.column("time").to_numpy(), step * header["step_length"])
    egos = len(header["egos"])
    assert egos == 3
    for ego in range(egos):
        assert np.count_nonzero(actor == ego) == header["steps"]
    others = actor >= egos
    assert others.any()
    for name in (*(f"ego_{col.name.lower()}" for col in EgoCol), "lane", "light"):
        column = table.column(name).is_valid().to_numpy()
        assert column.any(), name
        assert not column[others].any(), name
    assert table.column("x").is_valid().to_numpy()[others].all()
