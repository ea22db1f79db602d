"""Study files: paths, folders and patterns, and problems at the places of the file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.studies.study_files import read_study_file
from drivora_service.errors import InvalidDocument, Problem


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("seeds/b", "seeds/a", "other/a", "other/late-1"):
        path = tmp_path / f"{name}.json"
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(SCENARIO))
    return tmp_path


def study(folder: Path, scenarios: str) -> Path:
    path = folder / "study.yaml"
    path.write_text(f"name: s\nscenarios: {scenarios}\nmethods: [{{name: random}}]\n")
    return path


def test_folders_patterns_and_files_stand_for_their_scenarios(folder: Path) -> None:
    found = read_study_file(
        study(
            folder,
            "[seeds, 'other/late-*.json', {file: other/a.json, label: mine, space: {walkers: 2}},"
            " {file: other/a.json}]",
        )
    )
    listed = found.content["scenarios"]
    assert [one["label"] for one in listed] == ["a", "b", "late-1", "mine", "a-2"]
    assert all(one["document"] == SCENARIO for one in listed)
    assert listed[3]["space"] == {"walkers": 2}


def test_problems_are_shown_at_the_places_of_the_file(folder: Path) -> None:
    found = read_study_file(study(folder, "[seeds, {file: other/a.json, label: x}]"))
    error = InvalidDocument(
        (
            Problem(pointer="/scenarios/1/document/ego_vehicles/0", code="c", message="wrong"),
            Problem(pointer="/scenarios/2/label", code="c", message="again"),
            Problem(pointer="/methods/0/name", code="c", message="unknown"),
        )
    )
    shown = [(p.pointer, p.message) for p in found.in_file(error).problems]
    assert shown == [
        ("/scenarios/0", f"{folder / 'seeds' / 'b.json'}: /ego_vehicles/0: wrong"),
        ("/scenarios/1/label", "again"),
        ("/methods/0/name", "unknown"),
    ]


@pytest.mark.parametrize(
    ("scenarios", "pointer", "said"),
    [
        ("[nowhere.json]", "/scenarios/0", "there is no file"),
        ("[seeds, 'none-*.json']", "/scenarios/1", "no file matches 'none-*.json'"),
        ("[{file: 3}]", "/scenarios/0/file", "found no path"),
        ("[{file: seeds, label: x}]", "/scenarios/0/label", "stands for 2 scenarios"),
        ("[{file: seeds/a.json, document: {}}]", "/scenarios/0/document", "give one of them"),
    ],
)
def test_items_that_name_no_scenario_are_refused(
    folder: Path, scenarios: str, pointer: str, said: str
) -> None:
    with pytest.raises(InvalidDocument) as refused:
        read_study_file(study(folder, scenarios))
    (problem,) = refused.value.problems
    assert problem.pointer == pointer
    assert said in problem.message


def test_a_file_that_is_no_scenario_is_named(folder: Path) -> None:
    (folder / "seeds" / "b.json").write_text("{")
    with pytest.raises(InvalidDocument) as refused:
        read_study_file(study(folder, "[seeds]"))
    (problem,) = refused.value.problems
    assert problem.pointer == "/scenarios/0"
    assert f"{folder / 'seeds' / 'b.json'}: " in problem.message
