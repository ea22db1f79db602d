from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.errors import SearchError, UnknownObjective
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.objective_choice import WEIGHTED_SUM, ObjectiveChoice, ObjectiveKind
from drivora_service.search.aims import Aim, aims_of
from drivora_service.search.components import Components
from drivora_service.search.tester import (
    Evaluation,
    EvaluationStatus,
    Proposal,
    TesterContext,
)
from drivora_service.search.testers.behavexplor.tester import BEHAVEXPLOR, BehavexplorTester
from drivora_service.search.testers.lawbreaker.archive import Archive as LawArchive
from drivora_service.search.testers.samota.archive import Archive
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract
from tests.own_parts import TESTER

MARGIN = Aim(name="margin", target=0.0, scale=2.0)
OPEN = Aim(name="metric")
ROWS = ((0.0,) * 64,)


def told(**objectives: float | None) -> Evaluation:
    return Evaluation(
        number=0,
        proposal=Proposal(values=np.zeros(len(small_space())), origin="initial"),
        status=EvaluationStatus.JUDGED,
        measurement=Measurement(objectives=objectives),
    )


def test_a_share_is_0_at_the_target_and_negative_beyond_it() -> None:
    assert [MARGIN.share(value) for value in (-2.0, 0.0, 2.0)] == [-0.5, 0.0, 0.5]
    assert [MARGIN.is_reached(value) for value in (-1.0, 0.0, 0.1)] == [True, True, False]


def test_without_a_target_nothing_is_reached() -> None:
    assert not OPEN.is_reached(-1e9)
    assert 0.0 < OPEN.share(-1e6) < OPEN.share(0.0) == 0.5 < OPEN.share(1e6) < 1.0


def test_weights_make_one_aim() -> None:
    one = ObjectiveChoice(name="a", kind=ObjectiveKind.ORACLE, member="a", target=1.0, scale=3.0)
    assert aims_of([one]) == (Aim(name="a", target=1.0, scale=3.0),)
    assert aims_of([replace(one, weight=1.0), one]) == (Aim(name=WEIGHTED_SUM),)


def test_a_tester_of_one_objective_refuses_several() -> None:
    context = TesterContext(space=small_space(), random=np.random.default_rng(1), budget=1)
    assert context.objective("own") == "own"
    assert replace(context, aims=(MARGIN,)).objective("own") == "margin"
    with pytest.raises(SearchError, match="chose margin, metric"):
        replace(context, aims=(MARGIN, OPEN)).objective("own")


def test_samota_covers_a_chosen_objective_at_its_target() -> None:
    archive = Archive(0.0, (MARGIN, OPEN))
    archive.update(1, {"margin": 0.5, "metric": -9.0, "lane_centre": -1.0})
    assert not archive.covered
    archive.update(2, {"margin": -0.5, "metric": -9.0, "lane_centre": -1.0})
    assert archive.covered == {"margin"}


def test_lawbreaker_breeds_towards_chosen_objectives_instead_of_laws() -> None:
    archive = LawArchive((), (MARGIN, OPEN))
    individual = archive.individual(told(margin=2.0, metric=-1.0, **{"law/1": -1.0}))
    assert individual is not None
    assert individual.costs == {"margin": 0.5, "metric": 0.25}
    archive.add(individual)
    assert not archive.covered
    near = archive.individual(told(margin=-1.0, metric=0.0))
    assert near is not None
    archive.add(near)
    assert archive.covered == {"margin"}


def test_behavexplor_takes_the_share_as_the_degree_of_violation() -> None:
    context = TesterContext(
        space=small_space(), random=np.random.default_rng(1), budget=9, aims=(MARGIN,)
    )
    tester = BEHAVEXPLOR.create(context, BEHAVEXPLOR.parameters(), Components())
    assert isinstance(tester, BehavexplorTester)
    for number, proposal in enumerate(tester.ask(4)):
        measurement = Measurement(
            objectives={"margin": 2.0, "violation_degree": 0.9},
            features={"windows": ROWS},
        )
        tester.tell(replace(told(), number=number, proposal=proposal, measurement=measurement))
    assert {seed.degree for seed in tester.corpus} == {0.5}


def test_the_scores_of_an_evaluation_refuse_unknown_names() -> None:
    judged = replace(told(margin=1.0), scores={"min_gap": 0.1})
    assert judged.scores["min_gap"] == 0.1
    with pytest.raises(UnknownObjective, match="did you mean 'min_gap'"):
        judged.scores.get("min_gop")
    # One that was not judged has none.
    assert replace(told(), status=EvaluationStatus.FAILED).scores == {}


class TestOwnClimber(TesterContract):
    plugin = TESTER
    budget = 60


def test_the_contract_finds_a_tester_that_asks_for_what_is_not_measured() -> None:
    class Misspelt(TesterContract):
        plugin = replace(
            TESTER,
            create=lambda context, parameters, components: TESTER.create(
                replace(context, aims=(Aim(name="min_ttc"),)), parameters, components
            ),
        )

    with pytest.raises(UnknownObjective, match="'min_ttc'"):
        Misspelt().test_it_asks_only_for_objectives_that_its_feedback_measures()
