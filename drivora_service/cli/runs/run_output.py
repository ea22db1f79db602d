"""Runs as commands print them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from drivora_service.api.schemas.runs import Run
from drivora_service.cli.terminal.output import note, number, print_table, say
from drivora_service.errors import Problem
from drivora_service.oracles.oracle_descriptions import SHARE
from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import IN_WORDS, Accountability, accountability
from drivora_service.oracles.verdicts.artefact_verdicts import find_artefact_verdicts
from drivora_service.oracles.verdicts.failure_facts import followed_oracle, full_message
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import adapter
from drivora_service.short_values import short_value
from drivora_service.store.runs.run_records import RunSummary

_FAULT = {
    Accountability.AVOIDABLE: "yes",
    Accountability.NOT_MEASURABLE: "yes",
    Accountability.UNAVOIDABLE: "yes, not avoidable",
    Accountability.UNDETERMINED: "undetermined",
    Accountability.NOT_JUDGED: "-",
    Accountability.PREVENTABLE: "no, but avoidable",
    Accountability.NOT_AT_FAULT: "no",
}
_LOG_LINES = 10
_NOTES = 10
"""Notes on scenarios that are printed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioResult:
    """The result of a scenario that was named on the command line.

    Attributes:
        scenario: Its name.
        run: Its run; ``None`` if it cannot be run.
        problems: Why it cannot be run.
        trace: File of its trace; "" if none was written.
        notes: Remarks of the importer and of validation.
    """

    scenario: str
    run: Run | None = None
    problems: tuple[Problem, ...] = ()
    trace: str = ""
    notes: tuple[str, ...] = ()

    @property
    def status(self) -> RunStatus:
        """Status of the run; of a scenario that cannot be run, ``invalid``."""
        return RunStatus.INVALID if self.run is None else self.run.status

    @property
    def violations(self) -> tuple[Verdict, ...]:
        """The violated verdicts of the run."""
        return () if self.run is None else violations(self.run)

    def content(self) -> dict[str, Any]:
        """Returns the printed form: the run as the API shows it; a contract with scripts."""
        if self.run is None:
            told = _make_refused_content(self.problems)
        else:
            told = adapter(Run).dump_python(self.run, mode="json")
        return {
            "scenario": self.scenario,
            **told,
            "trace": self.trace,
            "notes": list(self.notes),
        }


def violations(run: Run) -> tuple[Verdict, ...]:
    """Returns the violated verdicts of a run, observations among them."""
    return tuple(verdict for verdict in run.verdicts if verdict.outcome is Outcome.VIOLATED)


_COLUMNS = (
    "scenario",
    "status",
    "violations",
    "sim time (s)",
    "speed",
    "step (µs)",
    "agents (µs)",
)
"""Simulated time, its ratio to real time, the cost of a step without the agents, and theirs."""


def say_notes(results: Sequence[ScenarioResult]) -> None:
    """Prints the notes on scenarios to standard error, the first of many."""
    lines = [f"{one.scenario}: note: {remark}" for one in results for remark in one.notes]
    for line in lines[:_NOTES]:
        note(line)
    if len(lines) > _NOTES:
        note(f"{len(lines) - _NOTES} more notes; drivora validate prints them all")


def print_results(results: Sequence[ScenarioResult]) -> None:
    """Prints a row a scenario, and below the table why runs were not judged."""
    print_table(
        "",
        _COLUMNS,
        (_row(result) for result in results),
        wrap=("violations",),
    )
    for result in results:
        _print_remarks(result)


def print_result(result: ScenarioResult, *, where: str = "") -> None:
    """Prints one run at length.

    Args:
        result: The run.
        where: Options with which other commands find it.
    """
    print_results([result])
    run = result.run
    if run is None:
        return
    if run.verdicts:
        rows = (
            (
                verdict.oracle,
                verdict.ego,
                _outcome(verdict),
                _fault(verdict),
                number(verdict.time),
                _message(verdict),
            )
            for verdict in run.verdicts
        )
        columns = ("oracle", "ego", "outcome", "at fault", "time (s)", "message")
        print_table("Verdicts", columns, rows, wrap=("message",))
    _print_failures(run)
    if run.metrics:
        from drivora_service.metrics.catalogue import MetricCatalogue

        # Those of packages that are installed here, too; of others the unit is not known.
        units = {one.name: one.unit for one in MetricCatalogue().descriptions()}
        metrics = (
            (name, number(value, 3), units.get(name.partition("[")[0], "").replace(SHARE, ""))
            for name, value in run.metrics.items()
        )
        print_table("Metrics", ("metric", "value", "unit"), metrics)
    if run.scores:
        scores = ((name, number(value, 3)) for name, value in run.scores.items())
        print_table("Objectives: the least is nearest to a failure", ("objective", "value"), scores)
    if run.configuration_id:
        say(f"Configuration {run.configuration_id}: {run.configuration}")
    for ego, agent in run.agents.items():
        parameters = (f"{name} {short_value(value)}" for name, value in agent.parameters.items())
        say(f"Agent of {ego}: {', '.join((agent.name, *parameters))}")
    if result.trace:
        say(f"Trace: {result.trace}  (draw it: drivora plot {result.trace})")
    elif run.trace_sha256:
        say(f"Draw it: drivora plot {run.id} {where}".rstrip())


def follow_up(run_id: str, where: str) -> str:
    """Returns the commands that go on with a run that failed.

    Args:
        run_id: Id of the run, or campaign and evaluation.
        where: Options with which other commands find it.
    """
    return f"drivora plot {run_id} {where}".rstrip() + " (or: runs show, replay, minimize)"


