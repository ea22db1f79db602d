"""Mutants that could not change the run of any ego are drawn again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.search.components import Components
from drivora_service.search.genes import GeneSpace
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.redrawing import Redrawing, without_effect
from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal, TesterContext
from drivora_service.search.testers.avfuzzer.search import AVFUZZER
from drivora_service.search.testers.behavexplor.tester import BEHAVEXPLOR
from drivora_service.search.testers.doppeltest.tester import DOPPELTEST
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract
from tests.search.testers import test_avfuzzer, test_behavexplor, test_doppeltest

PARENT = np.array([1.0, 2.0, 3.0])
IDLE = np.array([False, True, False])


def drawer(*mutants: tuple[float, ...]) -> Callable[[], FloatArray]:
    drawn: Iterator[FloatArray] = iter(np.array(values) for values in mutants)
    return lambda: next(drawn)


def second_of_ten(one: FloatArray, other: FloatArray) -> bool:
    """Of the third gene only the tens have an effect."""
    return bool(one[0] == other[0] and one[1] == other[1] and one[2] // 10 == other[2] // 10)


def draw(
    *mutants: tuple[float, ...],
    alike: Callable[[FloatArray, FloatArray], bool] | None = None,
    attempts: int = 5,
) -> tuple[list[float], int]:
    redrawing = Redrawing(decode_alike=alike, attempts=attempts)
    values, redrawn = redrawing.draw(drawer(*mutants), PARENT, IDLE)
    return values.tolist(), redrawn


def test_a_mutant_with_an_effect_is_taken_at_once() -> None:
    assert draw((1.0, 2.0, 4.0)) == ([1.0, 2.0, 4.0], 0)
    assert draw((1.0, 7.0, 4.0), alike=lambda _one, _other: False) == ([1.0, 7.0, 4.0], 0)


def test_mutants_of_genes_without_effect_are_drawn_again() -> None:
    assert draw((1.0, 7.0, 3.0), (1.0, 8.0, 3.0), (9.0, 7.0, 3.0)) == ([9.0, 7.0, 3.0], 2)


def test_so_are_mutants_that_change_nothing() -> None:
    assert draw((1.0, 2.0, 3.0), (1.0, 2.0, 4.0)) == ([1.0, 2.0, 4.0], 1)


def test_so_are_mutants_that_decode_to_the_same_scenario() -> None:
    assert draw((1.0, 2.0, 5.0), (1.0, 2.0, 12.0), alike=second_of_ten) == ([1.0, 2.0, 12.0], 1)


def test_both_reasons_together_suffice() -> None:
    assert draw((1.0, 9.0, 5.0), (1.0, 9.0, 12.0), alike=second_of_ten) == ([1.0, 9.0, 12.0], 1)


def test_after_so_many_attempts_the_last_one_is_taken() -> None:
    mutants = [(1.0, 10.0 + k, 3.0) for k in range(4)]
    assert draw(*mutants, attempts=3) == ([1.0, 13.0, 3.0], 3)
    assert draw(mutants[0], attempts=0) == ([1.0, 10.0, 3.0], 0)


def evaluated(number: int, proposal: Proposal, **others: Any) -> Evaluation:
    return Evaluation(number=number, proposal=proposal, status=EvaluationStatus.JUDGED, **others)


def test_the_genes_of_an_evaluation_are_flagged() -> None:
    flags = without_effect(
        evaluated(0, Proposal(values=np.zeros(4), origin="initial"), without_effect=(1, 3))
    )
    assert flags.tolist() == [False, True, False, True]


def weather(space: GeneSpace) -> BoolArray:
    flags = np.zeros(len(space), dtype=np.bool_)
    flags[next(block.slice for block in space.blocks if block.name == "weather")] = True
    return flags


SUITES = (
    (AVFUZZER, test_avfuzzer.TestAvfuzzer()),
    (BEHAVEXPLOR, test_behavexplor.TestBehavexplor()),
    (DOPPELTEST, test_doppeltest.TestDoppelTest()),
)


@pytest.mark.parametrize(("plugin", "suite"), SUITES, ids=lambda one: getattr(one, "name", ""))
def test_the_testers_draw_mutants_again(plugin: TesterPlugin[Any], suite: TesterContract) -> None:
    """All genes but those of the weather are without effect: mutants change the weather."""
    space = small_space()
    idle = tuple(np.flatnonzero(~weather(space)).tolist())

    def mutants(redraws: int) -> tuple[list[Proposal], list[Proposal]]:
        context = TesterContext(space=space, random=np.random.default_rng(4), budget=150)
        tester = plugin.create(context, plugin.parameters(redraws=redraws), Components())

        def judge(number: int, proposal: Proposal) -> Evaluation:
            measured = suite.measure(space.to_unit(proposal.values))
            return evaluated(number, proposal, measurement=measured, without_effect=idle)

        told = [one.proposal for one in suite.play(tester, 150, 4, judge)]
        made = [one for one in told if one.origin in ("mutation", "local mutation")]
        return made, [
            one for one in made if (one.values != told[one.parents[0]].values)[weather(space)].any()
        ]

    made, effective = mutants(200)
    assert len(made) > 10
    # DoppelTest does not vary the weather: it tries to, and goes on.
    assert effective == ([] if plugin is DOPPELTEST else made)
    # The noise of BehAVExplor moves half of all magnitudes, and so most often the weather as well.
    assert sum(one.redrawn for one in made) > (5 if plugin is BEHAVEXPLOR else len(made))
    made, effective = mutants(0)
    assert len(effective) < (len(made) if plugin is BEHAVEXPLOR else 0.7 * len(made))
    assert not any(one.redrawn for one in made)
