"""A comparison of two batches as text: cells of tables, and the whole as Markdown."""

from __future__ import annotations

from drivora_service.markdown_text import code_span, escape_markdown, escape_prose, table
from drivora_service.oracles.verdicts.failure_definition import DefinitionOrigin
from drivora_service.suites.paired.batch_comparison import (
    SIGNIFICANT,
    BatchComparison,
    ComparedBatch,
    FailureComparison,
    MetricComparison,
    PairResult,
    RunResult,
    WhichFails,
)
from drivora_service.suites.paired.standing_sentence import failure_test, probability

FAILURE_COLUMNS = ("failure", "A only", "B only", "both", "neither", "B-A [95%]", "p", "B is")
METRIC_COLUMNS = ("metric", "unit", "A", "B", "B-A [95%]", "p", "B is", "n")
FAILURES_OF_PAIR = "failures, A → B"
_FAILS = {
    WhichFails.A_ONLY: "A",
    WhichFails.B_ONLY: "B",
    WhichFails.BOTH: "both",
    WhichFails.NEITHER: "-",
}


def comparison_markdown(comparison: BatchComparison) -> str:
    """Writes a comparison as Markdown."""
    lines = ["# Two batches on the same scenarios", "", escape_markdown(comparison.sentence), ""]
    lines += [f"- {name}: {escape_markdown(line)}" for name, line in sides(comparison)]
    lines += [f"- {escape_markdown(line)}" for line in describe_differences(comparison)]
    lines += [f"- Note: {escape_prose(note)}" for note in comparison.notes]
    lines += ["", "## Failures", "", escape_markdown(how_to_read_failures(comparison)), ""]
    lines += table(FAILURE_COLUMNS, map(failure_cells, failure_rows(comparison)))
    lines += ["", "## Metrics", "", how_to_read_metrics(), ""]
    measured = [row for row in comparison.metrics if row.scenarios]
    lines += table(METRIC_COLUMNS, map(metric_cells, measured))
    unknown = [code_span(row.metric) for row in comparison.metrics if not row.scenarios]
    if unknown:
        lines += ["", f"Not measurable in any pair: {', '.join(unknown)}."]
    lines += ["", "## Pairs that tell A from B", ""]
    telling = discordant_pairs(comparison)
    rows = (pair_cells(comparison, pair) for pair in telling)
    lines += table(pair_columns(comparison), rows) if telling else ["None."]
    if comparison.left_out:
        lines += ["", "## Left out", ""]
        lines += table(
            ("scenario", "seed", "A", "B", "why"),
            (
                (one.scenario, str(one.seed), one.a or "-", one.b or "-", one.message)
                for one in comparison.left_out
            ),
        )
    return "\n".join(lines) + "\n"


def sides(comparison: BatchComparison) -> tuple[tuple[str, str], ...]:
    """Describes A and B, each after its letter."""
    return (("A", _side(comparison.a)), ("B", _side(comparison.b)))


def describe_differences(comparison: BatchComparison) -> tuple[str, ...]:
    """Names each agent, parameter and version in which A and B differ."""
    return tuple(
        f"{one.name}: {one.a or '-'} (A), {one.b or '-'} (B)" for one in comparison.differences
    )


_ORIGINS = {
    DefinitionOrigin.REQUEST: ", as asked here",
    DefinitionOrigin.POSTED: ", as defined where the runs were posted",
    DefinitionOrigin.DEFAULT: ", the default",
}


def how_to_read_failures(comparison: BatchComparison) -> str:
    """Explains the table of failures."""
    test = failure_test(has_repetitions=_has_repetitions(comparison))
    return (
        f"Failures are {comparison.definition.words}"
        f"{_ORIGINS[comparison.definition.origin]}. Numbers are scenarios; B-A is the difference "
        "of the shares of scenarios with a failure, below 0 if B fails less. p: "
        f"{test}, two-sided, corrected by Holm for all oracles where it is of one of them; B is "
        f"undecided unless p is below {SIGNIFICANT:g}."
    )


