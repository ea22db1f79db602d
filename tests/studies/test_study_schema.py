"""The JSON Schema of studies: current, documented, and of what is read."""

from __future__ import annotations

import copy
from pathlib import Path

import jsonschema
import pytest
import yaml

from drivora_service.cli.studies.study_files import read_study_file
from drivora_service.scenario.scenario_schema import schema_directory
from drivora_service.studies.study_schema import schema_path, schema_text, study_schema
from tests.studies.example_study import study_content

EXAMPLES = sorted((schema_directory() / "examples" / "studies").glob("*.yaml"))


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    schema = study_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_the_committed_file_is_current() -> None:
    assert schema_path().read_text() == schema_text(), "run `make schema`"


def test_examples_fit(validator: jsonschema.Draft202012Validator) -> None:
    validator.validate(study_content())
    for example in study_schema()["examples"]:
        validator.validate(example)
    assert EXAMPLES
    for path in EXAMPLES:
        validator.validate(yaml.safe_load(path.read_text()))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: str(path.stem))
def test_shipped_studies_name_files_that_exist(path: Path) -> None:
    assert read_study_file(path).content["scenarios"]


def test_what_is_wrong_does_not_fit(validator: jsonschema.Draft202012Validator) -> None:
    for key, value in (("methods", []), ("repetitions", 0), ("scenarios", [{"file": ""}])):
        content = copy.deepcopy(study_content())
        content[key] = value
        with pytest.raises(jsonschema.ValidationError):
            validator.validate(content)
