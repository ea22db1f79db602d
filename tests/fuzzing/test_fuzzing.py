"""Every parser withstands generated inputs, and those that once failed."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

from drivora_service.errors import InvalidDocument, Problem
from tests.fuzzing.findings import Session
from tests.fuzzing.harness import BadRefusal, Harness, check_refusal, has_place
from tests.fuzzing.harnesses import MODULES, harness_named
from tests.fuzzing.mutation import Mutator
from tests.fuzzing.running import run_sessions

CORPUS = Path(__file__).parent / "corpus"
INPUTS = 1000
"""Of each parser in CI; ``make fuzz`` takes more."""


@pytest.mark.parametrize("name", MODULES)
def test_seeds_are_read(name: str) -> None:
    harness = harness_named(name)
    for data in harness.seeds().values():
        assert len(data) <= harness.max_length
        assert harness.parse(data)


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, id=f"{path.parent.name}/{path.name}") for path in CORPUS.glob("*/*")],
)
def test_what_once_failed_is_read_or_refused(path: Path) -> None:
    harness_named(path.parent.name).parse(path.read_bytes())


@pytest.mark.slow(seconds=30)
@pytest.mark.skipif(
    importlib.util.find_spec("atheris") is None, reason="Atheris has no wheel for this platform"
)
def test_parsers_withstand_fuzzing(tmp_path: Path) -> None:
    outcomes = run_sessions(tuple(MODULES), inputs=INPUTS, seconds=60, seed=1, folder=tmp_path)
    assert {name: outcome.causes for name, outcome in outcomes.items() if outcome.causes} == {}
    for name, outcome in outcomes.items():
        assert outcome.inputs > outcome.read > 0, name
        assert outcome.coverage > 0, name


def test_mutations_are_repeatable_and_bounded() -> None:
    seeds = list(harness_named("scenario-json").seeds().values())
    made = [Mutator(seeds, ()).mutate(seeds[0], 500, number) for number in range(50)]
    assert made == [Mutator(seeds, ()).mutate(seeds[0], 500, number) for number in range(50)]
    assert max(map(len, made)) <= 500
    assert len(set(made)) > 40


def _broken(data: bytes) -> bool:
    if b"slash" in data:
        raise RecursionError("too deep")
    return True


def test_findings_are_kept_once_a_cause_with_the_smallest_input(tmp_path: Path) -> None:
    session = Session(harness=Harness(name="broken", parse=_broken, seeds=dict), folder=tmp_path)
    for data in (b"good", b"a long slash", b"slash", b"another slash"):
        session.run(data)
    ((cause, count),) = session.causes.items()
    assert cause.startswith("RecursionError in ")
    assert (session.inputs, count) == (4, 3)
    kept = {path.suffix: path.read_bytes() for path in tmp_path.iterdir()}
    assert kept[""] == b"slash"
    assert b"too deep" in kept[".txt"]


@pytest.mark.parametrize(
    ("place", "exists"),
    [
        ("", True),
        ("/a/0", True),
        ("/a/0/c", True),
        ("/a/1", True),
        ("/a/0/c/d", False),
        ("/b/c", False),
        ("a", False),
        ("/x~1y/1", True),
        ("/x/y", False),
    ],
)
def test_places_are_looked_up(place: str, exists: bool) -> None:
    assert has_place({"a": [{"b": 1}], "x/y": [1]}, place) is exists


def test_refusals_without_a_message_or_with_a_wrong_place_are_findings() -> None:
    content = {"a": 1}
    check_refusal(InvalidDocument((Problem(pointer="/a", code="c", message="m"),)), content)
    for problem in (
        Problem(pointer="/a", code="c", message=" "),
        Problem(pointer="/a/b/c", code="c", message="m"),
    ):
        with pytest.raises(BadRefusal):
            check_refusal(InvalidDocument((problem,)), content)
    with pytest.raises(BadRefusal):
        check_refusal(InvalidDocument(()))


if sys.platform == "linux":

    @pytest.mark.slow
    @pytest.mark.skipif(importlib.util.find_spec("atheris") is None, reason="needs Atheris")
    def test_a_session_reports_how_its_process_ended(tmp_path: Path) -> None:
        name = "no-such-parser"
        outcome = run_sessions([name], inputs=1, seconds=1, seed=1, folder=tmp_path)[name]
        assert outcome.inputs == 0
        assert "KeyError" in next(iter(outcome.causes))
