"""Results of runs as commands print them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from drivora_service.cli.output import number, print_table
from drivora_service.oracles.accountability import IN_WORDS, Accountability, accountable
from drivora_service.oracles.verdict import Answer, Outcome, Severity
from drivora_service.runs.encoding import report_to_json
from drivora_service.runs.report import RunReport

FINISHED = "finished"

_FAULT = {
    Accountability.AVOIDABLE: "yes",
    Accountability.NOT_MEASURABLE: "yes",
    Accountability.UNAVOIDABLE: "yes, not avoidable",
    Accountability.UNDETERMINED: "undetermined",
    Accountability.NOT_JUDGED: "-",
    Accountability.NOT_AT_FAULT: "no",
}


def result_of(report: RunReport, *, name: str, trace: str, notes: Sequence[str]) -> dict[str, Any]:
    """Returns the printed form of a report; the keys are a contract with scripts."""
    content: dict[str, Any] = json.loads(report_to_json(report))
    failure = content["failure"]
    return {
        "scenario": name,
        "status": content["status"],
        "error": failure,
        "verdicts": content["verdicts"],
        "metrics": content["metrics"],
        "scores": content["scores"],
        "trace_sha256": content["trace_sha256"],
        "steps": content["steps"],
        "sim_time_s": content["sim_time_s"],
        "wall_time_s": content["wall_time_s"],
        "step_cost_us": content["step_cost_us"],
        "agent_cost_us": content["agent_cost_us"],
        "agents": content["agents"],
        "privileged": content["privileged"],
        "versions": content["versions"],
        "trace": trace,
        "notes": list(notes),
    }


def result_of_run(run: dict[str, Any], *, name: str, trace: str) -> dict[str, Any]:
    """Returns the printed form of a run that a service performed."""
    return {
        "scenario": name,
        "run_id": run["id"],
        "status": run["status"],
        "error": run["error"],
        "verdicts": run["verdicts"],
        "metrics": run["metrics"],
        "scores": run["scores"],
        "trace_sha256": run["trace_sha256"],
        "steps": run["steps"] or 0,
        "sim_time_s": run["sim_time_s"] or 0.0,
        "wall_time_s": run["wall_time_s"] or 0.0,
        "step_cost_us": run["step_cost_us"] or 0.0,
        "agent_cost_us": run["agent_cost_us"],
        "agents": run["agents"],
        "privileged": run["privileged"],
        "versions": run["versions"],
        "trace": trace,
        "notes": [],
    }


def invalid_result(name: str, problems: Sequence[Any]) -> dict[str, Any]:
    """Returns the printed form of a scenario that cannot be run."""
    listed = [{"pointer": p.pointer, "code": p.code, "message": p.message} for p in problems]
    return {
        "scenario": name,
        "status": "invalid",
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
        "steps": 0,
        "sim_time_s": 0.0,
        "wall_time_s": 0.0,
        "step_cost_us": 0.0,
        "agent_cost_us": {},
        "agents": {},
        "privileged": [],
        "versions": {},
        "trace": "",
        "notes": [],
    }


def violations(result: dict[str, Any]) -> list[dict[str, Any]]:
    """Returns the verdicts that say a rule was broken."""
    return [verdict for verdict in result["verdicts"] if verdict["outcome"] == "violated"]


def print_results(results: Sequence[dict[str, Any]]) -> None:
    """Prints a row a run, and below it why runs were not judged."""
    print_table(
        "",
        ("scenario", "status", "violations", "sim time", "real time", "step cost", "agents"),
        (_row(result) for result in results),
        wrap=("violations",),
    )
    for result in results:
        for ego in result["privileged"]:
            print(
                f"{result['scenario']}: {ego} sees everything, not only what the perception model "
                "lets through"
            )
        error = result["error"]
        if error is None:
            continue
        print(f"{result['scenario']}: {error['cause']}: {error['message']}")
        for problem in error.get("problems", ()):
            print(f"  {problem['pointer'] or '/'}: {problem['message']}")
        if error["log"]:
            print("\n".join(f"  | {line}" for line in error["log"].splitlines()[-10:]))


def print_result(result: dict[str, Any]) -> None:
    """Prints one run at length."""
    print_results([result])
    if result["verdicts"]:
        rows = (
            (
                verdict["oracle"],
                verdict["ego"],
                verdict["outcome"].replace("_", " "),
                _fault(verdict),
                number(verdict["time"]),
                verdict["message"],
            )
            for verdict in result["verdicts"]
        )
        columns = ("rule", "ego", "outcome", "at fault", "time (s)", "message")
        print_table("Verdicts", columns, rows, wrap=("message",))
    if result["metrics"]:
        metrics = ((name, number(value, 3)) for name, value in result["metrics"].items())
        print_table("Metrics", ("metric", "value"), metrics)
    for ego, agent in result["agents"].items():
        parameters = (f"{name} {json.dumps(value)}" for name, value in agent["parameters"].items())
        print(f"Agent of {ego}: {', '.join((agent['name'], *parameters))}")
    if result["trace"]:
        print(f"Trace: {result['trace']}  (draw it: drivora plot {result['trace']})")


def summary(result: dict[str, Any]) -> str:
    """Says in a few words what was broken."""
    if result["status"] != FINISHED:
        return "-"
    broken = violations(result)
    named = [_named(verdict) for verdict in broken if verdict["severity"] != Severity.OBSERVATION]
    seen = {verdict["oracle"] for verdict in broken if verdict["severity"] == Severity.OBSERVATION}
    text = ", ".join(named) or "none"
    if seen:
        text += f"; observed: {', '.join(sorted(seen)).replace('_', ' ')}"
    return text


def _named(verdict: dict[str, Any]) -> str:
    words = IN_WORDS[accountability_of(verdict)]
    name = str(verdict["oracle"]).replace("_", " ")
    return f"{name} ({words})" if words else name


def _fault(verdict: dict[str, Any]) -> str:
    if verdict["outcome"] != Outcome.VIOLATED:
        return "-"
    return _FAULT[accountability_of(verdict)]


def accountability_of(verdict: Mapping[str, Any]) -> Accountability:
    """Returns how far the ego is accountable for a printed verdict."""
    avoidable = verdict["avoidable"]
    return accountable(
        verdict["at_fault"],
        None if avoidable is None else Answer(avoidable),
        undetermined=verdict["undetermined"],
    )


def _row(result: dict[str, Any]) -> tuple[str, ...]:
    wall, sim = result["wall_time_s"], result["sim_time_s"]
    judged = result["status"] == FINISHED
    agents = result["agent_cost_us"].values()
    return (
        result["scenario"],
        result["status"].replace("_", " "),
        summary(result),
        f"{sim:.1f} s" if judged else "-",
        f"{sim / wall:.0f}" if judged and wall else "-",
        f"{result['step_cost_us']:.0f} µs" if judged else "-",
        f"{sum(agents):.0f} µs" if judged and agents else "-",
    )
