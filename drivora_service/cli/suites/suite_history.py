"""The history of suites as commands print it."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.cli.terminal.output import number, print_table, say
from drivora_service.store.suites.suite_records import (
    ScenarioState,
    SuiteEstimate,
    SuiteHistory,
    SuiteRunSummary,
    SuiteSummary,
)
from drivora_service.suites.reports.suite_report import STATES_IN_WORDS

_SIGNS: dict[ScenarioState, str] = {
    ScenarioState.FAILS_GATE: "F",
    ScenarioState.NOT_JUDGED: "?",
    ScenarioState.FLAKY: "f",
    ScenarioState.FAILS: "a",
    ScenarioState.KNOWN: "k",
    ScenarioState.PASSES: ".",
}


def print_suites(suites: Sequence[SuiteSummary]) -> None:
    """Prints a row a suite, with its last run."""
    print_table(
        "",
        ("suite", "runs", "last", "gate", "pass rate", "what it decided"),
        [
            (
                one.suite,
                str(one.runs),
                f"{one.last.created_at.astimezone():%Y-%m-%d %H:%M}",
                "failed" if one.last.fails else "passed",
                _share(one.last.pass_rate),
                one.last.sentence,
            )
            for one in suites
        ],
        wrap=("what it decided",),
    )


def print_history(history: SuiteHistory) -> None:
    """Prints a row a run, oldest first, and a line of signs for each scenario that did not pass."""
    print_table(
        "",
        ("run", "at", "agent", "gate", "pass rate", "score", "what it decided"),
        [_row(one) for one in history.runs],
        wrap=("what it decided",),
    )
    signs = [
        (one.scenario, "".join(_SIGNS[o.state] if o else " " for o in one.outcomes))
        for one in history.scenarios
    ]
    shown = [(name, line) for name, line in signs if set(line) - {".", " "}]
    if shown:
        print_table("", ("scenario", "oldest to newest"), shown, cut=("scenario",))
        say(", ".join(f"{sign} {STATES_IN_WORDS[state]}" for state, sign in _SIGNS.items()))


def _row(run: SuiteRunSummary) -> tuple[str, ...]:
    return (
        run.id,
        f"{run.created_at.astimezone():%Y-%m-%d %H:%M}",
        run.configuration or run.agent or "-",
        "failed" if run.fails else "passed",
        _share(run.pass_rate),
        "-" if run.score is None else number(run.score.mean),
        run.sentence,
    )


def _share(rate: SuiteEstimate) -> str:
    mean = f"{100.0 * rate.mean:.0f} %"
    if rate.low is None or rate.high is None:
        return mean
    return f"{mean} ({100.0 * rate.low:.0f} to {100.0 * rate.high:.0f})"
