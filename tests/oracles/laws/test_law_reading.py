from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml
from jsonschema import Draft202012Validator

from drivora_service.errors import InvalidDocument
from drivora_service.oracles.laws.law import Law
from drivora_service.oracles.laws.law_reading import read_laws
from drivora_service.oracles.laws.law_schema import (
    laws_schema,
    schema_path,
    schema_text,
    shipped_laws,
)
from drivora_service.oracles.laws.sources import LawSource, read_law_source, read_law_sources
from drivora_service.oracles.verdict import Severity

GOOD = """\
version: "1.0"
laws:
  - name: keeps_two_seconds
    title: Two seconds
    source: Rule of thumb
    description: Follows too near.
    severity: minor
    parameters:
      gap: {value: 2.0, unit: s, meaning: The time that is kept.}
    formula: |
      always (
        eventually[0:3] (leader_gap >= gap * speed)
      )
"""


def read(text: str) -> tuple[Law, ...]:
    return read_laws(LawSource(file="own.yaml", data=text.encode()))


def mistakes(text: str) -> list[str]:
    with pytest.raises(InvalidDocument) as refused:
        read(text)
    return [problem.message for problem in refused.value.problems]


def test_a_law_is_read() -> None:
    (law,) = read(GOOD)
    assert (law.name, law.title, law.severity) == (
        "keeps_two_seconds",
        "Two seconds",
        Severity.MINOR,
    )
    assert law.text == "always (eventually[0:3] (leader_gap >= gap * speed))"
    assert dict(law.thresholds) == {"gap": 2.0}
    assert [str(case) for case in law.sub_violations] == ["always[0:3] (leader_gap < gap * speed)"]
    assert law.file == "own.yaml"
    assert len(law.sha256) == 64


@pytest.mark.parametrize(
    ("style", "place"),
    [
        ("formula: always (speeed < 3)", "10:22"),
        ("formula: 'always (speeed < 3)'", "10:23"),
        ('formula: "always (speeed < 3)"', "10:23"),
        ("formula: |\n      always (\n        speeed < 3\n      )", "12:9"),
        ("formula: >-\n      always (speed < 3 and\n        speeed < 3)", "12:9"),
        ("formula: always (speed < 3\n      and speeed < 3)", "11:11"),
        ("formula: |\n\n\n      # é: a comment\n      always (speeed < 3)", "14:15"),
    ],
)
def test_the_place_of_a_mistake_in_a_formula(style: str, place: str) -> None:
    head = GOOD[: GOOD.index("    formula:")]
    (message, *_) = mistakes(head + "    " + style + "\n")
    assert message.startswith(f"own.yaml:{place}: unknown name 'speeed'"), message


def test_a_formula_that_ends_too_soon() -> None:
    text = GOOD.replace("      )\n", "").replace("gap * speed)", "gap * speed)  ")
    assert mistakes(text)[0].startswith(
        "own.yaml:12:52: found the end of the formula; expected ')'"
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("name: keeps", "name: Keeps-", "own.yaml:3:5: found text 'Keeps-_two_seconds'"),
        ("unit: s", "unit: h", "own.yaml:9:25: found the unit 'h'; allowed are m, s and rad"),
        ("gap: {value", "speed: {value", "own.yaml:9:7: found 'speed', which is a signal"),
        ("gap: {value", "until: {value", "own.yaml:9:7: found 'until', which is a word"),
        ("title: Two seconds\n    ", "", "own.yaml:3:5: 'title' is missing"),
        ("severity: minor", "severity: bad", "own.yaml:7:5: found text 'bad'"),
        ("severity: minor", "color: red", "own.yaml:7:5: 'color' is unknown here"),
        ("value: 2.0", "value: .inf", "own.yaml:9:13: found inf; only finite"),
        ("value: 2.0", "value: two", "own.yaml:9:13: found text 'two'; a number is needed"),
        ("gap * speed", "2.5", "own.yaml:11:7: the formula does not name the parameter gap"),
        ('version: "1.0"', 'version: "2.0"', "own.yaml:1:1: found text '2.0'; allowed: '1.0'"),
    ],
)
def test_mistakes_are_named_with_line_and_column(old: str, new: str, message: str) -> None:
    found = mistakes(GOOD.replace(old, new, 1))
    assert any(one.startswith(message) for one in found), found


def test_all_mistakes_are_named_at_once() -> None:
    second = GOOD[GOOD.index("  - name") :].replace("two", "three").replace("speed)", "sped)")
    found = mistakes(GOOD.replace("[0:3]", "[3:0]") + second)
    assert [one.partition(": ")[0] for one in found] == ["own.yaml:12:20", "own.yaml:23:46"]


def test_a_name_is_used_once() -> None:
    found = mistakes(GOOD + GOOD[GOOD.index("  - name") :])
    assert found == [
        "own.yaml:14:5: found the law 'keeps_two_seconds' again (first at /laws/0); names are "
        "unique"
    ]


def test_too_many_ways_to_violate_a_law() -> None:
    parts = " and ".join(f"(speed < {k} or turning)" for k in range(6))
    text = GOOD[: GOOD.index("    parameters")] + f"    formula: always ({parts})\n"
    (message,) = mistakes(text)
    assert message.startswith("own.yaml:8:14: the law can be violated in 63 ways; at most 32")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "laws: []",
        "- a",
        "laws: [1]",
        "laws: {",
        "a: &x 1",
        "\x00",
        "laws:\n\t- a",
        "x: !!python/none",
    ],
)
def test_what_is_no_law_file_is_refused(text: str) -> None:
    assert mistakes(text)


def test_bytes_that_are_no_text_are_refused() -> None:
    with pytest.raises(InvalidDocument, match="UTF-8"):
        read_laws(LawSource(file="own.yaml", data=b"\xff\xfe\xff"))


def test_files_of_a_folder(tmp_path: Path) -> None:
    for name in ("b.yaml", "a.yml", ".hidden.yaml", "notes.txt"):
        (tmp_path / name).write_text(GOOD)
    assert [source.file for source in read_law_sources(tmp_path)] == ["a.yml", "b.yaml"]
    assert read_law_sources(tmp_path / "nowhere") == ()
    assert read_law_sources(None) == ()


def test_a_file_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "folder.yaml").mkdir()
    (source,) = read_law_sources(tmp_path)
    with pytest.raises(InvalidDocument, match="cannot be read"):
        read_laws(source)


def test_the_schema_is_current_and_describes_the_shipped_laws() -> None:
    assert schema_path().read_text() == schema_text()
    validator = Draft202012Validator(laws_schema())
    for example in laws_schema()["examples"]:
        validator.validate(example)
        read(json.dumps(example))
    files = sorted(shipped_laws().glob("*.yaml"))
    assert files
    for path in files:
        validator.validate(yaml.safe_load(path.read_text()))
        assert read_laws(read_law_source(path))
