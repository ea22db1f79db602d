"""DeepCollision: its contract, what it learns, and its checkpoints, without a simulator."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import Measurement
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.runs.adversary import (
    ACTIONS,
    DECISIONS,
    OBSERVATION_SIZE,
    OBSERVATIONS,
    action_values,
    layers_from_text,
)
from drivora_service.search.aims import Aim
from drivora_service.search.components import Components
from drivora_service.search.genes import GeneSpace, Part
from drivora_service.search.tester import (
    Evaluation,
    EvaluationStatus,
    Proposal,
    Tester,
    TesterContext,
)
from drivora_service.search.testers.deepcollision.parameters import (
    DeepcollisionParameters,
    Scene,
)
from drivora_service.search.testers.deepcollision.tester import DEEPCOLLISION, still_values
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.tester_contract import TesterContract

torch = pytest.importorskip("torch", reason="an extra: `adversary`")
pytest.importorskip("stable_baselines3", reason="an extra: `adversary`")

QUICK: Mapping[str, Any] = {"hidden": 16, "learning_starts": 40, "exploration_steps": 60}
DECISIONS_A_RUN = 4
GOOD = 7
"""The action that is rewarded in these tests, whatever the situation."""


def tables(random: np.random.Generator, actions: list[int]) -> dict[str, Any]:
    """What a run of some actions measures."""
    views = random.uniform(-1.0, 1.0, (len(actions) + 1, OBSERVATION_SIZE)).round(4)
    rows = [
        (float(action), 1.0 if action == GOOD else -1.0, float(k == len(actions) - 1))
        for k, action in enumerate(actions)
    ]
    return {OBSERVATIONS: tuple(map(tuple, views.tolist())), DECISIONS: tuple(rows)}


def played(number: int, proposal: Proposal) -> Evaluation:
    """Evaluates a proposal as its own adversary would play it."""
    source = proposal.adversary
    assert source is not None
    random = np.random.default_rng(source.seed)
    layers = layers_from_text(source.policy) if source.policy else ()
    actions = []
    for view in random.uniform(-1.0, 1.0, (DECISIONS_A_RUN, OBSERVATION_SIZE)):
        by_lot = random.random() < source.exploration or not layers
        lot = int(random.integers(len(ACTIONS)))
        actions.append(lot if by_lot else int(np.argmax(action_values(layers, view))))
    return Evaluation(
        number=number,
        proposal=proposal,
        status=EvaluationStatus.JUDGED,
        measurement=Measurement(objectives={"safety": 0.5}, features=tables(random, actions)),
    )


class TestDeepcollision(TesterContract):
    """The contract of testers, with a network small enough for it."""

    plugin = DEEPCOLLISION
    objectives = ("safety",)
    budget = 60

    def create(self, seed: int = 7, aims: tuple[Aim, ...] = ()) -> Tester:
        assert not aims, "it takes no other objectives"
        return make(seed=seed, space=self.space())

    def measure(self, unit: FloatArray) -> Measurement:
        measured = super().measure(unit)
        random = np.random.default_rng(int(1e6 * float(unit.sum())))
        features = tables(random, random.integers(len(ACTIONS), size=DECISIONS_A_RUN).tolist())
        return replace(measured, features=features)


def make(*, seed: int = 7, space: GeneSpace | None = None, kept: Any = None, **more: Any) -> Tester:
    context = TesterContext(
        space=space or small_space(),
        random=np.random.default_rng(seed),
        budget=100,
        checkpoints=kept,
    )
    return DEEPCOLLISION.create(context, DeepcollisionParameters(**{**QUICK, **more}), Components())


def play(tester: Tester, count: int, window: int = 3) -> list[Evaluation]:
    return TestDeepcollision().play(tester, count, window, played)


def share_of_good(evaluations: list[Evaluation]) -> float:
    rows = [row for e in evaluations if e.measurement for row in e.measurement.features[DECISIONS]]
    return float(np.mean([row[0] == GOOD for row in rows]))


def test_it_learns_which_action_is_rewarded_and_its_twin_does_not() -> None:
    told = play(make(learning_rate=0.003), 160)
    assert share_of_good(told[:20]) < 0.2
    assert share_of_good(told[-30:]) > 0.5
    blind = play(make(first_exploration=1.0, last_exploration=1.0), 160)
    assert share_of_good(blind[-30:]) < 0.2
    assert {e.proposal.origin for e in blind} == {"random"}


def test_exploration_falls_with_the_decisions() -> None:
    told = play(make(), 40, window=1)
    explored = [e.proposal.adversary.exploration for e in told if e.proposal.adversary]
    assert explored == pytest.approx(
        [0.1 + 0.9 * math.exp(-DECISIONS_A_RUN * k / 60) for k in range(40)]
    )
    assert told[0].proposal.adversary is not None
    assert (told[0].proposal.origin, told[0].proposal.adversary.policy) == ("random", "")
    assert told[1].proposal.origin == "policy"


def test_nothing_is_learnt_before_there_are_enough_transitions() -> None:
    told = play(make(learning_starts=80), 40, window=1)
    policies = [e.proposal.adversary.policy for e in told if e.proposal.adversary]
    assert len(set(policies[1:20])) == 1
    assert len(set(policies[20:])) == 20


def test_the_defaults_are_those_of_the_paper_s_code() -> None:
    tester = DEEPCOLLISION.create(
        TesterContext(space=small_space(), random=np.random.default_rng(1), budget=9),
        DeepcollisionParameters(first_exploration=0.5),
        Components(),
    )
    (proposal,) = tester.ask(1)
    assert proposal.adversary is not None
    shapes = [weights.shape for weights, _ in layers_from_text(proposal.adversary.policy)]
    assert shapes == [(200, OBSERVATION_SIZE), (200, 200), (len(ACTIONS), 200)]
    assert proposal.adversary.interval == 6.0


def test_learning_leaves_the_random_numbers_of_others_alone() -> None:
    np.random.seed(5)  # noqa: NPY002  # the generator that the learner keeps
    torch.manual_seed(5)
    expected = (np.random.random(), float(torch.rand(1)))  # noqa: NPY002  # the generator that the learner keeps
    np.random.seed(5)  # noqa: NPY002  # the generator that the learner keeps
    torch.manual_seed(5)
    play(make(), 30)
    assert (np.random.random(), float(torch.rand(1))) == expected  # noqa: NPY002  # the generator that the learner keeps


def test_the_scene_is_the_seed_scenario_in_fine_weather_or_drawn() -> None:
    space = small_space()
    still = still_values(space)
    assert space.within(still)
    for block in space.blocks:
        if block.is_optional:
            assert still[block.index("present")] == 0.0
        if block.part is Part.WEATHER:
            assert not still[block.slice].any()
    same = [e.proposal.values for e in play(make(), 10)]
    assert all(np.array_equal(values, still) for values in same)
    drawn = {e.proposal.values.tobytes() for e in play(make(scene=Scene.DRAWN), 10)}
    assert len(drawn) == 10


class Kept:
    """Checkpoints in memory, as the folder of a campaign keeps them."""

    def __init__(self) -> None:
        self.saved: dict[int, bytes] = {}
        self.told = 10**6

    def last(self) -> tuple[int, bytes] | None:
        known = [k for k in self.saved if k <= self.told]
        return (max(known), self.saved[max(known)]) if known else None

    def save(self, told: int, state: bytes) -> None:
        self.saved[told] = state


def told_again(tester: Tester, stored: list[Evaluation], count: int) -> list[Evaluation]:
    """Resumes: what is stored is told as it was, the rest is played."""

    def evaluate(number: int, proposal: Proposal) -> Evaluation:
        if number < len(stored):
            return replace(stored[number], proposal=replace(proposal, adversary=None))
        return played(number, proposal)

    return TestDeepcollision().play(tester, count, 3, evaluate)


@pytest.mark.parametrize("killed_after", [30, 31, 32, 37, 60])
def test_a_resumed_tester_goes_on_from_its_checkpoint(killed_after: int) -> None:
    kept = Kept()
    whole = play(make(kept=kept, checkpoint_every=30), 70)
    assert sorted(kept.saved) == [30, 60]
    kept.told = killed_after
    resumed = told_again(make(kept=kept, checkpoint_every=30), whole[:killed_after], 70)
    for old, new in zip(whole[killed_after:], resumed[killed_after:], strict=True):
        assert new.proposal.adversary == old.proposal.adversary
        assert new.measurement == old.measurement
    # On the way to the checkpoint nothing is trained again, so that there are no policies.
    before = [e.proposal.adversary for e in whole[5:28]]
    assert all(adversary is not None and adversary.policy for adversary in before)


def test_a_checkpoint_of_lost_evaluations_is_not_used_and_none_is_needed() -> None:
    kept = Kept()
    whole = play(make(kept=kept, checkpoint_every=30), 50)
    kept.told = 29
    assert kept.last() is None
    resumed = told_again(make(kept=kept, checkpoint_every=30), whole[:29], 50)
    assert [e.proposal.adversary for e in resumed[29:]] == [
        e.proposal.adversary for e in whole[29:]
    ]


def test_a_broken_checkpoint_is_named() -> None:
    kept = Kept()
    whole = play(make(kept=kept, checkpoint_every=30), 31)
    good = kept.saved[30]
    kept.saved[30] = b"?"
    with pytest.raises(SearchError, match="checkpoints"):
        make(kept=kept)
    kept.saved[30] = good[:-100]
    with pytest.raises(SearchError, match="checkpoints"):
        told_again(make(kept=kept), whole, 40)
    kept.saved = {20: good}
    with pytest.raises(SearchError, match="decisions"):
        told_again(make(kept=kept), whole, 40)


def test_tables_of_another_size_are_refused() -> None:
    tester = make()
    (proposal,) = tester.ask(1)
    bad = {OBSERVATIONS: ((0.0,),), DECISIONS: ((0.0, 1.0, 1.0),)}
    with pytest.raises(SearchError, match="needed are"):
        tester.tell(
            Evaluation(
                number=0,
                proposal=proposal,
                status=EvaluationStatus.JUDGED,
                measurement=Measurement(objectives={}, features=bad),
            )
        )
