"""Every oracle, metric and objective describes itself."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from drivora_service.feedback.catalogue import BUILT_IN, FeedbackCatalogue
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.feedback.objective_descriptions import OBJECTIVES, law_objectives
from drivora_service.metrics.built_in_metrics import all_measured
from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.metric_descriptions import METRICS
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.laws.library import LawLibrary
from drivora_service.oracles.oracle_descriptions import (
    ORACLES,
    MeasureDescription,
    MeasureKind,
    ViolatedBy,
    find_description,
)
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace

REFERENCE = (Path(__file__).parents[2] / "docs/reference/oracles.md").read_text()
UNITS = {"", "1", "%", "m", "s", "s/m", "rad", "m/s", "m/s²", "m/s³", "rad/s", "rad/s²"}


def is_one_sentence(text: str) -> bool:
    return bool(re.fullmatch(r"[A-Z][^.]*(\.\d[^.]*)*\.", text))


@pytest.mark.parametrize("oracle", default_oracles(), ids=lambda oracle: oracle.name)
def test_every_oracle_describes_itself_and_its_thresholds(oracle: Any) -> None:
    told = find_description(oracle.name)
    assert told is not None
    assert is_one_sentence(told.definition)
    assert told.source
    assert (told.unit == "") == (told.violated_by is ViolatedBy.EVENT)
    assert set(told.unit.split(", ")) <= UNITS
    assert [one.name for one in told.thresholds] == [field.name for field in fields(oracle)]
    section = REFERENCE.partition(f"### `{oracle.name}`\n")[2].partition("\n##")[0]
    for one in told.thresholds:
        assert one.unit in UNITS - {""}
        assert is_one_sentence(one.meaning)
        assert one.source
        value = round(getattr(oracle, one.name), 3)
        assert f"| `{one.name}` | {value} |" in section, "the reference has the same threshold"


def test_only_oracles_that_there_are_are_described() -> None:
    assert [one.name for one in ORACLES] == [oracle.name for oracle in default_oracles()]
    assert find_description("of_a_package") is None


@pytest.mark.parametrize("told", [*METRICS, *OBJECTIVES], ids=lambda told: told.name)
def test_every_measure_is_told_in_full(told: MeasureDescription) -> None:
    assert is_one_sentence(told.definition)
    assert told.unit in UNITS - {""}
    assert told.source
    if told.kind is MeasureKind.METRIC:
        assert f"`{told.name}`" in REFERENCE
        for end, unit in {"_m": "m", "_s": "s", "_mps": "m/s", "_mps2": "m/s²"}.items():
            assert told.unit == unit or not told.name.endswith(end)


def test_every_metric_is_described_and_put_together_so() -> None:
    egos = [
        SyntheticEgo(id=name, motion=Motion.steady(0.0, y, steps=200, speed=5.0))
        for name, y in (("one", 0.0), ("two", 3.5))
    ]
    view = RunView(make_trace(egos), straight_road())
    verdicts = judge_all(view.trace, view.network, default_oracles(), view=view)
    judgements = tuple(Judgement.of(ego.id, verdicts) for ego in view.egos)
    measured = all_measured(view, judgements)
    assert [(one.name, one.combine.value) for one in measured] == [
        (told.name, told.several_egos) for told in METRICS
    ]


def test_every_objective_is_described() -> None:
    catalogue = FeedbackCatalogue()
    names = [
        (plugin.name, objective)
        for plugin in BUILT_IN
        for objective in catalogue.create(FeedbackChoice(name=plugin.name)).objectives
    ]
    assert {name for name, _ in names} | {"lawbreaker"} == set(catalogue.names())
    assert [(told.feedback, told.name) for told in OBJECTIVES] == names


def test_every_way_to_violate_a_law_is_described() -> None:
    library = LawLibrary()
    told = law_objectives([library.law(name) for name in library.names()])
    feedback = FeedbackCatalogue().create(FeedbackChoice(name="lawbreaker"))
    names = tuple(one.name for one in told)
    assert names == (*library.names(), *feedback.objectives)
    ways = [one for one in told if one.feedback == "lawbreaker"]
    assert tuple(one.name for one in ways) == feedback.objectives
    assert all(one.definition.startswith("The negated robustness") for one in ways)