def how_to_read_metrics() -> str:
    """Explains the table of metrics."""
    return (
        "A and B are means over n scenarios, B-A the mean of the paired differences with its "
        "bootstrap interval. p is the test by flipped signs, corrected by Holm for all metrics "
        f"with a difference; B is undecided unless it is below {SIGNIFICANT:g}."
    )


def failure_rows(comparison: BatchComparison) -> tuple[FailureComparison, ...]:
    """Returns the rows of the table of failures: any of them, then by oracle."""
    return (comparison.failures, *comparison.by_oracle)


def failure_cells(row: FailureComparison) -> tuple[str, ...]:
    """Writes a row of the table of failures."""
    name = row.oracle.replace("_", " ") or "any"
    left_out = [
        f"{count} {why}"
        for count, why in (
            (row.not_measurable, "not measurable"),
            (row.not_counted, "not counted"),
        )
        if count
    ]
    if left_out:
        name += f" ({', '.join(left_out)})"
    counts = (row.a_only, row.b_only, row.both, row.neither)
    return (
        name,
        *map(str, counts),
        _with_interval(row.difference, row.low, row.high),
        probability(row.p_holm),
        str(row.judgement),
    )


def metric_cells(row: MetricComparison) -> tuple[str, ...]:
    """Writes a row of the table of metrics."""
    return (
        row.metric,
        row.unit,
        value(row.mean_a),
        value(row.mean_b),
        _with_interval(row.difference, row.low, row.high),
        probability(row.p_holm),
        str(row.judgement),
        str(row.scenarios),
    )


def discordant_pairs(comparison: BatchComparison) -> tuple[PairResult, ...]:
    """Returns the pairs in which A and B fail by other oracles, or only one fails."""
    return tuple(pair for pair in comparison.pairs if _oracles(pair.a) != _oracles(pair.b))


def pair_columns(comparison: BatchComparison) -> tuple[str, ...]:
    """Returns the heads of the table of pairs; the last column is prose."""
    names = (name.replace("_", " ") for name in _metric_names(comparison))
    measured = (f"{name} {side}" for name in names for side in "AB")
    seed = ("seed",) if _has_repetitions(comparison) else ()
    return ("scenario", *seed, "fails", "A", "B", *measured, FAILURES_OF_PAIR)


def pair_cells(comparison: BatchComparison, pair: PairResult) -> tuple[str, ...]:
    """Writes a row of the table of pairs."""
    both = (pair.a, pair.b)
    measured = (value(run.metrics[name]) for name in _metric_names(comparison) for run in both)
    seed = (str(pair.seed),) if _has_repetitions(comparison) else ()
    fails = _FAILS[pair.fails]
    failures = " → ".join(failures_in_words(run) for run in both)
    return (pair.scenario, *seed, fails, pair.a.run, pair.b.run, *measured, failures)


def failures_in_words(run: RunResult) -> str:
    """Names the failures of a run."""
    return ", ".join(one.oracle.replace("_", " ") for one in run.failures) or "none"


def value(number: float | None) -> str:
    """Writes a value of a metric; "-" if it is not measurable."""
    return "-" if number is None else f"{number:.4g}"


def _side(side: ComparedBatch) -> str:
    what = f" {side.title}," if side.title else ""
    judged = f"{side.finished} of {side.runs} runs finished"
    return f"{what} batch {side.batch} ({side.name or 'no name'}), {judged}".strip()


def _with_interval(number: float | None, low: float | None, high: float | None) -> str:
    if number is None:
        return "-"
    if low is None or high is None:
        return _format_signed(number)
    return f"{_format_signed(number)} [{_format_signed(low)}, {_format_signed(high)}]"


def _format_signed(number: float) -> str:
    return f"{number:+.3g}" if number else "0"


def _metric_names(comparison: BatchComparison) -> tuple[str, ...]:
    return tuple(comparison.pairs[0].a.metrics) if comparison.pairs else ()


def _has_repetitions(comparison: BatchComparison) -> bool:
    return len(comparison.pairs) > comparison.scenarios


def _oracles(run: RunResult) -> frozenset[str]:
    return frozenset(one.oracle for one in run.failures)
