"""Reading text safely."""

from __future__ import annotations

import pytest

from drivora_service.errors import InvalidDocument
from drivora_service.scenario.plain_data import MAX_DOCUMENT_BYTES, MAX_YAML_BYTES, plain_data


def refusal(data: str | bytes, language: str = "json") -> str:
    with pytest.raises(InvalidDocument) as caught:
        plain_data(data, language)  # type: ignore[arg-type]  # parametrised
    (problem,) = caught.value.problems
    return problem.code


@pytest.mark.parametrize(
    ("data", "code"),
    [
        ("", "not_json"),
        ("{", "not_json"),
        ("[]", "not_an_object"),
        ("1", "not_an_object"),
        (b"\xff{}", "not_utf8"),
        ("[" * 1_000_000, "too_deep"),
        ('{"a":' * 500_000, "too_deep"),
        ("a" * (MAX_DOCUMENT_BYTES + 1), "too_large"),
        ('{"a": [' + "0," * 600_000 + "0]}", "too_large"),
        ('{"a": ' + "9" * 5000 + "}", "not_json"),
        ('"' * 4_000_000, "not_json"),
        ('\\"' * 2_000_000, "not_json"),
    ],
)
def test_json_that_cannot_be_read(data: str | bytes, code: str) -> None:
    assert refusal(data) == code


@pytest.mark.parametrize(
    ("data", "code"),
    [
        ("", "not_an_object"),
        ("a: [", "not_yaml"),
        ("a: &x 1\nb: *x", "not_yaml"),
        ("a: !!python/object:os.system x", "not_yaml"),
        ("<<: {a: 1}", "not_yaml"),
        ("? [1]\n: 2", "not_yaml"),
        ("1: 2", "odd_key"),
        ("a: 2020-13-41", "not_yaml"),
        ("a: 1\n--- \nb: 2", "not_yaml"),
        ("\0", "not_yaml"),
        ("[" * 200_000, "too_deep"),
        ("a" * (MAX_YAML_BYTES + 1), "too_large"),
    ],
)
def test_yaml_that_cannot_be_read(data: str, code: str) -> None:
    assert refusal(data, "yaml") == code


@pytest.mark.parametrize(
    ("data", "pointer"),
    [
        ('{"a": {"b": NaN}}', "/a/b"),
        ('{"a": [1, 1e999]}', "/a/1"),
        ('{"a": {"b": 1, "b": 2}}', "/a/b"),
        ('{"a": "\\ud800"}', "/a"),
        ('{"a": "\\u0000"}', "/a"),
        ('{"a": 99999999999999999999}', "/a"),
    ],
)
def test_odd_values_have_a_place(data: str, pointer: str) -> None:
    _, problems = plain_data(data)
    assert [problem.pointer for problem in problems] == [pointer]


def test_yaml_repeats_and_dates_have_a_place() -> None:
    _, problems = plain_data("a:\n  b: 1\n  b: 2\nc: 2020-01-01\n", "yaml")
    assert {problem.pointer for problem in problems} == {"/a/b", "/c"}


def test_brackets_in_text_are_no_nesting() -> None:
    content, problems = plain_data('{"a": "' + "[" * 1000 + '\\"{{"}')
    assert content["a"].startswith("[[")
    assert not problems


def test_byte_order_marks_are_passed() -> None:
    assert plain_data(b'\xef\xbb\xbf{"a": 1}') == ({"a": 1}, [])


def test_values_that_contain_themselves_are_too_deep() -> None:
    loop: list[object] = []
    loop.append(loop)
    with pytest.raises(InvalidDocument, match="nesting"):
        plain_data({"a": loop})


def test_the_nul_character_is_refused_beside_any_other() -> None:
    for text in ("\0", "a\0b", "é\0", "\0漢"):
        _, (problem,) = plain_data({"extensions": text})
        assert (problem.pointer, problem.code) == ("/extensions", "odd_value")
