"""Pairing: properties that hold for any two batches, and the cases that the reader is told of."""

from __future__ import annotations

import random
from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from drivora_service.suites.paired.paired_runs import PairedRun
from drivora_service.suites.paired.pairing import LeftOutReason, Pairing, pair_runs
from tests.suites.paired.samples import run

RUNS = st.builds(
    run,
    st.sampled_from(["", "left", "right"]),
    content=st.sampled_from(["x", "y", "z"]),
    seed=st.integers(0, 2),
)
BATCHES = st.lists(RUNS, max_size=12)


def identity(one: PairedRun) -> tuple[str, int]:
    return one.scenario.content, one.seed


def sides(pairing: Pairing) -> tuple[list[str], list[str]]:
    left_out = pairing.unpaired
    a = [pair.a.id for pair in pairing.pairs] + [one.a.id for one in left_out if one.a]
    b = [pair.b.id for pair in pairing.pairs] + [one.b.id for one in left_out if one.b]
    return a, b


@given(BATCHES, BATCHES)
def test_every_run_is_in_one_pair_or_named_as_left_out(
    first: list[PairedRun], second: list[PairedRun]
) -> None:
    a, b = sides(pair_runs(first, second))
    assert Counter(a) == Counter(one.id for one in first)
    assert Counter(b) == Counter(one.id for one in second)


@given(BATCHES, BATCHES)
def test_pairs_drive_the_same_and_as_many_as_can_be_are_made(
    first: list[PairedRun], second: list[PairedRun]
) -> None:
    pairing = pair_runs(first, second)
    assert all(identity(pair.a) == identity(pair.b) for pair in pairing.pairs)
    mine, theirs = Counter(map(identity, first)), Counter(map(identity, second))
    assert len(pairing.pairs) == (mine & theirs).total()


@given(BATCHES, BATCHES)
def test_a_pair_has_one_label_wherever_both_batches_have_it(
    first: list[PairedRun], second: list[PairedRun]
) -> None:
    def key(one: PairedRun) -> tuple[str, str, int]:
        return (one.label, *identity(one))

    alike = sum(key(pair.a) == key(pair.b) for pair in pair_runs(first, second).pairs)
    assert alike == (Counter(map(key, first)) & Counter(map(key, second))).total()


@given(BATCHES, BATCHES)
def test_the_other_way_round_everything_is_mirrored(
    first: list[PairedRun], second: list[PairedRun]
) -> None:
    mirrored = {
        LeftOutReason.ONLY_A: LeftOutReason.ONLY_B,
        LeftOutReason.ONLY_B: LeftOutReason.ONLY_A,
    }
    one, other = pair_runs(first, second), pair_runs(second, first)
    assert len(one.pairs) == len(other.pairs)
    there = Counter(left.reason for left in other.unpaired)
    here = Counter(left.reason for left in one.unpaired)
    assert here == Counter({mirrored.get(name, name): count for name, count in there.items()})


@given(BATCHES, st.integers(0, 1000))
def test_a_batch_in_another_order_has_the_same_pairs(runs: list[PairedRun], seed: int) -> None:
    # Runs with the same label, scenario and seed are matched in their order.
    different = list({(one.label, *identity(one)): one for one in runs}.values())
    copies = [run(one.label, content=one.scenario.content, seed=one.seed) for one in different]
    shuffled = random.Random(seed).sample(copies, len(copies))
    expected = {(a.id, b.id) for a, b in zip(different, copies, strict=True)}
    found = pair_runs(different, shuffled)
    assert {(pair.a.id, pair.b.id) for pair in found.pairs} == expected
    assert not found.unpaired


def test_each_reason_is_named() -> None:
    first = [
        run("same", content="s"),
        run("seeds", content="t", seed=1),
        run("changed", content="u"),
        run("gone", content="w"),
        run("", content="bare"),
    ]
    second = [
        run("", content="s"),
        run("seeds", content="t", seed=2),
        run("changed", content="v"),
        run("new", content="y"),
        run("", content="bare"),
        run("", content="other"),
    ]
    pairing = pair_runs(first, second)
    assert [(pair.scenario, pair.b.label) for pair in pairing.pairs] == [
        ("same", ""),
        ("tee-town (bare)", ""),
    ]
    told = [
        (one.reason, one.a.name if one.a else one.b.name if one.b else "")
        for one in pairing.unpaired
    ]
    assert told == [
        (LeftOutReason.SEED_DIFFERS, "seeds"),
        (LeftOutReason.SCENARIO_DIFFERS, "changed"),
        (LeftOutReason.ONLY_A, "gone"),
        (LeftOutReason.ONLY_B, "new"),
        (LeftOutReason.ONLY_B, "tee-town (other)"),
    ]


def test_a_label_with_several_seeds_is_paired_by_seed() -> None:
    first = [run("s", seed=seed) for seed in (1, 2, 3)]
    second = [run("s", seed=seed) for seed in (3, 1, 4)]
    pairing = pair_runs(first, second)
    assert [(pair.a.seed, pair.b.seed) for pair in pairing.pairs] == [(1, 1), (3, 3)]
    (left,) = pairing.unpaired
    assert left.reason is LeftOutReason.SEED_DIFFERS


def test_the_same_trace_is_one_that_was_recorded() -> None:
    traces = [("", ""), ("t", "t"), ("t", "u")]
    first = [run(str(n), trace_sha256=a) for n, (a, _) in enumerate(traces)]
    second = [run(str(n), trace_sha256=b) for n, (_, b) in enumerate(traces)]
    assert [p.same_trace for p in pair_runs(first, second).pairs] == [False, True, False]
