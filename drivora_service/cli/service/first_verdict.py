"""The first verdict of a demo on a machine whose kernels are not compiled yet.

It is judged in a process of its own, in which the kernels are interpreted: done in seconds, while
the service compiles them. The service judges the same scenario again.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from drivora_service.cli.terminal.output import say
from drivora_service.compilation import interpreted_kernels

_LONGEST_S = 120.0


def print_first_verdict(file: Path) -> None:
    """Judges a scenario in another process and prints what it found, or why there is nothing.

    Args:
        file: The scenario.
    """
    from drivora_service.cli.terminal.output import note

    note(f"judging {file.stem}, the first scenario, with kernels interpreted")
    command = [sys.executable, "-m", __name__, str(file)]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_LONGEST_S, check=False
        )
    except subprocess.TimeoutExpired:
        note(f"no first verdict within {_LONGEST_S:g} s; the service judges all scenarios")
        return
    if done.returncode:
        last = (done.stderr.strip() or f"its process ended with {done.returncode}").splitlines()[-1]
        note(f"no first verdict: {last}. The service judges all scenarios")
        return
    say(f"first verdict: {done.stdout.strip()}")


def describe_run(file: Path) -> str:
    """Runs a scenario in this process; returns its result in a line.

    Args:
        file: The scenario.
    """
    from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
    from drivora_service.oracles.verdict import Outcome, Severity
    from drivora_service.runs.run_report import RunSpec, RunStatus
    from drivora_service.scenario.canonical import canonical_json
    from drivora_service.scenario.validation import validate_data
    from drivora_service.worker.performing import perform
    from drivora_service.worker.setup import WorkerSetup

    networks = shipped_networks()
    scenario = validate_data(file.read_bytes(), NetworkCatalogue(networks), None).scenario
    spec = RunSpec(run_id=file.stem, document=canonical_json(scenario))
    report = perform(spec, WorkerSetup(shipped_networks=networks, installed_oracles=False))
    if report.status is not RunStatus.FINISHED:
        reason = "" if report.failure is None else f": {report.failure.message}"
        return f"{file.stem}: {report.status.replace('_', ' ')}{reason}"
    violated = sorted(
        {
            verdict.oracle.replace("_", " ")
            for verdict in report.verdicts
            if verdict.outcome is Outcome.VIOLATED and verdict.severity != Severity.OBSERVATION
        }
    )
    judged = sum(
        verdict.outcome in (Outcome.VIOLATED, Outcome.PASSED) for verdict in report.verdicts
    )
    agents = ", ".join(sorted({choice.name for choice in report.agents.values()}))
    return (
        f"{file.stem}: {agents} drove {report.sim_time_s:.1f} s, {judged} oracles judged it, "
        f"violated: {', '.join(violated) or 'none'}"
    )


if __name__ == "__main__":
    with interpreted_kernels():
        say(describe_run(Path(sys.argv[1])))
