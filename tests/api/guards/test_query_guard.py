from __future__ import annotations

import jsonschema
import pytest

from tests.api.conftest import Offline


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("/api/v1/jobs?stauts=finished", "'stauts'; did you mean 'status'? Allowed: "),
        ("/api/v1/batches?name=x", "'name'; allowed: limit, page_token"),
        ("/api/v1/networks/tee-town?full=1", "'full'; this operation has none"),
    ],
)
def test_a_parameter_that_there_is_not_is_refused(offline: Offline, path: str, said: str) -> None:
    answer = offline.client.get(path)
    assert answer.status_code == 422
    (problem,) = answer.json()["problems"]
    assert problem["code"] == "unknown_query_parameter"
    assert said in problem["message"]


def test_every_unknown_one_is_named(offline: Offline) -> None:
    problems = offline.client.get("/api/v1/jobs?one=1&two=2&limit=5").json()["problems"]
    assert [problem["message"].split("'")[1] for problem in problems] == ["one", "two"]


def test_a_batch_is_not_posted_under_a_misspelt_seed(offline: Offline) -> None:
    answer = offline.client.post("/api/v1/batches?sede=3", json=[])
    assert "did you mean 'seed'?" in answer.json()["problems"][0]["message"]
    assert offline.client.get("/api/v1/jobs?limit=5&status=queued").status_code == 200


def test_nul_is_refused_in_every_text_and_the_document_says_so(offline: Offline) -> None:
    paths = offline.client.get("/api/v1/openapi.json").json()["paths"]
    seen = 0
    for path, methods in paths.items():
        for parameter in methods.get("get", {}).get("parameters", ()):
            schema = parameter["schema"]
            if parameter["in"] != "query" or schema.get("type") != "string" or "enum" in schema:
                continue
            assert not jsonschema.Draft202012Validator(schema).is_valid("a\0b"), parameter
            answer = offline.client.get(
                path.replace("{", "").replace("}", ""), params={parameter["name"]: "a\0b"}
            )
            assert answer.status_code == 422, parameter
            seen += 1
    assert seen >= 10
