"""Oracles of installed packages: found, listed, and not trusted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import OracleError, UnknownName
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.oracles.installed_oracles import InstalledOracle
from drivora_service.oracles.laws.library import LawLibrary
from drivora_service.oracles.verdict import Oracle, Outcome, Verdict
from drivora_service.oracles.verdicts.verdict_json import plain_verdict
from drivora_service.testing.oracle_contract import OracleContract
from drivora_service.testing.traces import Motion, make_trace
from tests.oracles.foreign_oracles import MOODS, Moody, TopSpeed
from tests.oracles.installing import PACKAGE, install_oracles
from tests.oracles.judging import ROAD, on_lane

BUILT_IN = tuple(oracle.name for oracle in default_oracles())
LAWS = LawLibrary().names()
GARBAGE = {
    "nothing": "answered a NoneType; allowed: a tuple of Verdict",
    "list": "answered a list; allowed: a tuple",
    "nobody": "answered nothing for ego 'nobody'",
    "words": "answered with a str; allowed: a tuple of Verdict",
    "both": "answered 2 verdicts for ego 'both'; allowed: several if all are violations",
    "collision": "answered in the name of 'collision'; allowed: its own",
    "stranger": "answered for ego 'ego_9'; known: stranger",
    "silent": "answered without a message",
    "placeless": "answered a violation without time, step or location",
    "timeless": "answered a violation without time, step or location",
    "late": "answered a violation at step 1000000; the run has steps 0 to 49",
    "negative": "answered a violation at step -1; the run has",
    "unmeasured": "answered evidence 'violation_magnitude' that is no measure; allowed: a name",
    "unsure": "answered a verdict that cannot be stored: .*perhaps",
    "soon": "answered a verdict that cannot be stored: .*soon",
    "object": "answered a verdict that cannot be stored: .*a report cannot hold a object",
    "code": "answered a verdict that cannot be stored: .*a report cannot hold a function",
}


def fast_drive(ego: str = "ego") -> Trace:
    return make_trace([on_lane(id=ego, motion=Motion.steady(0.0, 0.0, steps=50, speed=9.0))])


def moody() -> InstalledOracle:
    return InstalledOracle(name="moody", package=PACKAGE, oracle=Moody())


class TestInstalledOracle(OracleContract):
    def make_oracle(self) -> Oracle:
        return InstalledOracle(name="top_speed", package=PACKAGE, oracle=TopSpeed())


def test_without_packages_there_are_the_built_in_ones_in_their_order() -> None:
    catalogue = OracleCatalogue()
    assert catalogue.names() == (*BUILT_IN, *LAWS)
    assert catalogue.oracles() == (*default_oracles(), *catalogue.laws())
    assert tuple(law.name for law in catalogue.laws()) == LAWS
    assert catalogue.load_installed() == ()
    assert not catalogue.has_others
    entry = catalogue.entry("off_road")
    assert entry.description == (
        "Violated where a corner of the ego is outside the drivable area (nuPlan), and not by "
        "noise."
    )
    assert dict(entry.thresholds) == {"tolerance": 0.3, "duration": 0.3, "severe_distance": 0.5}
    assert (entry.package, entry.reason) == ("", "")


def test_an_unknown_name_is_reported_with_the_known_ones() -> None:
    with pytest.raises(UnknownName, match=r"oracle 'crash'; known: .*collision"):
        OracleCatalogue().oracle("crash")
    with pytest.raises(UnknownName, match="oracle 'crash'"):
        OracleCatalogue().entry("crash")


def test_installed_oracles_judge_after_the_others_by_their_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_oracles(tmp_path, monkeypatch, "top_speed", "moody", "collision")
    catalogue = OracleCatalogue()
    assert catalogue.names() == (*BUILT_IN, *LAWS, "moody", "top_speed")
    assert catalogue.has_others
    verdicts = judge_all(fast_drive(), ROAD, catalogue.oracles())
    own = (*default_oracles(), *catalogue.laws())
    assert verdicts[:-2] == judge_all(fast_drive(), ROAD, own)
    assert [(v.oracle, v.outcome) for v in verdicts[-2:]] == [
        ("moody", Outcome.VIOLATED),
        ("top_speed", Outcome.VIOLATED),
    ]
    # A package that calls its oracle like a built-in one changes nothing.
    assert catalogue.entry("collision").package == ""
    entry = catalogue.entry("top_speed")
    assert (entry.package, entry.description) == (PACKAGE, "an oracle of a package")
    assert dict(entry.thresholds) == {"limit": 5.0}


def test_thresholds_are_listed_as_json_has_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_oracles(tmp_path, monkeypatch, "peculiar")
    thresholds = dict(OracleCatalogue().entry("peculiar").thresholds)
    assert thresholds == {"limit": 5.0, "table": "<class 'numpy.int64'>", "never": None}


@pytest.mark.parametrize(
    ("point", "message"),
    [
        ("gone = oracles_that_are_gone:plugin", "cannot be loaded: ModuleNotFoundError"),
        ("not_a_plugin", "is a TopSpeed; allowed: OraclePlugin"),
        ("misnamed", "is the oracle 'other'"),
        ("liar", "has the name 'top_speed'"),
        ("unmade", "raised RuntimeError when it was made: no such file"),
        ("judgeless", "is a str, which has no method `judge`"),
        ("Shouting", "names in snake case of at most 60"),
    ],
)
def test_an_oracle_that_cannot_be_used_is_told_of_with_its_package(
    point: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_oracles(tmp_path, monkeypatch, "top_speed", point)
    catalogue = OracleCatalogue()
    name = point.partition(" ")[0]
    for _ in range(2):
        with pytest.raises(OracleError, match=message) as told:
            catalogue.load_installed()
        assert f"oracle {name!r} of the package {PACKAGE!r}" in str(told.value)
        assert told.value.cause == "oracle_plugin"
    assert catalogue.entry(name).reason == str(told.value)
    assert catalogue.entry(name).package == PACKAGE
    assert catalogue.oracle("top_speed").name == "top_speed"


@pytest.mark.parametrize(("mood", "kind"), [("raises", "ZeroDivisionError"), ("leaves", "System")])
def test_an_oracle_that_raises_is_named_with_its_traceback(mood: str, kind: str) -> None:
    with pytest.raises(OracleError, match=rf"oracle 'moody' of the package .* raised {kind}") as e:
        moody().judge(RunView(fast_drive(mood), ROAD))
    assert e.value.cause == "oracle_raised"
    assert f"in {mood}" in e.value.log


@pytest.mark.parametrize("mood", GARBAGE)
def test_an_answer_that_is_none_is_named(mood: str) -> None:
    with pytest.raises(OracleError, match=rf"(?s)oracle 'moody' .* {GARBAGE[mood]}") as told:
        moody().judge(RunView(fast_drive(mood), ROAD))
    assert told.value.cause == "oracle_invalid_verdict"


def test_every_mood_is_tried() -> None:
    assert {*GARBAGE, "raises", "leaves", "writes"} == set(MOODS)


def test_verdicts_hold_nothing_but_pythons_own_types() -> None:
    numbers: dict[str, Any] = {
        "time": np.float32(0.5),
        "step": np.int64(10),
        "location": (np.float64(1.0), np.float64(2.0)),
        "at_fault": np.bool_(True),
        "evidence": {"speeds": np.array([1.0, np.nan]), "name": np.str_("x")},
    }
    given = Verdict(oracle="o", ego="e", outcome=Outcome.VIOLATED, message="m", **numbers)
    plain = plain_verdict(given)
    assert plain == Verdict(
        oracle="o",
        ego="e",
        outcome=Outcome.VIOLATED,
        message="m",
        time=0.5,
        step=10,
        location=(1.0, 2.0),
        at_fault=True,
        evidence={"speeds": [1.0, None], "name": "x"},
    )
    assert [type(value) for value in (plain.time, plain.step, plain.at_fault)] == [float, int, bool]
