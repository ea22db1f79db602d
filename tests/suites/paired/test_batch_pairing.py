"""Two batches compared: tables, rows and what is left out, by hand-made runs."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from drivora_service.errors import UnknownName
from drivora_service.oracles.verdict import Answer, Outcome
from drivora_service.oracles.verdicts.failure_definition import (
    Counted,
    DefinitionOrigin,
    FailureDefinition,
    KnownFailure,
)
from drivora_service.runs.run_report import RunStatus
from drivora_service.suites.paired.batch_comparison import (
    BatchComparison,
    PairedJudgement,
    WhichFails,
)
from drivora_service.suites.paired.batch_comparison_files import write_batch_comparison
from drivora_service.suites.paired.batch_comparison_text import (
    comparison_markdown,
    discordant_pairs,
    how_to_read_failures,
)
from drivora_service.suites.paired.batch_pairing import compare_runs
from drivora_service.suites.paired.failure_rules import Rules, Unfinished
from drivora_service.suites.paired.mcnemar import mcnemar_p
from drivora_service.suites.paired.pairing import LeftOutReason
from tests.suites.paired.samples import batch, lost, run, verdict


def failing(a_only: int, b_only: int, both: int, neither: int) -> BatchComparison:
    """The comparison of batches with so many scenarios of each kind, all by collisions."""
    kinds = [(1, 0)] * a_only + [(0, 1)] * b_only + [(1, 1)] * both + [(0, 0)] * neither
    sides = (
        [
            run(f"s{n}", fails=["collision"] * kind[side], agent=agent)
            for n, kind in enumerate(kinds)
        ]
        for side, agent in ((0, "idm"), (1, "sumo-krauss"))
    )
    first, second = sides
    return compare_runs(batch(first), batch(second))


def test_the_table_and_the_sentence() -> None:
    found = failing(12, 4, 7, 77)
    table = found.failures
    assert (table.a_only, table.b_only, table.both, table.neither) == (12, 4, 7, 77)
    assert (table.runs_a, table.runs_b, found.scenarios) == (19, 11, 100)
    assert table.p == pytest.approx(mcnemar_p(12, 4))
    assert table.difference == pytest.approx(-0.08)
    assert found.sentence == (
        "B (sumo-krauss) fails in 4 of 100 scenarios in which A (idm) does not, and A in 12 in "
        "which B does not (p 0.077, McNemar's exact test): no difference is shown."
    )
    (collision,) = found.by_oracle
    assert (collision.oracle, collision.a_only, collision.p_holm) == ("collision", 12, table.p)


@pytest.mark.parametrize(
    ("table", "end", "judgement"),
    [
        ((20, 4, 0, 0), "B fails less.", PairedJudgement.BETTER),
        ((0, 8, 0, 0), "B fails more.", PairedJudgement.WORSE),
        (
            (0, 0, 3, 2),
            "fail in the same 3 of 5 scenarios: no difference is shown.",
            PairedJudgement.UNDECIDED,
        ),
        ((0, 0, 0, 1), "do not fail in any of 1 scenario.", PairedJudgement.UNDECIDED),
    ],
)
def test_other_sentences(
    table: tuple[int, int, int, int], end: str, judgement: PairedJudgement
) -> None:
    found = failing(*table)
    assert found.sentence.endswith(end)
    assert found.failures.judgement is judgement


def test_oracles_are_corrected_together_and_not_measurable_ones_left_out() -> None:
    first = [run(f"s{n}", fails=["collision", "red_light"][: 1 + n % 2]) for n in range(8)]
    second = [run(f"s{n}") for n in range(8)]
    unknown = verdict("red_light", Outcome.NOT_MEASURABLE, at_fault=None)
    second[1] = run("s1", passes=("red_light",), verdicts=(unknown,))
    found = compare_runs(batch(first), batch(second))
    collision, red_light = found.by_oracle
    # The run in which red_light was not measurable has no verdict on collisions at all.
    assert (collision.a_only, collision.not_measurable) == (7, 1)
    assert (red_light.a_only, red_light.neither, red_light.not_measurable) == (3, 4, 1)
    assert collision.p_holm == pytest.approx(2 * mcnemar_p(7, 0))
    assert red_light.p_holm == pytest.approx(max(collision.p_holm, mcnemar_p(3, 0)))
    assert found.failures.a_only == 8


def test_nothing_to_judge_counts_as_passed() -> None:
    first = [run(f"s{n}", fails=["red_light"]) for n in range(8)]
    second = [run(f"s{n}", passes=("red_light",)) for n in range(8)]
    idle = verdict("red_light", Outcome.NOT_APPLICABLE, at_fault=None)
    third = [run(f"s{n}", passes=("red_light",), verdicts=(idle,)) for n in range(8)]
    (passed,) = compare_runs(batch(first), batch(second)).by_oracle
    assert compare_runs(batch(first), batch(third)).by_oracle == (passed,)
    assert (passed.a_only, passed.not_measurable) == (8, 0)


def test_repeated_seeds_count_as_one_scenario() -> None:
    def seeds(label: str, fails: list[int]) -> list[object]:
        return [run(label, seed=n, fails=["collision"] * fail) for n, fail in enumerate(fails)]

    first = [*seeds("often", [1, 1, 1]), *seeds("tie", [1, 0, 0]), *seeds("never", [0, 0, 0])]
    second = [*seeds("often", [1, 0, 0]), *seeds("tie", [0, 1, 0]), *seeds("never", [0, 0, 0])]
    found = compare_runs(batch(first), batch(second))  # type: ignore[arg-type] # runs of the test
    table = found.failures
    assert (table.a_only, table.b_only, table.both, table.neither) == (1, 0, 1, 1)
    assert (found.scenarios, len(found.pairs), table.runs_a, table.runs_b) == (3, 9, 4, 2)
    cells = {(pair.scenario, pair.seed): (pair.fails, pair.scenario_fails) for pair in found.pairs}
    assert cells["often", 0] == (WhichFails.BOTH, WhichFails.A_ONLY)
    assert cells["tie", 1] == (WhichFails.B_ONLY, WhichFails.BOTH)
    assert "fails more often than A in none of 3 scenarios" in found.sentence
    assert "(p 1.00, exact sign test over scenarios)" in found.sentence
    assert "p: exact sign test over scenarios, two-sided" in how_to_read_failures(found)
    assert any("9 pairs of 3 scenarios" in note for note in found.notes)


def test_runs_are_counted_by_what_was_defined_for_them() -> None:
    """A suite that counts every violation, as its gate does, and scenarios that say otherwise."""
    every = FailureDefinition(counts=Counted.ANY)
    of_others = (verdict("collision", at_fault=False, avoidable=Answer.YES),)
    first = [run("a", definition=every), run("b")]
    second = [
        run("a", verdicts=of_others, definition=every),
        run("b", verdicts=of_others),
    ]
    found = compare_runs(batch(first), batch(second))
    assert (found.failures.runs_a, found.failures.runs_b) == (0, 1)
    assert (found.a.preventable, found.b.preventable) == (0, 2)
    assert (found.definition.origin, found.definition.counts) == (DefinitionOrigin.POSTED, None)
    assert found.definition.definitions == 2
    asked = Rules(definition=FailureDefinition(counts=Counted.PREVENTABLE))
    assert compare_runs(batch(first), batch(second), rules=asked).failures.runs_b == 2


def test_batches_with_different_definitions_are_counted_by_the_default() -> None:
    of_others = (verdict("collision", at_fault=False),)
    first = [run("a", verdicts=of_others, definition=FailureDefinition(counts=Counted.ANY))]
    second = [run("a", verdicts=of_others)]
    found = compare_runs(batch(first), batch(second))
    assert (found.failures.runs_a, found.failures.runs_b) == (0, 0)
    assert found.definition.origin is DefinitionOrigin.DEFAULT
    (note,) = (one for one in found.notes if "different definitions" in one)
    assert "A counts any, and B counts accountable (in a)" in note


def test_oracles_that_are_asked_for_count_by_what_was_defined_for_the_runs() -> None:
    of_others = (verdict("collision", at_fault=False),)
    every = FailureDefinition(counts=Counted.ANY, oracles=("collision", "red_light"))
    runs = [run("a", verdicts=of_others, definition=every), run("b", fails=["red_light"])]
    asked = Rules(oracles=("collision",))
    found = compare_runs(batch(runs[:1]), batch(runs[:1]), rules=asked)
    assert (found.failures.runs_a, found.failures.runs_b) == (1, 1)
    assert (found.definition.counts, found.definition.oracles) == (Counted.ANY, ("collision",))
    assert any("`counts` is any, as defined where the runs were posted" in n for n in found.notes)
    # They must have it in common.
    mixed = compare_runs(batch(runs), batch(runs), rules=asked)
    assert (mixed.failures.runs_a, mixed.definition.counts) == (0, Counted.ACCOUNTABLE)
    (note,) = (one for one in mixed.notes if "different `counts`" in one)
    assert "(accountable, any). The default, accountable, counts here" in note


def test_an_oracle_that_does_not_count_is_not_called_unmeasurable() -> None:
    every = FailureDefinition(counts=Counted.ANY)
    other = FailureDefinition(oracles=("tailgating",))
    unknown = (verdict("collision", Outcome.NOT_MEASURABLE, at_fault=None),)
    runs = [
        run("s", fails=["collision"], definition=every),
        run("t", fails=["collision"], passes=("tailgating",), definition=other),
        run("u", passes=(), verdicts=unknown, definition=every),
    ]
    found = compare_runs(batch(runs), batch(runs))
    (collision,) = found.by_oracle
    assert (collision.both, collision.not_counted, collision.not_measurable) == (1, 1, 1)
    assert "| collision (1 not measurable, 1 not counted) |" in comparison_markdown(found)


def test_what_differs_between_the_definitions_is_named() -> None:
    oracles = ("blocked", "collision", "red_light", "speeding", "tailgating")
    known = KnownFailure(oracle="off_road", agents=("idm",), reason="issue 3")
    first = [run(n, definition=FailureDefinition(oracles=(n,))) for n in oracles]
    second = [
        *first[:-1],
        run("tailgating", definition=FailureDefinition(oracles=("off_road",), known=(known,))),
    ]
    found = compare_runs(batch(first), batch(second))
    (note,) = (one for one in found.notes if "different definitions" in one)
    assert note.startswith(
        "A and B were posted with different definitions of a failure: A counts tailgating, and B "
        "counts off road; known in B only: off road by idm (in tailgating). The default counts"
    )


def test_what_is_known_of_an_ads_is_no_failure_of_its_runs() -> None:
    known = KnownFailure(oracle="collision", agents=("idm",), reason="issue 3")
    definition = FailureDefinition(known=(known,))
    runs = [
        run("a", fails=["collision"], agent=name, definition=definition) for name in ("idm", "nmpc")
    ]
    found = compare_runs(batch(runs[:1]), batch(runs[1:]))
    assert (found.failures.runs_a, found.failures.runs_b) == (0, 1)


def test_a_scenario_under_two_labels_counts_once() -> None:
    first = [run("x", content="c", seed=1, fails=["collision"]), run("x-2", content="c", seed=2)]
    second = [run("x", content="c", seed=1), run("x-2", content="c", seed=2)]
    assert compare_runs(batch(first), batch(second)).scenarios == 1


def test_runs_without_a_judgement_count_as_asked_and_are_named() -> None:
    first = batch([run("hung"), run("late"), run("waits")])
    second = batch(
        [
            lost("hung", RunStatus.AGENT_FAILED, "agent_hung"),
            lost("late", RunStatus.TIMED_OUT, "wall_time_limit"),
            lost("waits", RunStatus.QUEUED),
        ]
    )
    found = compare_runs(first, second)
    assert (found.failures.b_only, found.scenarios) == (1, 1)
    assert [row.oracle for row in found.by_oracle] == ["agent_failed"]
    told = {one.scenario: (one.reason, one.message) for one in found.left_out}
    assert told == {
        "late": (LeftOutReason.NOT_JUDGED, "B: timed out (wall time limit)"),
        "waits": (LeftOutReason.NOT_ENDED, "B: queued"),
    }
    assert found.notes[0] == (
        "2 left out (1: a run has not ended; 1: a run ended without a judgement)"
    )
    everything = compare_runs(first, second, rules=Rules(unfinished=Unfinished.ALL))
    assert (everything.failures.b_only, len(everything.left_out)) == (2, 1)
    nothing = compare_runs(first, second, rules=Rules(unfinished=Unfinished.NONE))
    assert (nothing.scenarios, len(nothing.left_out)) == (0, 3)
    assert nothing.sentence.startswith("Nothing is compared")


def test_metrics_are_paired_by_scenario() -> None:
    random = np.random.default_rng(1)
    scores_a = random.normal(70.0, 20.0, 30)
    scores_b = scores_a + random.normal(3.0, 1.0, 30)
    first = [
        run(f"s{n}", metrics={"driving_score": a, "max_drac_mps2": 3.0, "comfort[ego]": 1.0})
        for n, a in enumerate(scores_a)
    ]
    second = [
        run(f"s{n}", metrics={"driving_score": b, "max_drac_mps2": 2.0 if n % 3 else None})
        for n, b in enumerate(scores_b)
    ]
    found = compare_runs(batch(first), batch(second))
    score, drac = found.metrics
    assert (score.metric, score.unit, score.scenarios) == ("driving_score", "%", 30)
    assert score.mean_a == pytest.approx(scores_a.mean())
    assert score.difference == pytest.approx((scores_b - scores_a).mean())
    assert score.low is not None
    assert score.high is not None
    # The spread of the scenarios is no part of a paired interval.
    assert 2.0 < score.low < 3.0 < score.high < 4.0
    assert score.judgement is PairedJudgement.BETTER
    assert (drac.pairs, drac.not_measurable, drac.difference) == (20, 10, -1.0)
    assert drac.judgement is PairedJudgement.BETTER
    assert found.pairs[0].a.metrics.keys() == {"driving_score"}
    chosen = compare_runs(batch(first), batch(second), metrics=["max_drac_mps2", "max_drac_mps2"])
    assert [row.metric for row in chosen.metrics] == ["max_drac_mps2"]
    assert chosen.pairs[0].b.metrics == {"max_drac_mps2": None}
    with pytest.raises(UnknownName, match="unknown metric 'beauty'; known: driving_score"):
        compare_runs(batch(first), batch(second), metrics=["beauty"])


def test_scenarios_have_the_same_weight_whatever_their_seeds() -> None:
    first = [run("one", metrics={"comfort": 0.0})]
    first += [run("many", seed=n, metrics={"comfort": 0.0}) for n in range(9)]
    second = [run("one", metrics={"comfort": 1.0})]
    second += [run("many", seed=n, metrics={"comfort": 0.0}) for n in range(9)]
    (row,) = compare_runs(batch(first), batch(second)).metrics
    assert (row.pairs, row.scenarios, row.mean_b, row.difference) == (10, 2, 0.5, 0.5)


def test_what_only_describes_a_run_is_neither_better_nor_worse() -> None:
    first = [run(f"s{n}", metrics={"duration_s": 20.0 + n}) for n in range(20)]
    second = [run(f"s{n}", metrics={"duration_s": 18.0 + n}) for n in range(20)]
    (row,) = compare_runs(batch(first), batch(second)).metrics
    assert row.judgement is PairedJudgement.LOWER


def test_in_what_the_batches_differ_is_named() -> None:
    first = [run("s", parameters={"gap": 2.0, "speed": 1}, versions={"drivora": "1", "x": "1"})]
    second = [run("s", parameters={"gap": 2.5, "speed": 1}, versions={"drivora": "2"})]
    found = compare_runs(batch(first, name="old"), batch(second, name="new"))
    told = {one.name: (one.a, one.b) for one in found.differences}
    assert told == {"idm.gap": ("2.0", "2.5"), "version of drivora": ("1", "2")}
    assert (found.a.title, found.b.title) == ("idm with gap 2.0", "idm with gap 2.5")
    versions = compare_runs(
        batch([run("s", versions={"drivora": "1"})], name="old"),
        batch([run("s", versions={"drivora": "2"})], name="new"),
    )
    assert (versions.a.title, versions.b.title) == ("drivora 1", "drivora 2")
    same = compare_runs(batch([run("s")], name="old"), batch([run("s")], name="new"))
    assert (same.a.title, same.differences) == ("old", ())
    assert "the batches do not differ in agents, parameters or versions" in same.notes


def test_a_long_title_gives_way_to_the_name_of_the_batch() -> None:
    long = {f"parameter_{n}": n for n in range(9)}
    changed = {name: value + 1 for name, value in long.items()}
    found = compare_runs(
        batch([run("s", parameters=long)], name="old"),
        batch([run("s", parameters=changed)], name="new"),
    )
    assert (found.a.title, found.b.title) == ("old", "new")


def test_few_scenarios_and_equal_traces_are_told() -> None:
    same = [run("s", trace_sha256="t"), run("u", trace_sha256="u")]
    other = [run("s", trace_sha256="t"), run("u", trace_sha256="v")]
    found = compare_runs(batch(same), batch(other))
    assert "in 1 of 2 pairs both runs are the same, step by step" in found.notes
    assert any("so few scenarios (2)" in note for note in found.notes)


def test_what_b_has_made_worse_comes_first() -> None:
    found = failing(1, 2, 1, 1)
    assert [pair.fails for pair in found.pairs] == [
        WhichFails.B_ONLY,
        WhichFails.B_ONLY,
        WhichFails.A_ONLY,
        WhichFails.BOTH,
        WhichFails.NEITHER,
    ]
    assert len(discordant_pairs(found)) == 3


def test_pairs_that_fail_by_other_oracles_tell_a_from_b() -> None:
    first, second = [run("s", fails=["collision"])], [run("s", fails=["red_light"])]
    found = compare_runs(batch(first), batch(second))
    assert found.failures.both == 1
    assert len(discordant_pairs(found)) == 1


def test_files_hold_what_was_compared(tmp_path: Path) -> None:
    first = [run("a|b", fails=["collision"], metrics={"comfort": 0.5}), run("lonely")]
    second = [run("a|b", metrics={"comfort": None})]
    found = compare_runs(batch(first), batch(second), metrics=["comfort"])
    written = write_batch_comparison(found, tmp_path / "out")
    assert [path.name for path in written] == [
        "comparison.md",
        "failures.csv",
        "metric-differences.csv",
        "pairs.csv",
        "left-out.csv",
    ]
    assert written[0].read_text() == comparison_markdown(found)
    assert r"| a\|b | A | " in written[0].read_text()
    assert "p: McNemar's exact test, two-sided, corrected by Holm" in written[0].read_text()
    assert "p is the test by flipped signs, corrected by Holm" in written[0].read_text()
    tables = {
        path.stem: list(csv.DictReader(path.read_text().splitlines())) for path in written[1:]
    }
    assert [row["a_only"] for row in tables["failures"]] == ["1", "1"]
    assert (
        tables["metric-differences"][0]["metric"],
        tables["metric-differences"][0]["mean_a"],
    ) == (
        "comfort",
        "",
    )
    (pair,) = tables["pairs"]
    assert (pair["scenario"], pair["failures_a"], pair["failures_b"]) == ("a|b", "collision", "")
    assert (pair["comfort_a"], pair["comfort_b"], pair["same_trace"]) == ("0.5", "", "false")
    (left,) = tables["left-out"]
    assert (left["reason"], left["scenario"], left["b"]) == ("only_a", "lonely", "")


def test_labels_in_csv_files_are_no_formulas(tmp_path: Path) -> None:
    shared = run("=cmd()", metrics={"driving_score": -1.5}), run("=cmd()", fails=["collision"])
    write_batch_comparison(
        compare_runs(batch([shared[0], run("+only")]), batch([shared[1]])), tmp_path
    )
    named = {}
    for name in ("pairs", "left-out"):
        with (tmp_path / f"{name}.csv").open(newline="") as file:
            named[name] = [row["scenario"] for row in csv.DictReader(file)]
    assert named == {"pairs": ["'=cmd()"], "left-out": ["'+only"]}
    # Numbers stay numbers.
    assert ",-1.5," in (tmp_path / "pairs.csv").read_text()
