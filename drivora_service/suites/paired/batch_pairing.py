"""Comparing the runs of two batches on the same scenarios."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from drivora_service.runs.run_report import RunStatus
from drivora_service.store.runs.run_records import Batch
from drivora_service.suites.paired.batch_comparison import (
    BatchComparison,
    ComparedBatch,
    FailureComparison,
    LeftOut,
    PairResult,
    RunResult,
    WhichFails,
)
from drivora_service.suites.paired.definition_choice import choose_definition
from drivora_service.suites.paired.failure_counts import (
    JudgedPair,
    compare_failures,
    compare_oracles,
    scenario_fails,
)
from drivora_service.suites.paired.failure_rules import Judged, Rules
from drivora_service.suites.paired.metric_differences import (
    check_metrics,
    compare_metrics,
    metric_names,
)
from drivora_service.suites.paired.paired_runs import PairedRun
from drivora_service.suites.paired.pairing import (
    LeftOutReason,
    Pair,
    Pairing,
    Unpaired,
    pair_runs,
)
from drivora_service.suites.paired.pairing_notes import notes
from drivora_service.suites.paired.sides import agents_in_words, setting_differences, title
from drivora_service.suites.paired.standing_sentence import describe_outcome

HEADLINE = "driving_score"
"""Metric of the rows of pairs if none is chosen."""

_ORDER = (WhichFails.B_ONLY, WhichFails.A_ONLY, WhichFails.BOTH, WhichFails.NEITHER)
"""Order of the pairs: what B has made worse comes first."""
_WORDS = {
    LeftOutReason.ONLY_A: "B has no run of this scenario",
    LeftOutReason.ONLY_B: "A has no run of this scenario",
    LeftOutReason.SCENARIO_DIFFERS: "the scenarios of this label differ in more than the agent",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchRuns:
    """A batch and its stored runs, in the order of their submission."""

    batch: Batch
    runs: tuple[PairedRun, ...]


def compare_runs(
    first: BatchRuns,
    second: BatchRuns,
    *,
    rules: Rules = Rules(),  # noqa: B008 # frozen
    metrics: Sequence[str] = (),
) -> BatchComparison:
    """Compares two batches.

    Args:
        first: A.
        second: B.
        rules: What counts as a failure.
        metrics: Metrics to compare; empty: all.

    Raises:
        UnknownName: There is no such metric.
    """
    known = metric_names((*first.runs, *second.runs))
    check_metrics(metrics, known)
    chosen = tuple(dict.fromkeys(metrics))
    pairing = pair_runs(first.runs, second.runs)
    rules, definition, remarks = choose_definition(pairing.pairs, rules)
    judged, left_out = _judge_pairs(pairing, rules)
    scenarios = _by_scenario(judged)
    failures, by_oracle = compare_failures(scenarios), compare_oracles(scenarios)
    differences = setting_differences(first.runs, second.runs)
    agents = [
        agents_in_words(side.runs, other.runs, differences, is_b=is_b)
        for side, other, is_b in ((first, second, False), (second, first, True))
    ]
    titles = [
        title(words, differences, name=name, other_name=other, is_b=is_b)
        for words, name, other, is_b in (
            (agents[0], first.batch.name, second.batch.name, False),
            (agents[1], second.batch.name, first.batch.name, True),
        )
    ]
    shown = chosen or tuple(name for name in known if name == HEADLINE)
    return BatchComparison(
        sentence=describe_outcome(
            failures,
            a=titles[0],
            b=titles[1],
            has_repetitions=any(len(pairs) > 1 for pairs in scenarios.values()),
        ),
        a=_side(
            first,
            titles[0],
            agents[0],
            failing=failures.runs_a,
            preventable=sum(one.a.is_preventable for one in judged),
        ),
        b=_side(
            second,
            titles[1],
            agents[1],
            failing=failures.runs_b,
            preventable=sum(one.b.is_preventable for one in judged),
        ),
        definition=definition,
        unfinished=rules.unfinished,
        scenarios=len(scenarios),
        differences=differences,
        notes=(
            *remarks,
            *notes(scenarios, left_out, differences, has_runs=bool(first.runs and second.runs)),
        ),
        failures=failures,
        by_oracle=by_oracle,
        metrics=compare_metrics(
            {name: [one.pair for one in pairs] for name, pairs in scenarios.items()},
            chosen or known,
        ),
        pairs=_results(scenarios, judged, by_oracle, shown),
        left_out=left_out,
    )


def _judge_pairs(pairing: Pairing, rules: Rules) -> tuple[list[JudgedPair], tuple[LeftOut, ...]]:
    judged: list[JudgedPair] = []
    left_out = [_leave_out_unpaired(one) for one in pairing.unpaired]
    for pair in pairing.pairs:
        a, b = rules.judge(pair.a), rules.judge(pair.b)
        if a is None or b is None:
            left_out.append(_leave_out_unjudged(pair, a, b))
        else:
            judged.append(JudgedPair(pair=pair, a=a, b=b))
    return judged, tuple(left_out)


def _by_scenario(judged: Iterable[JudgedPair]) -> Mapping[str, Sequence[JudgedPair]]:
    found: dict[str, list[JudgedPair]] = {}
    for one in judged:
        found.setdefault(one.pair.a.scenario.content, []).append(one)
    return found


def _leave_out_unpaired(one: Unpaired) -> LeftOut:
    run = one.a or one.b
    assert run is not None  # one of them is there, for the type checker
    message = _WORDS.get(one.reason, "")
    if one.a is not None and one.b is not None and one.reason is LeftOutReason.SEED_DIFFERS:
        message = f"the seeds differ: {one.a.seed} and {one.b.seed}"
    return LeftOut(
        reason=one.reason,
        scenario=run.name,
        seed=run.seed,
        a=one.a.id if one.a else "",
        b=one.b.id if one.b else "",
        message=message,
    )


def _leave_out_unjudged(pair: Pair, a: Judged | None, b: Judged | None) -> LeftOut:
    missing = [
        (name, run) for name, run, judged in (("A", pair.a, a), ("B", pair.b, b)) if judged is None
    ]
    waits = any(not run.status.is_final for _, run in missing)
    return LeftOut(
        reason=LeftOutReason.NOT_ENDED if waits else LeftOutReason.NOT_JUDGED,
        scenario=pair.scenario,
        seed=pair.a.seed,
        a=pair.a.id,
        b=pair.b.id,
        message="; ".join(f"{name}: {_state(run)}" for name, run in missing),
    )


def _state(run: PairedRun) -> str:
    status = run.status.replace("_", " ")
    return f"{status} ({run.cause.replace('_', ' ')})" if run.cause else status


def _side(
    side: BatchRuns, words: str, agents: tuple[str, ...], *, failing: int, preventable: int
) -> ComparedBatch:
    return ComparedBatch(
        batch=side.batch.id,
        name=side.batch.name,
        title=words,
        created_at=side.batch.created_at,
        agents=agents,
        runs=len(side.runs),
        finished=sum(run.status is RunStatus.FINISHED for run in side.runs),
        failing=failing,
        preventable=preventable,
    )


def _results(
    scenarios: Mapping[str, Sequence[JudgedPair]],
    judged: Sequence[JudgedPair],
    by_oracle: Sequence[FailureComparison],
    metrics: Sequence[str],
) -> tuple[PairResult, ...]:
    frequent = {row.oracle: rank for rank, row in enumerate(by_oracle)}
    of_scenario = {content: scenario_fails(pairs) for content, pairs in scenarios.items()}

    def result(run: PairedRun, found: Judged) -> RunResult:
        failures = sorted(found.failures.values(), key=lambda one: frequent[one.oracle])
        return RunResult(
            run=run.id,
            status=run.status,
            failures=tuple(failures),
            metrics={name: run.metrics.get(name) for name in metrics},
        )

    results = [
        PairResult(
            scenario=one.pair.scenario,
            seed=one.pair.a.seed,
            town=one.pair.a.scenario.town,
            fails=one.fails,
            scenario_fails=of_scenario[one.pair.a.scenario.content],
            same_trace=one.pair.same_trace,
            a=result(one.pair.a, one.a),
            b=result(one.pair.b, one.b),
        )
        for one in judged
    ]
    return tuple(sorted(results, key=lambda row: _ORDER.index(row.fails)))