def _print_failures(run: Run) -> None:
    """Prints which verdicts of a run are failures, and by which definition."""
    if run.failures is None:
        return
    counted = [run.verdicts[place] for place in run.failing_verdicts]
    named = [
        f"{one.oracle} of {one.ego}" + ("" if one.time is None else f" at {number(one.time)} s")
        for one in counted
    ]
    if run.status is RunStatus.AGENT_FAILED and run.failures:
        named.append("the ADS itself failed")
    say(f"Failures: {run.failures}" + (f" ({'; '.join(named)})" if named else ""))
    say(f"Failures are {run.definition.words}")


def print_runs(runs: Sequence[RunSummary]) -> None:
    """Prints a row a run of a list."""
    print_table(
        "",
        ("id", "label", "status", "town", "agent", "violations", "at fault", "created"),
        (
            (
                run.id,
                run.label or "-",
                run.status.replace("_", " "),
                run.town,
                run.configuration,
                "-" if run.violations is None else str(run.violations),
                "-" if run.at_fault_violations is None else str(run.at_fault_violations),
                f"{run.created_at.astimezone():%Y-%m-%d %H:%M:%S}",
            )
            for run in runs
        ),
        wrap=("agent",),
        cut=("label",),
    )


def summary(run: Run | None) -> str:
    """Returns the violated oracles of a run in a few words."""
    if run is None or run.status is not RunStatus.FINISHED:
        return "-"
    violated = violations(run)
    named = [
        _format_violation(verdict)
        for verdict in violated
        if verdict.severity != Severity.OBSERVATION and not followed_oracle(verdict)
    ]
    seen = {verdict.oracle for verdict in violated if verdict.severity == Severity.OBSERVATION}
    text = ", ".join(named) or "none"
    if find_artefact_verdicts(run.verdicts):
        text += "; spoilt by the simulator"
    if following := sum(bool(followed_oracle(verdict)) for verdict in violated):
        text += f"; {following} that {'follows' if following == 1 else 'follow'}"
    if seen:
        text += f"; observed: {', '.join(sorted(seen)).replace('_', ' ')}"
    return text


def _format_violation(verdict: Verdict) -> str:
    words = IN_WORDS[accountability(verdict)]
    name = verdict.oracle.replace("_", " ")
    return f"{name} ({words})" if words else name


def _outcome(verdict: Verdict) -> str:
    """Returns the outcome of a verdict; a dash if there was nothing to judge: the message says it.

    Most oracles have nothing to judge in most runs, and the words would take the message's room.
    """
    return "-" if verdict.outcome is Outcome.NOT_APPLICABLE else verdict.outcome.in_words


def _message(verdict: Verdict) -> str:
    follows = followed_oracle(verdict) if verdict.outcome is Outcome.VIOLATED else ""
    message = full_message(verdict)
    return f"{message} (follows from {follows})" if follows else message


def _fault(verdict: Verdict) -> str:
    if verdict.outcome is not Outcome.VIOLATED:
        return "-"
    return _FAULT[accountability(verdict)]


def _row(result: ScenarioResult) -> tuple[str, ...]:
    run = result.run
    if run is None or run.status is not RunStatus.FINISHED:
        return (result.scenario, result.status.replace("_", " "), *["-"] * 5)
    sim, wall = run.sim_time_s or 0.0, run.wall_time_s or 0.0
    costs = run.agent_cost_us.values()
    return (
        result.scenario,
        result.status.replace("_", " "),
        summary(run),
        f"{sim:.1f}",
        f"{sim / wall:.0f} × real time" if wall else "-",  # noqa: RUF001 # no letter
        f"{run.step_cost_us or 0.0:.0f}",
        f"{sum(costs):.0f}" if costs else "-",
    )


def _print_remarks(result: ScenarioResult) -> None:
    run = result.run
    if run is None:
        say(f"{result.scenario}: {_invalid(result.problems)}")
        for problem in result.problems:
            say(f"  {problem.pointer or '/'}: {problem.message}")
        return
    for ego in run.privileged:
        say(
            f"{result.scenario}: {ego} sees everything, not only what the perception model "
            "lets through"
        )
    for verdict in find_artefact_verdicts(run.verdicts):
        say(f"{result.scenario}: {verdict.ego}: {verdict.message}")
    if run.judged_by_other_oracles:
        say(
            f"{result.scenario}: judged by another version of the oracles; what changes by "
            f"today's: drivora rejudge {run.id}"
        )
    if run.error is None:
        return
    say(f"{result.scenario}: {run.error.cause}: {run.error.message}")
    if run.error.log:
        say("\n".join(f"  | {line}" for line in run.error.log.splitlines()[-_LOG_LINES:]))


def _make_refused_content(problems: Sequence[Problem]) -> dict[str, Any]:
    listed = [{"pointer": p.pointer, "code": p.code, "message": p.message} for p in problems]
    return {
        "id": "",
        "status": str(RunStatus.INVALID),
        "error": {
            "cause": "invalid_document",
            "message": f"{len(listed)} problem(s) in the scenario",
            "log": "",
            "problems": listed,
        },
        "verdicts": [],
        "metrics": {},
        "scores": {},
        "trace_sha256": "",
        "steps": None,
        "sim_time_s": None,
        "wall_time_s": None,
        "step_cost_us": None,
        "agent_cost_us": {},
        "agents": {},
        "privileged": [],
        "versions": {},
    }


def _invalid(problems: Sequence[Problem]) -> str:
    return f"invalid_document: {len(problems)} problem(s) in the scenario"
